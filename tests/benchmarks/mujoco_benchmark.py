"""The thesis's crane as a MuJoCo model, and what one of its steps costs.

Same machine as tests/sim/thesis_crane.h: two motor groups on the slew axis, each coupled to the house by a spring
with a dead band (a tendon: MuJoCo knows no one-sided damping, so it damps inside the play too), the boom as six
hinges with springs on a body of the same mass and stiffness, rope and rod as two hinges. Contacts are off. 11 degrees
of freedom stand against the 23 of slewlab's six elements, so the comparison favours MuJoCo.

Prints, as JSON: the natural frequencies with the gears closed (to be held against `slewlab modes`) and the median cost
of mj_step at 1 ms, stepped in C in batches of 1000.

Usage: mujoco_benchmark.py [OUT.json]
"""

import json
import math
import statistics
import sys
import time

import mujoco
import numpy

GRAVITY = 9.81  # [m/s^2] thesis Table 4.2
GROUPS = 2
RATIO = 215.4 * 12.7  # thesis 2.10
GROUP_INERTIA = 3 * (1.08 + 0.037 + 0.05) * RATIO**2  # [kg m^2] slew axis, thesis Table 2.6
GROUP_STIFFNESS = 3 * 6.9e6 * 12.7**2  # [Nm/rad] slew axis, thesis 2.10
HALF_PLAY = 0.5 * math.radians(0.12 + 0.244) / 12.7  # [rad] slew axis, as thesis_crane.h
HOUSE_INERTIA = 2.52e5  # [kg m^2] thesis Table 2.3
LENGTH, MASS, ANGLE, PIVOT = 46.6, 81047.0, math.radians(53.5), 3.6  # [m], [kg], [rad], [m]
OUTER, INNER, YOUNG = 0.267, 0.227, 210e9  # [m], [m], [N/m^2] thesis Table 2.4
PROFILE = ([0.0, 0.2, 0.4, 0.6, 0.8, 1.0], [2.25, 1.65, 1.33, 1.17, 0.95, 0.915])  # [m] half width, thesis_crane.h
DAMPING_RATIO, GEAR_DAMPING = 0.01, 0.03
LOAD, ROPE, ROD = 30e3, 60.0, 1.5  # [kg], [m], [m]
ELEMENTS = 6
STEP = 1e-3  # [s]


def second_moment(position):
    """(2.11) [m^4] of four chords."""
    half_width = numpy.interp(position, *PROFILE)
    area = math.pi / 4 * (OUTER**2 - INNER**2)
    return math.pi / 16 * (OUTER**4 - INNER**4) + 4 * area * half_width**2


def model_text():
    """MJCF. The boom lies along +x, turned up by its angle; hinges bend it about its own normal."""
    h = LENGTH / ELEMENTS
    projected = LENGTH * math.cos(ANGLE)
    boom_inertia = MASS * (projected**2 / 12 + (PIVOT + projected / 2) ** 2)
    driven = HOUSE_INERTIA + boom_inertia
    together = GROUPS * GROUP_INERTIA * driven / (GROUPS * GROUP_INERTIA + driven)
    damping = GEAR_DAMPING * 2 * math.sqrt(GROUPS * GROUP_STIFFNESS * together) / GROUPS
    first, second = 2 * math.pi * 1.26, 2 * math.pi * 5.2  # [rad/s] clamped boom, as `slewlab modes` gives
    proportional = 2 * DAMPING_RATIO / (first + second)  # [s] (3.15) corrected

    def segment(length):
        mass = MASS * length / LENGTH
        thin = mass * length**2 / 12
        return (f'<inertial pos="{length / 2} 0 0" mass="{mass}" diaginertia="{1e-3 * thin} {thin} {thin}"/>')

    body = ""
    tail = ""
    # Half a segment is fixed to the house; hinges stand in the middle of the elements.
    position = 0.5 * h
    start = h / 2
    for element in range(ELEMENTS):
        stiffness = YOUNG * second_moment((element + 0.5) / ELEMENTS) / h
        length = h if element + 1 < ELEMENTS else 0.5 * h
        body += (f'<body pos="{start} 0 0"><joint name="bend{element}" type="hinge" axis="0 0 1" '
                 f'stiffness="{stiffness}" damping="{proportional * stiffness}"/>{segment(length)}')
        tail += "</body>"
        start = length
        position += h
    tip = 0.5 * h
    # The load hangs straight down whatever the boom's angle.
    load = (f'<body pos="{tip} 0 0" euler="0 {ANGLE} 0"><joint name="rope" type="hinge" axis="1 0 0"/>'
            f'<inertial pos="0 0 {-ROPE}" mass="1e-3" diaginertia="1e-3 1e-3 1e-3"/>'
            f'<body pos="0 0 {-ROPE}"><joint name="rod" type="hinge" axis="1 0 0"/>'
            f'<inertial pos="0 0 {-ROD / 2}" mass="{LOAD}" '
            f'diaginertia="{LOAD * ROD**2 / 12} {LOAD * ROD**2 / 12} 1"/></body></body>')
    motors = "".join(
        f'<body><joint name="motor{i}" type="hinge" axis="0 0 1"/>'
        f'<inertial pos="0 0 0" mass="1" diaginertia="{GROUP_INERTIA} {GROUP_INERTIA} {GROUP_INERTIA}"/></body>' for i in range(GROUPS))
    tendons = "".join(
        f'<fixed name="gear{i}" stiffness="{GROUP_STIFFNESS}" damping="{damping}" '
        f'springlength="{-HALF_PLAY} {HALF_PLAY}"><joint joint="motor{i}" coef="1"/>'
        f'<joint joint="house" coef="-1"/></fixed>' for i in range(GROUPS))
    drives = "".join(f'<motor joint="motor{i}"/>' for i in range(GROUPS))
    return f"""<mujoco><compiler angle="radian" inertiafromgeom="false"/>
<option timestep="{STEP}" gravity="0 0 {-GRAVITY}" integrator="implicitfast"><flag contact="disable"/></option>
<worldbody>{motors}
<body name="house"><joint name="house" type="hinge" axis="0 0 1"/>
<inertial pos="0 0 0" mass="1" diaginertia="{HOUSE_INERTIA} {HOUSE_INERTIA} {HOUSE_INERTIA}"/>
<body pos="{PIVOT} 0 0" euler="0 {-ANGLE} 0">{segment(h / 2)}{body}{load}{tail}</body></body>
</worldbody><tendon>{tendons}</tendon><actuator>{drives}</actuator></mujoco>"""


def frequencies(model):
    """[Hz] of the linear model at rest with the gears closed, lowest first."""
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    mass = numpy.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, mass)
    stiffness = numpy.diag(model.jnt_stiffness).astype(float)
    house = model.joint("house").dofadr[0]
    for i in range(GROUPS):
        row = numpy.zeros(model.nv)
        row[model.joint(f"motor{i}").dofadr[0]] = 1
        row[house] = -1
        stiffness += GROUP_STIFFNESS * numpy.outer(row, row)
    # Gravity's share by differences of the generalised force.
    small = 1e-6
    for k in range(model.nv):
        column = []
        for sign in (1, -1):
            data.qpos[:] = 0
            data.qpos[k] = sign * small
            mujoco.mj_forward(model, data)
            column.append(data.qfrc_bias.copy())
        stiffness[:, k] += (column[0] - column[1]) / (2 * small)
    values = numpy.linalg.eigvals(numpy.linalg.solve(mass, stiffness))
    return sorted(math.sqrt(max(0.0, value.real)) / (2 * math.pi) for value in values)


def main():
    model = mujoco.MjModel.from_xml_string(model_text())
    data = mujoco.MjData(model)
    batch, costs = 1000, []
    steps = 0
    while steps < 200_000:
        torque = 150 * math.sin(1.5 * steps * STEP) * 3 * RATIO  # [Nm] to and fro, as plant_benchmark's
        data.ctrl[:] = [torque + 20 * 3 * RATIO, torque - 20 * 3 * RATIO]
        begin = time.process_time()
        mujoco.mj_step(model, data, nstep=batch)
        costs.append((time.process_time() - begin) / batch * 1e9)
        steps += batch
        if steps % 12_000 == 0:  # the manoeuvre starts again
            mujoco.mj_resetData(model, data)
    if not numpy.all(numpy.isfinite(data.qpos)) or data.warning[mujoco.mjtWarning.mjWARN_BADQACC].number:
        sys.exit("mujoco_benchmark: the model did not stay stable; its cost means nothing")
    result = {"version": mujoco.__version__, "degrees_of_freedom": model.nv, "step_ns": statistics.median(costs),
              "frequencies_hz": [round(f, 3) for f in frequencies(model)]}
    text = json.dumps(result, indent=1)
    if len(sys.argv) > 1:
        with open(sys.argv[1], "w", encoding="utf-8") as file:
            file.write(text + "\n")
    print(text)


if __name__ == "__main__":
    main()
