"""Passing the clearance twice, half a period of the boom apart, so that the second shock swings against the first (thesis 5.1).

    PYTHONPATH=build/release/python .venv/bin/python examples/double_passage/double_passage.py [SCENARIO.yaml] [OUT]

The controller holds a torque and no speed: the lever says which way to push, group 1 follows it at once, group 2 an interval later.
Three runs, the groups together, half a period and a whole period of the boom apart, into OUT/together, OUT/half, OUT/whole; what the
tip rings with at the boom's first frequency afterwards is printed. On a crane the PLC does the same with the same numbers, and
`slewlab report` draws the record beside the run.
"""

import sys
from pathlib import Path

import numpy as np
import slewlab

TORQUE = 60.0      # [N m] per motor, chosen: turned around, the gears pass their clearance and the crane hardly picks up speed
RISE = 1.0         # [s] from nothing to the torque, chosen: longer than a period of the boom, so that the start does not ring
PERIODS = 8        # of the boom, over which the ringing is measured
PAUSE = 2          # of the boom's periods from the turn to there


class DoublePassage:
    """Group 2 turns its torque around `interval` [s] after group 1. An emergency stop lets go."""

    def __init__(self, interval):
        self.delays = (0.0, interval)  # [s] of each group
        self.moves = []                # (time [s] from which on, -1 ... 1)

    def __call__(self, encoder, operator):
        time = encoder.time
        if operator.speed_request != (self.moves[-1][1] if self.moves else 0.0):
            self.moves.append((time, operator.speed_request))
        if operator.emergency_stop or not self.moves:
            return slewlab.Answer([0.0] * len(encoder.shaft_speed), enable=False, brake=True)
        rise = 0.5 * (1.0 - np.cos(np.pi * min((time - self.moves[0][0]) / RISE, 1.0)))
        return [TORQUE * rise * self.asked(time - self.delays[min(group, 1)]) for group in range(len(encoder.shaft_speed))]

    def asked(self, time):
        """The lever as it stood at that time; the first move is for all groups at once."""
        return next((request for begin, request in reversed(self.moves) if begin <= time), self.moves[0][1])


def turn_of(scenario):
    """[s] the operator's last move, at which the torque turns around."""
    values = slewlab.values(scenario.path)
    return max(float(value) for key, value in values.value.items() if key.startswith("operator.") and key.endswith(".time"))


def boom_period(scenario):
    """[s] of the first bending mode of the machine, its gears pressed."""
    return 1.0 / next(mode.frequency for mode in scenario.machine.modes() if mode.kind == "bending")


def tip_amplitude(run, begin, period):
    """[m/s^2] of the tip's acceleration at the boom's first frequency, from `begin` [s] over PERIODS of it, with Hann's window."""
    acceleration = run["SENSORS"].tip_acceleration
    acceleration = acceleration[(acceleration.index >= begin) & (acceleration.index < begin + PERIODS * period)]
    window = np.hanning(len(acceleration) + 1)[:-1]
    return 2.0 * abs(np.sum(window * acceleration * np.exp(-2j * np.pi * acceleration.index / period))) / window.sum()


def passages(scenario, out=None):
    """{name: tip's amplitude [m/s^2]} of the three runs, their logs in `out`."""
    period, found = boom_period(scenario), {}
    begin = turn_of(scenario) + PAUSE * period
    for name, apart in (("together", 0.0), ("half", 0.5), ("whole", 1.0)):
        log = None
        if out is not None:
            log = Path(out) / name / "run.lcmlog"
            log.parent.mkdir(parents=True, exist_ok=True)
        found[name] = tip_amplitude(scenario.run(DoublePassage(apart * period), log=log), begin, period)
    return found


def main():
    path = sys.argv[1] if len(sys.argv) > 1 else slewlab.config("scenarios/double_passage.yaml")
    out = sys.argv[2] if len(sys.argv) > 2 else "runs/double_passage"
    scenario = slewlab.Scenario(path)
    print(f"the boom's first period is {boom_period(scenario):.3f} s")
    for name, amplitude in passages(scenario, out).items():
        print(f"{name:<9} {amplitude:.3f} m/s² at the tip   {Path(out) / name}")


if __name__ == "__main__":
    main()
