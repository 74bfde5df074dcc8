"""What a soft PLC computes: the variables of a map, and in every cycle a step of a controller of slewlab with them."""

import asyncio
import time

from core_module import core
from plc.values import advance

ANOTHER_RUN = 1000  # [cycles] by which the alive counter of one run does not leap
ALIKE = 0.25  # share of a period within which two periods are one
JUDGED = 3  # [cycles] of a run's beginning by which its period is told


class WrongPeriod(Exception):
    """The run asks in another period than the soft PLC computes with."""


class SoftCycle:
    """Values are in SI, inputs and outputs by (name, group)."""

    def __init__(self, plc_map, controller_file, period):
        self.map, self.file, self.period = plc_map, controller_file, period
        self.counter = next(signal for signal in plc_map.signals if signal.name == "alive_counter" and signal.to_plc)
        self.inputs = {(signal.name, signal.group): 0 for signal in plc_map.signals if signal.to_plc}
        self.outputs = {(signal.name, signal.group): 0 for signal in plc_map.signals if not signal.to_plc}
        self.outputs["brake", 0] = True  # until it computes
        self.clock = next((signal for signal in plc_map.signals if signal.name == "simulated_time"), None)
        self.controller, self.last = None, 0
        self.refuse = None  # told of a WrongPeriod, where it is not to be raised
        self.was_told = False
        self.cycles, self.late_cycles = 0, 0

    def receive(self, values):
        self.inputs |= values
        self.was_told = self.was_told or ("alive_counter", 0) in values
        if self.map.ticked and self.inputs["alive_counter", 0] != self.last:
            self.tick()

    def tick(self):
        try:
            self.compute()
        except WrongPeriod as problem:
            if self.refuse is None:
                raise
            self.refuse(problem)

    def compute(self):
        now = self.inputs["alive_counter", 0]
        step = advance(self.counter, self.last, now)
        if self.controller is None or step > ANOTHER_RUN:
            self.controller = core.SteppedController(self.file, self.period)
            self.sequence, self.alive, step = now, -1, 0
            self.positions = [0.0] * self.map.group_count
            self.beginning = []
        self.last = now
        self.sequence += step
        self.judge_period()
        self.alive += 1
        self.cycles += 1
        groups = range(self.map.group_count)
        speeds = [self.inputs["shaft_speed", group] for group in groups]
        if ("shaft_position", 0) in self.inputs:
            self.positions = [self.inputs["shaft_position", group] for group in groups]
        else:  # no second measurement to judge the speeds by
            self.positions = [position + speed * self.period * step for position, speed in zip(self.positions, speeds)]
        said = self.controller.step(self.sequence, self.inputs.get(("simulated_time", 0), self.sequence * self.period), speeds, self.positions,
                                    self.inputs["speed_request", 0], bool(self.inputs["emergency_stop", 0]), bool(self.inputs["acknowledge", 0]))
        said |= {"alive_counter": self.alive, "answered_counter": now}
        for name, group in self.outputs:
            self.outputs[name, group] = said[name][group] if isinstance(said[name], list) else said[name]

    def judge_period(self):
        """A ticked PLC has no clock of its own: what simulated_time says between the first counts has to be the period, twice alike, since
        one reading may have a bit that turned over."""
        if not self.map.ticked or self.clock is None or len(self.beginning) == JUDGED:
            return
        self.beginning.append((self.sequence, self.inputs["simulated_time", 0]))
        if len(self.beginning) < JUDGED:
            return
        (first, begin), (second, middle), (third, end) = self.beginning
        periods = [(middle - begin) / max(1, second - first), (end - middle) / max(1, third - second)]
        tolerance = max(ALIKE * self.period, 0.0 if self.clock.type.startswith("float") else self.clock.scale)
        if all(abs(each - self.period) > tolerance for each in periods) and abs(periods[0] - periods[1]) <= tolerance:
            raise WrongPeriod(f"found {periods[0] * 1e3:g} ms of simulated_time from one alive_counter to the next, expected {self.period * 1e3:g} ms "
                              f"(--period-ms): --period-ms {periods[0] * 1e3:g} is right for this run")

    async def run(self):
        """A cycle every period of the wall clock, at absolute times, from the first input on; what is missed is not made up for."""
        due = time.monotonic()
        while True:
            due += self.period
            await asyncio.sleep(max(0.0, due - time.monotonic()))
            if time.monotonic() > due + self.period:
                self.late_cycles += 1
                due = time.monotonic()
            if self.was_told:
                self.compute()
