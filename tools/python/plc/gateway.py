"""The controller's side of the wire, with a PLC behind it (docs/plc.md).

Against the wall clock the PLC keeps its own time: every ENCODER is written to it, and what it says at that moment is the answer. In
lockstep, and wherever the map says `ticked`, the answer is waited for: the PLC computes one cycle for a new alive_counter and says by
answered_counter with which one it did.

A link over which nothing was exchanged for the map's `timeout` is lost. What is sent then is the map's `on_link_loss`, and
CONTROLLER_STATE says mode 4, until the link is there again and the operator acknowledges with the lever at zero. In lockstep, where no
clock may decide, a lost link ends the run.
"""

import math
import statistics
import struct
import threading
import time

from plc.link import LinkDown, WrongMap
from plc.values import advance
from run_log import message_types

LINK_LOST = 4  # CONTROLLER_STATE.mode
STATES = ("mode", "ramped_speed", "average_torque", "offset_torque", "proportional_torque", "integral_torque")
GROUP_STATES = ("proportional_torque", "integral_torque")
WAIT = 200           # [ms] for which a signal may go unnoticed
RETRY = 0.5          # [s] between two attempts to connect


def count_of(sequence):
    """The alive counter for the ENCODER of a sequence number: from 1 on, since 0 is what a PLC has before it was told anything."""
    return sequence + 1


def beside(function):
    """In a thread of its own: an address that nobody has takes its time."""
    thread = threading.Thread(target=function, daemon=True)
    thread.start()
    return thread.is_alive


class Gateway:
    """`bus` and `link` are LCM's and plc.link's; `clock` [s] and `start`, which begins a function and answers with a function that says
    whether it is still under way, are those of this machine."""

    def __init__(self, plc_map, link, bus, period, is_realtime, say, clock=time.monotonic, start=beside):
        self.map, self.period, self.is_realtime, self.say = plc_map, period, is_realtime, say
        self.clock, self.start = clock, start
        self.signals = {(signal.name, signal.to_plc): signal for signal in plc_map.signals}
        self.types = message_types()
        self.link = link
        self.is_connected, self.is_connecting, self.refusal = False, lambda: False, None
        self.begin = self.next_attempt = clock()
        self.is_waiting = False    # for the first exchange, and it was said
        self.is_released = True    # the operator's acknowledgement, since the link was lost
        self.trouble = "the PLC has not computed with what it was told"
        self.last_exchange = None  # [s] none yet: no link that could be lost
        self.is_lost = False       # the link: nothing for the map's timeout
        self.is_latched = False    # until acknowledged
        self.run = self.candidate = None  # run_identity of the run answered, and of another one heard once
        self.newest = None         # ENCODER that waits for its answer
        self.durations, self.losses, self.failures, self.unanswered = [], 0, 0, 0
        self.bus = bus
        self.operators = {}        # the newest OPERATOR of each run heard
        self.subscriptions = []
        for channel, handler in (("OPERATOR", self.on_operator), ("ENCODER", self.on_encoder)):
            self.subscriptions.append(self.bus.subscribe(channel, handler))
            self.subscriptions[-1].set_queue_capacity(0)  # unlimited: by default the newest are dropped

    def begin_run(self, encoder):
        if encoder.group_count != self.map.group_count:
            raise WrongMap(f"the map has signals of {self.map.group_count} motor group(s), this run's machine has {encoder.group_count}")
        self.run, self.candidate, self.answered, self.count = encoder.run_identity, None, -1, 0
        self.bytes, self.alive, self.plc_alive, self.published = None, 0, None, -1
        self.operators = {run: operator for run, operator in self.operators.items() if run == self.run}

    def _decoded(self, message_class, data):
        try:
            return message_class.decode(data)
        except (ValueError, struct.error):
            return None  # a bit that turned over on its way

    def on_operator(self, _, data):
        message = self._decoded(self.types.operator_t, data)
        held = self.operators.get(message.run_identity) if message else None
        if message and (held is None or message.sequence > held.sequence):
            self.operators[message.run_identity] = message

    def on_encoder(self, _, data):
        encoder = self._decoded(self.types.encoder_t, data)
        if encoder is None:
            return
        if encoder.run_identity != self.run:
            if self.run is not None and encoder.run_identity != self.candidate:
                self.candidate = encoder.run_identity  # one alone may be a bit that turned over
                return
            self.begin_run(encoder)
        operator = self.operators.get(self.run)
        if encoder.sequence == self.answered and self.bytes:
            self.publish()
        elif encoder.sequence > self.answered and operator is not None and operator.sequence >= encoder.operator_sequence:
            self.newest = encoder

    def publish(self):
        state, torque = self.bytes
        if state is not None:
            self.bus.publish("CONTROLLER_STATE", state)
        self.bus.publish("TORQUE", torque)

    def inputs(self, encoder, operator):
        values = {("speed_request", 0): operator.speed_request, ("emergency_stop", 0): operator.emergency_stop,
                  ("acknowledge", 0): operator.acknowledge, ("alive_counter", 0): count_of(encoder.sequence),
                  ("simulated_time", 0): encoder.simulated_time * 1e-9}
        for group in range(self.map.group_count):
            is_there = group < encoder.group_count
            values["shaft_speed", group] = encoder.shaft_speed[group] if is_there else math.nan
            values["shaft_position", group] = encoder.shaft_position[group] if is_there else math.nan
        return values

    def connect(self):
        try:
            self.link.connect()
            self.is_connected = True
        except LinkDown as problem:
            self.failures += 1
            self.trouble = str(problem)
        except WrongMap as problem:
            self.refusal = problem

    def keep_connected(self):
        if self.refusal:
            raise self.refusal
        if not self.is_connected and not self.is_connecting() and self.clock() >= self.next_attempt:
            self.next_attempt = self.clock() + RETRY
            self.is_connecting = self.start(self.connect)
        return self.is_connected and not self.is_connecting()

    def has_answered(self, values, sequence):
        echo = self.signals["answered_counter", False]
        return advance(echo, values["answered_counter", 0], count_of(sequence)) == 0

    def exchange(self, encoder, operator):
        """What the PLC says, after it was told; None where the PLC has not computed with it in time."""
        begin = self.clock()
        self.link.write(self.inputs(encoder, operator))
        values = self.link.read()
        if self.map.ticked:
            is_clock_running = self.is_realtime and self.last_exchange is not None  # the plant's, which begins with the first answer
            patience = min(self.map.timeout, self.period) if is_clock_running else self.map.timeout
            while not self.has_answered(values, encoder.sequence):
                if self.clock() > begin + patience:
                    return None
                values = self.link.read()
        self.last_exchange = self.clock()
        self.durations.append(self.last_exchange - begin)
        return values

    def answer(self, encoder):
        operator = self.operators[self.run]
        values = None
        if self.keep_connected():
            try:
                values = self.exchange(encoder, operator)
                if values is None:
                    self.unanswered += 1
            except LinkDown as problem:
                self.failures += 1
                self.trouble = str(problem)
                self.is_connected = False
                self.link.close()
        self.judge_link(values is not None, operator)
        if self.is_latched:
            if self.map.on_link_loss != "trip":
                self.compose(encoder, operator, None)
                self.publish()
        elif values is not None and self.is_new(values, encoder):
            self.compose(encoder, operator, values)
            self.publish()

    def judge_link(self, is_good, operator):
        self.is_released = self.is_released or not operator.acknowledge
        if self.last_exchange is None:
            if not self.is_waiting and self.clock() - self.begin > self.map.timeout:
                self.is_waiting = True
                self.say(f"waiting for the PLC: {self.trouble}")
            return
        silence = self.clock() - self.last_exchange
        if not is_good and not self.is_lost and silence > self.map.timeout:
            if not self.is_realtime:
                raise LinkDown(f"nothing was exchanged with the PLC for {silence:.2f} s ({self.trouble}); in lockstep that ends the run")
            self.is_lost = self.is_latched = True
            self.is_released = not operator.acknowledge
            self.losses += 1
            self.say(f"link lost: nothing was exchanged with the PLC for {silence * 1e3:.0f} ms ({self.trouble}); reaction: {self.map.on_link_loss}")
        elif is_good and self.is_lost:
            self.is_lost = False
            self.say("link is there again; waiting for the operator's acknowledgement with the lever at zero")
        is_acknowledged = operator.acknowledge and self.is_released  # given anew since the loss
        if self.is_latched and not self.is_lost and is_acknowledged and operator.speed_request == 0.0 and not operator.emergency_stop:
            self.is_latched = False
            self.say("link acknowledged")

    def answered_by(self, values, encoder):
        """The sequence of the ENCODER with which the PLC computed; the newest where it does not say."""
        echo = self.signals.get(("answered_counter", False))
        if echo is None:
            return encoder.sequence
        return encoder.sequence - advance(echo, values["answered_counter", 0], count_of(encoder.sequence))

    def is_new(self, values, encoder):
        """Whether the PLC has computed since the last answer that was published."""
        return self.answered_by(values, encoder) > self.published

    def compose(self, encoder, operator, values):
        torque, state = self.types.torque_t(), self.types.controller_state_t()
        groups = range(self.map.group_count)
        answered = encoder.sequence if values is None else self.answered_by(values, encoder)
        for message in (torque, state):
            message.sequence = self.count
            message.simulated_time = encoder.simulated_time - round((encoder.sequence - answered) * self.period * 1e9)
            message.configuration_hash, message.run_identity = encoder.configuration_hash, encoder.run_identity
            message.answered_sequence = answered
            message.group_count = self.map.group_count
        state.proportional_torque = state.integral_torque = [0.0 for _ in groups]
        if values is None:  # on loss of the link
            self.alive += 1
            torque.enable, torque.brake = False, self.map.on_link_loss == "brake"
            torque.acknowledge = False
            torque.motor_torque = [0.0 for _ in groups]
            torque.state_follows, state.mode = True, LINK_LOST
        else:
            counter = self.signals["alive_counter", False]
            now = values["alive_counter", 0]
            if self.plc_alive is not None:
                self.alive += advance(counter, self.plc_alive, now)
            self.plc_alive = now
            torque.enable, torque.brake = values["enable", 0], values["brake", 0]
            torque.acknowledge = values["acknowledge", 0]
            torque.motor_torque = [values["motor_torque", group] for group in groups]
            torque.state_follows = any((name, False) in self.signals for name in STATES)
            for name in STATES:
                if (name, False) in self.signals:
                    setattr(state, name, [values[name, group] for group in groups] if name in GROUP_STATES else values[name, 0])
        torque.alive_counter = self.alive
        self.bytes = state.encode() if torque.state_follows else None, torque.encode()
        self.answered, self.published = encoder.sequence, answered
        self.count += 1

    def serve(self, end):
        """Until `end` is set. Of several ENCODER that came meanwhile the newest counts: a PLC has but one set of registers."""
        patience = self.clock() + self.map.timeout
        while not self.is_realtime and not self.is_connected and not end.is_set():
            self.connect()
            if self.refusal:
                raise self.refusal
            if not self.is_connected and self.clock() > patience:
                raise LinkDown(self.trouble)
            end.wait(0.0 if self.is_connected else RETRY)
        if self.is_realtime:
            self.keep_connected()
        else:
            self.last_exchange = self.clock()
        while not end.is_set():
            try:
                self.bus.handle_timeout(WAIT)
                while self.bus.handle_timeout(0):
                    pass
            except OSError:
                if not end.is_set():  # otherwise a signal has ended the wait
                    raise
            if self.newest is not None:
                encoder, self.newest = self.newest, None
                self.answer(encoder)

    def close(self):
        for subscription in self.subscriptions:
            self.bus.unsubscribe(subscription)
        self.link.close()

    def summary(self):
        """How well it kept time, as `--report` writes it."""
        milliseconds = sorted(1e3 * duration for duration in self.durations)

        def percentile(share):
            return round(milliseconds[min(len(milliseconds) - 1, int(share * len(milliseconds)))], 3) if milliseconds else None

        return {"protocol": self.map.protocol, "period_ms": self.period * 1e3, "exchanges": len(milliseconds),
                "exchange_ms": {"mean": round(statistics.fmean(milliseconds), 3) if milliseconds else None, "p50": percentile(0.5),
                                "p99": percentile(0.99), "p99_9": percentile(0.999), "largest": percentile(1.0)},
                "late_exchanges": sum(each > self.period * 1e3 for each in milliseconds), "unanswered_cycles": self.unanswered,
                "failed_exchanges": self.failures, "link_losses": self.losses}
