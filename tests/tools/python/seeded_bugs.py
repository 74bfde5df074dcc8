"""Bugs of a controller, seeded on purpose: each a line or two of examples/controller_in_python/controller.py made wrong, run
against the shipped acceptance and fault scenarios in this process.

    seeded_bugs.py [BUG ...]    runs every scenario of the test plan with each, and prints the table of docs/seeded_bugs.md
"""

import sys
import tempfile
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType, SimpleNamespace

import yaml

from run_log import REPOSITORY, messages_folder

sys.path.insert(0, str(messages_folder()))
import slewlab  # noqa: E402

EXAMPLE = REPOSITORY / "examples" / "controller_in_python" / "controller.py"
PLAN = slewlab.config("acceptance_plans/thesis.yaml")


@dataclass(frozen=True)
class Bug:
    name: str
    what: str
    changes: tuple[tuple[str, str], ...]  # text of the example, and what stands in its place


def bug(name, what, *changes):
    return Bug(name, what, changes)


ANSWER = "torque.motor_torque = list(self.commanded)"
READING = "shaft_speed = self.monitor.judge(encoder)"
ACKNOWLEDGE = "torque.acknowledge = operator.acknowledge and request == 0.0  # with the joystick at zero alone"
BUGS = (
    bug("sign", "sign of the speed error turned round", ("c.step(reference - speed)", "c.step(speed - reference)")),
    bug("request_sign", "sign of the operator's request lost", ("self.ramp.step(request * TOP_SPEED)", "self.ramp.step(abs(request) * TOP_SPEED)")),
    bug("windup", "no anti-windup of the integral",
        ("        if not winds_up:\n            self.integral += growth\n", "        self.integral += growth\n"),
        ("        self.integral = clamp(self.integral, -TORQUE_LIMIT, TORQUE_LIMIT)\n", "")),
    bug("swapped_halves", "halves of the play compensation swapped",
        ("return (half_1, half_2) if average >= 0.0 else (-half_2, -half_1)", "return (half_2, half_1) if average >= 0.0 else (-half_1, -half_2)")),
    bug("swapped_one_way", "halves swapped for one sign of the torque", ("else (-half_2, -half_1)", "else (-half_1, -half_2)")),
    bug("own_integrals", "each group keeps an integral of its own", ("            control.integral = shared\n", "")),
    bug("lost_acknowledge", "the operator's acknowledgement not passed on", (ACKNOWLEDGE, "torque.acknowledge = False")),
    bug("always_acknowledges", "acknowledges without being asked", (ACKNOWLEDGE, "torque.acknowledge = True")),
    bug("speed_unit", "wanted speed in rpm instead of rad/s", ("reference = self.ramp.speed * RATIO", "reference = self.ramp.speed * RATIO * 30.0 / math.pi")),
    bug("torque_unit", "torque in kN m instead of N m", (ANSWER, "torque.motor_torque = [1e-3 * each for each in self.commanded]")),
    bug("ratio", "ratio of the pinion forgotten", ("RATIO = 2735.58 ", "RATIO = 215.4 ")),
    bug("no_ramp", "request taken as it is, without a ramp", ("reference = self.ramp.speed * RATIO", "reference = self.ramp.target * RATIO")),
    bug("fast_ramp", "ramp twice as fast", ("CHANGE_TIME = 4.4 ", "CHANGE_TIME = 2.2 ")),
    bug("slow_stop", "emergency stop takes twice as long", ("EMERGENCY_STOP_TIME = 1.5 ", "EMERGENCY_STOP_TIME = 3.0 ")),
    bug("no_stop", "emergency stop not looked at", ("        if operator.emergency_stop:\n", "        if False:\n")),
    bug("high_limit", "torque limit of another motor, 60 % too high", ("TORQUE_LIMIT = 250.0 ", "TORQUE_LIMIT = 400.0 ")),
    bug("low_limit", "torque limit of another motor, 40 % too low", ("TORQUE_LIMIT = 250.0 ", "TORQUE_LIMIT = 150.0 ")),
    bug("late", "answers with the torque of the cycle before",
        (ANSWER, 'torque.motor_torque, self.before = getattr(self, "before", [0.0] * GROUPS), list(self.commanded)')),
    bug("stale_speed", "controls by the speed of 100 ms before",
        (READING, READING + "\n        if shaft_speed is not None:\n            self.old = [*getattr(self, 'old', []), list(shaft_speed)][-10:]\n"
                            "            shaft_speed = self.old[0]")),
    bug("wrap", "position of the shaft taken modulo a turn",
        ("turned = (position - position_before) / elapsed", "turned = (position % math.tau - position_before % math.tau) / elapsed")),
    bug("unjudged", "readings taken as they come", (READING, "shaft_speed = encoder.shaft_speed")),
    bug("no_brake", "lets go without asking for the brakes", ("torque.enable, torque.brake = False, True", "torque.enable, torque.brake = False, False")),
)


def mutated(changes):
    text = EXAMPLE.read_text(encoding="utf-8")
    for right, wrong in changes:
        if text.count(right) != 1:
            raise ValueError(f"'{right}' stands {text.count(right)} times in {EXAMPLE.name}, expected once")
        text = text.replace(right, wrong)
    module = ModuleType("seeded_bug")
    exec(compile(text, EXAMPLE.name, "exec"), module.__dict__)
    return module


def controller_of(changes):
    """A class that slewlab.Scenario.run() takes: made anew wherever the controller is started."""
    module = mutated(changes)

    class InProcess:
        def __init__(self):
            self.controller, self.torque, self.state = module.Controller(), SimpleNamespace(), SimpleNamespace()

        def __call__(self, encoder, operator):
            message = SimpleNamespace(sequence=encoder.sequence, simulated_time=round(encoder.time * 1e9), group_count=encoder.group_count,
                                      shaft_speed=list(encoder.shaft_speed), shaft_position=list(encoder.shaft_position))
            self.controller.step(message, operator, self.torque, self.state)
            return slewlab.Answer(self.torque.motor_torque, bool(self.torque.enable), bool(self.torque.brake), bool(self.torque.acknowledge))

    return InProcess


def plan_tests():
    """{name of a test of the plan: its scenario}"""
    plan = yaml.safe_load(PLAN.read_text(encoding="utf-8"))
    return {each["name"]: (PLAN.parent / each["scenario"]).resolve() for each in plan["tests"]}


def failed_checks(changes, scenario):
    """Names of the checks that a run of the mutated controller fails."""
    with tempfile.TemporaryDirectory() as folder:
        log = Path(folder) / "run.lcmlog"
        run = slewlab.Scenario(scenario)
        run.run(controller_of(changes), channels=[], log=log)
        no_verdict, checks = run._core.judge(log, slewlab.config("acceptance/thesis.yaml"))
    return ["no verdict"] if no_verdict else [name for name, verdict, *_ in checks if verdict == "fail"]


def caught_by(each):
    return {test: failed for test, scenario in plan_tests().items() if (failed := failed_checks(each.changes, scenario))}


def row(each, found):
    first = next(iter(found), None)
    others = len(found) - 1
    checks = ", ".join(found[first]) if first else ""
    return f"| {each.name} | {each.what} | {first or 'nothing'} | {checks} | {others if found else ''} |"


def main(arguments):
    chosen = [each for each in (*BUGS, bug("none", "the example as it is")) if not arguments or each.name in arguments]
    with ProcessPoolExecutor(2) as pool:
        for each, found in zip(chosen, pool.map(caught_by, chosen)):
            print(row(each, found), flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
