"""The gateway between wire and PLC, with a bus, a link and a clock of the test's own: nothing waits and nothing is late."""

import os
import tempfile
import unittest
from types import SimpleNamespace

from core_module import core
from plc.ads import STANDARD_ERROR, AdsLink
from plc.gateway import LINK_LOST, Gateway
from plc.link import LinkDown, WrongMap
from plc.modbus import blocks_of, fill, take
from plc.plc_map import load_plc_map
from plc.soft_cycle import SoftCycle, WrongPeriod
from plc.values import advance, decode, encode
from run_log import REPOSITORY, message_types

MAPS = REPOSITORY / "config" / "plc"
CONTROLLER = REPOSITORY / "config" / "controllers" / "thesis.yaml"
PERIOD = 0.01  # [s]
RUN, OTHER = 5, 6  # run_identity


class Bus:
    def __init__(self):
        self.handlers, self.said = {}, []

    def subscribe(self, channel, handler):
        self.handlers[channel] = handler
        return SimpleNamespace(set_queue_capacity=lambda _: None)

    def publish(self, channel, data):
        self.said.append((channel, data))


class Link:
    """A soft PLC without a wire; `is_down` and `is_stopped` as the test likes."""

    def __init__(self, cycle):
        self.cycle, self.is_down, self.is_stopped, self.connections = cycle, False, False, 0
        self.outputs = dict(cycle.outputs)

    def connect(self):
        if self.is_down:
            raise LinkDown("nobody there")
        self.connections += 1

    def write(self, values):
        if self.is_down:
            raise LinkDown("no answer")
        if not self.is_stopped:
            self.cycle.receive({key: value for key, value in values.items() if key in self.cycle.inputs})
            if not self.cycle.map.ticked:
                self.cycle.compute()

    def read(self):
        return dict(self.cycle.outputs)

    def close(self):
        pass


class GatewayTest(unittest.TestCase):
    def begin(self, name="modbus.yaml", is_realtime=True, **changes):
        self.map = load_plc_map(MAPS / name)
        for key, value in changes.items():
            setattr(self.map, key, value)
        self.now, self.words, self.bus, self.sequence = 100.0, [], Bus(), -1
        self.link = Link(SoftCycle(self.map, CONTROLLER, PERIOD))

        def at_once(function):
            function()
            return lambda: False

        self.gateway = Gateway(self.map, self.link, self.bus, PERIOD, is_realtime, self.words.append, clock=lambda: self.now, start=at_once)
        self.types = message_types()

    def operate(self, speed_request=0.0, acknowledge=False, emergency_stop=False, run=RUN):
        message = self.types.operator_t()
        message.run_identity, message.sequence = run, getattr(self, "moves", 0)
        self.moves = message.sequence + 1
        message.speed_request, message.acknowledge, message.emergency_stop = speed_request, acknowledge, emergency_stop
        self.bus.handlers["OPERATOR"]("OPERATOR", message.encode())

    def ask(self, sequence=None, run=RUN, groups=2):
        """What is published after the next ENCODER: (CONTROLLER_STATE or None, TORQUE), or nothing."""
        self.sequence = self.sequence + 1 if sequence is None else sequence
        self.now += PERIOD
        message = self.types.encoder_t()
        message.sequence, message.run_identity, message.group_count = self.sequence, run, groups
        message.simulated_time = round(self.sequence * PERIOD * 1e9)
        message.shaft_speed = message.shaft_position = [0.0] * groups
        self.bus.said.clear()
        self.bus.handlers["ENCODER"]("ENCODER", message.encode())
        if self.gateway.newest is not None:
            encoder, self.gateway.newest = self.gateway.newest, None
            self.gateway.answer(encoder)
        if not self.bus.said:
            return None
        messages = {channel: data for channel, data in self.bus.said}
        state = self.types.controller_state_t.decode(messages["CONTROLLER_STATE"]) if "CONTROLLER_STATE" in messages else None
        return state, self.types.torque_t.decode(messages["TORQUE"])

    def test_every_encoder_is_answered_by_what_the_plc_computed_with_it(self):
        self.begin("modbus_ticked.yaml", is_realtime=False)
        self.gateway.connect()
        self.operate(1.0)
        native = core.SteppedController(CONTROLLER, PERIOD)
        for sequence in range(20):
            state, torque = self.ask()
            said = native.step(sequence, sequence * PERIOD, [0.0, 0.0], [0.0, 0.0], 1.0, False, False)
            self.assertEqual(torque.motor_torque, tuple(said["motor_torque"]))
            self.assertEqual((torque.answered_sequence, torque.alive_counter, torque.sequence), (sequence, sequence, sequence))
            self.assertEqual((state.ramped_speed, state.answered_sequence), (said["ramped_speed"], sequence))
            self.assertTrue(torque.enable)
        self.assertGreater(state.ramped_speed, 0.0)

    def test_a_soft_plc_that_is_ticked_in_another_period_says_so(self):
        for period in (0.005, 0.02):
            with self.subTest(period=period):
                self.begin("modbus_ticked.yaml", is_realtime=False)
                self.link.cycle.period = period
                self.gateway.connect()
                self.operate(1.0)
                with self.assertRaisesRegex(WrongPeriod, f"found 10 ms of simulated_time .*, expected {1e3 * period:g} ms .*: --period-ms 10 is right"):
                    for _ in range(3):
                        self.ask()
        self.begin("modbus_ticked.yaml", is_realtime=False)
        self.gateway.connect()
        self.operate(1.0)
        for sequence in (0, 3, 4, 9):  # ENCODER that were lost are no other period
            self.ask(sequence)

    def test_a_repeated_question_gets_the_same_bytes(self):
        self.begin()
        self.operate()
        self.ask()
        first = list(self.bus.said)
        self.ask(sequence=0)
        self.assertEqual(self.bus.said, first)
        self.assertEqual(self.link.cycle.cycles, 1)

    def test_a_lost_link_is_a_fault_with_its_own_reaction_until_acknowledged(self):
        for reaction, brake in (("brake", True), ("let_go", False)):
            with self.subTest(reaction):
                self.begin(on_link_loss=reaction, timeout=0.095)
                self.operate(1.0)
                for _ in range(5):
                    state, torque = self.ask()
                self.assertTrue(torque.enable)
                self.link.is_down = True
                silent = 0
                while (answer := self.ask()) is None:
                    silent += 1
                self.assertEqual(silent, 9)  # periods of 10 ms within the time-out of 95 ms: the drive holds
                alive = answer[1].alive_counter
                state, torque = self.ask()
                self.assertEqual(state.mode, LINK_LOST)
                self.assertEqual((torque.enable, torque.brake, torque.motor_torque), (False, brake, (0.0, 0.0)))
                self.assertEqual(torque.alive_counter, alive + 1)  # no trip by a frozen counter
                self.assertIn("link lost: nothing was exchanged with the PLC for 100 ms (no answer)", self.words[0])
                self.link.is_down = False
                for _ in range(100):
                    state, torque = self.ask()
                self.assertEqual(state.mode, LINK_LOST)  # there again, and not acknowledged
                self.assertGreater(self.link.connections, 1)
                self.operate(1.0, acknowledge=True)
                self.assertEqual(self.ask()[0].mode, LINK_LOST)  # not with the lever out of zero
                self.operate(0.0, acknowledge=True)
                state, torque = self.ask()
                self.assertNotEqual(state.mode, LINK_LOST)
                self.assertTrue(torque.enable)
                self.assertEqual(self.gateway.summary()["link_losses"], 1)

    def test_an_acknowledgement_from_before_the_loss_is_worth_nothing(self):
        self.begin()
        self.operate(0.0, acknowledge=True)
        self.ask()
        self.link.is_down = True
        for _ in range(20):
            self.ask()
        self.link.is_down = False
        for _ in range(100):
            state, _ = self.ask()
        self.assertEqual(state.mode, LINK_LOST)
        self.operate(0.0)
        self.ask()
        self.operate(0.0, acknowledge=True)
        self.assertNotEqual(self.ask()[0].mode, LINK_LOST)

    def test_reaction_trip_is_silence(self):
        self.begin(on_link_loss="trip")
        self.operate()
        self.assertIsNotNone(self.ask())
        self.link.is_down = True
        self.assertEqual([self.ask() for _ in range(50)], [None] * 50)

    def test_a_link_that_was_never_there_is_waited_for(self):
        self.begin()
        self.link.is_down = True
        self.operate()
        self.assertEqual([self.ask() for _ in range(50)], [None] * 50)
        self.assertEqual(self.words, ["waiting for the PLC: nobody there"])
        self.link.is_down = False
        self.now += 1.0
        self.assertEqual(self.ask()[0].mode, 0)

    def test_a_plc_that_stops_is_no_lost_link(self):
        """It answers and does not compute: its alive counter stands still, by which the drive trips."""
        self.begin()
        self.operate()
        counted = [self.ask()[1].alive_counter for _ in range(5)]
        self.assertEqual(counted, [0, 1, 2, 3, 4])
        self.link.is_stopped = True
        self.assertEqual({self.ask()[1].alive_counter for _ in range(50)}, {4})
        self.assertEqual(self.words, [])

    def test_a_plc_that_says_what_it_answers_is_heard_once_per_answer(self):
        self.begin("modbus_ticked.yaml", ticked=False)
        self.operate()
        self.assertEqual(self.ask()[1].answered_sequence, 0)
        self.link.is_stopped = True
        self.assertEqual([self.ask() for _ in range(3)], [None] * 3)
        self.link.is_stopped = False
        self.assertEqual(self.ask()[1].answered_sequence, 4)

    def test_in_lockstep_a_lost_link_ends_the_run(self):
        self.begin("modbus_ticked.yaml", is_realtime=False, timeout=0.1)
        self.gateway.connect()
        self.operate()
        self.ask()
        self.link.is_down = True
        with self.assertRaisesRegex(LinkDown, "in lockstep that ends the run"):
            for _ in range(20):
                self.ask()

    def test_another_number_of_motor_groups_is_refused(self):
        self.begin()
        self.operate()
        with self.assertRaisesRegex(WrongMap, r"signals of 2 motor group\(s\), this run's machine has 1"):
            self.ask(groups=1)

    def test_another_run_counts_from_its_second_message_on(self):
        self.begin()
        self.operate()
        self.ask()
        self.operate(run=OTHER)
        self.assertIsNone(self.ask(sequence=0, run=OTHER))
        self.assertEqual(self.ask(sequence=1000, run=OTHER)[1].run_identity, OTHER)


class AdsTest(unittest.TestCase):
    def test_what_its_library_remarks_while_the_link_is_closed_is_no_word_of_the_bridge(self):
        link = AdsLink.__new__(AdsLink)
        link.plc = SimpleNamespace(close=lambda: os.write(STANDARD_ERROR, b"Info: connection closed by remote\n"))
        kept = os.dup(STANDARD_ERROR)
        with tempfile.TemporaryFile() as said:
            os.dup2(said.fileno(), STANDARD_ERROR)
            try:
                link.close()
                os.write(STANDARD_ERROR, b"a word of the bridge\n")
            finally:
                os.dup2(kept, STANDARD_ERROR)
                os.close(kept)
            said.seek(0)
            self.assertEqual(said.read(), b"a word of the bridge\n")


class ValuesTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.maps = {name: load_plc_map(MAPS / f"{name}.yaml") for name in ("modbus", "modbus_ticked")}

    def signal(self, name, to_plc, of="modbus"):
        return next(each for each in self.maps[of].signals if each.name == name and each.to_plc == to_plc)

    def test_scales_round_and_hold_at_the_end_of_the_range(self):
        speed = self.signal("shaft_speed", True)  # int16, 0.005 rad/s
        self.assertEqual(encode(speed, 1.0), 200)
        self.assertEqual(encode(speed, -0.0074), -1)
        self.assertEqual(encode(speed, 1e9), 32767)
        self.assertEqual(encode(speed, float("-inf")), -32768)
        self.assertEqual(encode(speed, float("nan")), -32768)
        self.assertEqual(decode(speed, -200), -1.0)

    def test_an_inverted_flag_is_false_where_the_signal_is_true(self):
        stop = self.signal("emergency_stop", True)
        self.assertIs(encode(stop, True), False)
        self.assertIs(decode(stop, False), True)

    def test_counters_wrap(self):
        counter = self.signal("alive_counter", True)  # uint16
        self.assertEqual(encode(counter, 65537), 1)
        self.assertEqual(advance(counter, 65535, 1), 2)

    def test_registers_hold_what_was_put_into_them(self):
        for name, plc_map in self.maps.items():
            inputs = [signal for signal in plc_map.signals if signal.to_plc]
            values = {(signal.name, signal.group): True if signal.type == "bool" else 7 if signal.name == "alive_counter" else 0.5 for signal in inputs}
            found = {}
            for block in blocks_of(inputs):
                found |= take(block, fill(block, values, plc_map.high_word_first), plc_map.high_word_first)
            self.assertEqual(found, values, name)

    def test_the_order_of_words_is_the_maps(self):
        # 1.0 in 64 bits is 3FF0 0000 0000 0000.
        torque = self.signal("motor_torque", False, "modbus_ticked")
        block = blocks_of([torque])[0]
        self.assertEqual(fill(block, {("motor_torque", 0): 1.0}, True), [0x3FF0, 0, 0, 0])
        self.assertEqual(fill(block, {("motor_torque", 0): 1.0}, False), [0, 0, 0, 0x3FF0])

    def test_neighbours_go_in_one_request(self):
        outputs = [signal for signal in self.maps["modbus"].signals if not signal.to_plc]
        self.assertEqual([str(block) for block in blocks_of(outputs)], ["input 0 to 4"])


if __name__ == "__main__":
    unittest.main()
