"""A plant in one page: an axis of one inertia with two motor groups, in the place of slewlab's crane.

    slewlab run config/scenarios/thesis_slew.yaml --plant "python3 examples/plant_in_python/plant.py"

It needs the package lcm and the messages as Python classes, as examples/controller_in_python does. What a plant must do: docs/wire.md.
"""

import json
import math
import os

import lcm
from slewlab_msgs import controller_state_t, encoder_t, operator_t, sensors_t, torque_t

RATIO = 2735.58        # [-] turns of a motor per turn of the crane; thesis 2.10
INERTIA = 5.4e7        # [kg m^2] of all that turns, on the slew axis; thesis Table 4.2
MOTORS = 3             # per group; thesis 2.3
FRICTION = 2.0e6       # [N m s/rad] viscous, in the bearing; chosen
STILL = 1e-6           # [rad/s] below which the brakes have stopped it; chosen
BRAKES = 2.0e6         # [N m] all of them, on the slew axis; chosen
AT_ZERO = {"speed_request": 0.0, "emergency_stop": False, "acknowledge": False}  # the joystick before its first move
PATIENCE = 50          # [ms] of wall clock, until an ENCODER that is not answered is sent again

task = json.load(open(os.environ["SLEWLAB_PLANT_TASK"]))
bus = lcm.LCM(task["bus"])
log = lcm.EventLog(task["log"], "w", overwrite=True)
time, cycle, angle, speed = 0, 0, 0.0, 0.0  # [ns], controller periods, [rad], [rad/s] on the slew axis
said = {}  # by the controller in this period: channel: (message, bytes)
counts = {}


def message(kind):
    """One of this run, at this time."""
    made = kind()
    made.sequence = counts[kind] = counts.get(kind, -1) + 1
    made.simulated_time, made.configuration_hash, made.run_identity = time, task["configuration_hash"], task["run_identity"]
    return made


def send(channel, data, on_bus=True):
    log.write_event(time // 1000, channel, data)  # stamped with the simulated time [us]
    if on_bus:
        bus.publish(channel, data)


def sense():
    sensors = message(sensors_t)
    for place in ("house", "pivot", "middle", "tip"):
        setattr(sensors, f"{place}_acceleration", math.nan)  # not fitted
    sensors.slew_angle = angle
    send("SENSORS", sensors.encode(), on_bus=False)


def hear(channel, data):
    heard = (torque_t if channel == "TORQUE" else controller_state_t).decode(data)
    if heard.run_identity == task["run_identity"] and heard.answered_sequence == cycle:
        said.setdefault(channel, (heard, data))  # a repetition changes nothing


def is_answered():
    return "TORQUE" in said and (not said["TORQUE"][0].state_follows or "CONTROLLER_STATE" in said)


def move(answer, seconds):
    """One plant step under the answer's torque; the brakes hold what stands still."""
    global angle, speed
    driving = answer.enable and not answer.brake
    torque = MOTORS * RATIO * sum(answer.motor_torque) if driving else 0.0
    torque -= FRICTION * speed + (0.0 if driving else math.copysign(BRAKES, speed) if abs(speed) > STILL else 0.0)
    faster = speed + seconds * torque / INERTIA
    if not driving and faster * speed <= 0.0:
        faster = 0.0
    angle, speed = angle + seconds * 0.5 * (speed + faster), faster


for channel in ("TORQUE", "CONTROLLER_STATE"):
    bus.subscribe(channel, hear).set_queue_capacity(0)
moves, newest = task["operator"], None
sense()
while time < task["duration_ns"]:
    while newest is None or (moves and moves[0]["time_ns"] <= time):  # where the joystick stands, before the first ENCODER
        wish = moves.pop(0) if moves and moves[0]["time_ns"] <= time else AT_ZERO
        newest = message(operator_t)
        newest.speed_request, newest.emergency_stop, newest.acknowledge = wish["speed_request"], wish["emergency_stop"], wish["acknowledge"]
        send("OPERATOR", newest.encode())
    encoder = message(encoder_t)
    encoder.operator_sequence, encoder.group_count = newest.sequence, task["group_count"]
    encoder.shaft_speed, encoder.shaft_position = [speed * RATIO] * task["group_count"], [angle * RATIO] * task["group_count"]
    said.clear()
    send("ENCODER", encoder.encode())
    while not is_answered():  # simulated time stands until the answer is here
        if not bus.handle_timeout(PATIENCE):
            bus.publish("OPERATOR", newest.encode())
            bus.publish("ENCODER", encoder.encode())
    for channel in sorted(said):  # CONTROLLER_STATE, then TORQUE
        send(channel, said[channel][1], on_bus=False)
    for _ in range(task["controller_period_ns"] // task["plant_step_ns"]):
        move(said["TORQUE"][0], task["plant_step_ns"] * 1e-9)
        time += task["plant_step_ns"]
        if time % task["sensors_period_ns"] == 0:
            sense()
    cycle += 1
log.close()
