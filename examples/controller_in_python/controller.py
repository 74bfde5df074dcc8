"""The slewing controller of T.A. van Vugt's thesis (3.5) in one file: a controller of one's own to start from.

    slewlab run config/scenarios/thesis_slew.yaml --controller "python3 examples/controller_in_python/controller.py"

It needs the package lcm (pip install lcm) and the messages as Python classes (lcm-gen --python msgs/*.lcm writes the
folder slewlab_msgs; put where it lies into PYTHONPATH). What plant and controller say to each other: docs/wire.md.

Speeds are those of the slew axis [rad/s] unless they are called shaft speeds (fast axis, at the motor); torques are per
motor [N m]; time is in seconds.
"""

import math
import os
import struct

import lcm
from slewlab_msgs import controller_state_t, encoder_t, operator_t, torque_t

# The crane's and the controller's numbers; the same as config/controllers/thesis.yaml.
PERIOD = float(os.environ.get("SLEWLAB_CONTROLLER_PERIOD_MS", "10")) * 1e-3  # [s] slewlab run sets it
GROUPS = 2                   # thesis 2.3: two groups of motors
RATIO = 2735.58              # thesis 2.10: gearbox 215.4, pinion 12.7
RATED_TORQUE = 250.0         # [N m] T100; chosen
TORQUE_LIMIT = 250.0         # [N m] T100; thesis 3.5
TORQUE_RATE = 12500.0        # [N m/s] chosen: T100 in 20 ms
TOP_SPEED = 0.05             # [rad/s] chosen; with the times below the accelerations of thesis Table 4.2
CHANGE_TIME = 4.4            # [s] from 0 to top speed and back; thesis 3.5
EMERGENCY_STOP_TIME = 1.5    # [s] from top speed to 0; thesis Table 4.2
CURVED_SHARE = 0.3           # of the ramp's time, at each end; chosen
GAIN = 40.0                  # [N m s/rad] proportional, fast axis; chosen
INTEGRAL_TIME = 1.0          # [s] chosen
# Readings that are refused, of the motor shafts.
SPEED_LIMIT = 1.3 * TOP_SPEED * RATIO  # [rad/s] 130 % of top speed; chosen
ACCELERATION_LIMIT = 800.0   # [rad/s^2] what motor, brake and gears can do to a motor; chosen
TOLERANCE = 0.03 * TOP_SPEED * RATIO   # [rad/s] noise and counting of an encoder; chosen
HOLD_TIME = 0.05             # [s] for which a refused reading is held over; chosen
PLAY_MAP = [                 # average, half 1, half 2 in shares of T100; thesis Table 3.4
    (0.0, 0.10, -0.10), (0.18, 0.46, -0.10), (0.415, 0.93, -0.10),
    (0.48, 0.93, 0.03), (0.57, 0.88, 0.24), (1.0, 1.0, 1.0)]

STOPPED, RUNNING, EMERGENCY_STOP, WAITING = 0, 1, 2, 3  # CONTROLLER_STATE.mode


def clamp(value, lowest, highest):
    return max(lowest, min(highest, value))


class Ramp:
    """From the requested to the commanded speed, with an acceleration that is a trapezoid (an S-curve of speed). A
    change of target on the way begins a new profile from the speed and acceleration of that moment."""

    def __init__(self):
        self.speed = self.acceleration = self.target = 0.0
        self.moving = self.stopping = False
        self.jerk = 0.0

    def step(self, target):
        self._advance()
        target = clamp(target, -TOP_SPEED, TOP_SPEED)
        if target != self.target or self.stopping:
            self.stopping = False
            self._begin_s_curve(target)

    def emergency_stop(self):
        """Linear to zero (thesis 4.2)."""
        self._advance()
        if self.stopping:
            return
        self.stopping = True
        duration = EMERGENCY_STOP_TIME * abs(self.speed) / TOP_SPEED
        self.jerk = 0.0
        if duration == 0.0:
            self.target = 0.0
            self._arrive()
            return
        self.acceleration = (0.0 - self.speed) / duration
        self._begin(0.0, self.acceleration, 0.0, duration, 0.0)

    def _begin(self, target, peak, rise, hold, fall):
        self.target, self.peak, self.rise, self.hold, self.fall = target, peak, rise, hold, fall
        self.start_speed, self.start_acceleration = self.speed, self.acceleration
        self.elapsed, self.moving = 0.0, True

    def _arrive(self):
        self.speed, self.acceleration, self.moving = self.target, 0.0, False

    def _let_go(self, jerk):
        """The speed at which the acceleration would end if it were taken away at once."""
        return self.speed + 0.5 * self.acceleration * abs(self.acceleration) / jerk

    def _begin_s_curve(self, target):
        change = target - self.speed
        if change == 0.0 and self.acceleration == 0.0:
            self.target = target
            self._arrive()
            return
        full, jerk = abs(self.acceleration), self.jerk
        if change != 0.0:
            # Half a change takes half the time. Through zero: the way down and the way up.
            if self.speed * target < 0.0:
                way = abs(self.speed) * CHANGE_TIME + abs(target) * CHANGE_TIME
            else:
                way = abs(abs(target) - abs(self.speed)) * CHANGE_TIME
            time = way / TOP_SPEED
            full = abs(change) / (time * (1.0 - CURVED_SHARE))
            from_rest = full / (CURVED_SHARE * time)
            if self.acceleration == 0.0 or self.jerk == 0.0:
                jerk = from_rest
            else:  # gentler where the acceleration leads to the new target, else as it is
                gentler = min(self.jerk, from_rest)
                leads_there = (target - self._let_go(gentler)) * self.acceleration >= 0.0
                jerk = gentler if leads_there else self.jerk
        a0 = self.acceleration
        direction = 1.0 if target >= self._let_go(jerk) else -1.0
        peak = direction * min(full, math.sqrt(max(0.0, direction * jerk * change + 0.5 * a0 * a0)))
        rise, fall = abs(peak - a0) / jerk, abs(peak) / jerk
        held = change - 0.5 * (a0 + peak) * rise - 0.5 * peak * fall
        self.jerk = jerk
        self._begin(target, peak, rise, 0.0 if peak == 0.0 else max(0.0, held / peak), fall)

    def _advance(self):
        if not self.moving:
            return
        self.elapsed += PERIOD
        t, a0, peak = self.elapsed, self.start_acceleration, self.peak
        held_until = self.rise + self.hold
        left = held_until + self.fall - t
        if left <= 0.0:
            self._arrive()
        elif t < self.rise:
            part = t / self.rise
            self.acceleration = a0 + (peak - a0) * part
            self.speed = self.start_speed + t * (a0 + 0.5 * (peak - a0) * part)
        elif t < held_until:
            self.acceleration = peak
            self.speed = self.start_speed + 0.5 * (a0 + peak) * self.rise + peak * (t - self.rise)
        else:
            self.acceleration = peak * left / self.fall
            self.speed = self.target - 0.5 * self.acceleration * left


class SpeedControl:
    """PI of one motor group, by the trapezoidal rule; the integral stops where the torque stands at its limit."""

    def __init__(self):
        self.integral = self.error = self.proportional = 0.0

    def step(self, error):
        half_step = 0.5 * PERIOD * GAIN / INTEGRAL_TIME
        wanted = (GAIN + half_step) * error + (self.integral + half_step * self.error)
        growth = half_step * (error + self.error)
        winds_up = (wanted > TORQUE_LIMIT and growth > 0.0) or (wanted < -TORQUE_LIMIT and growth < 0.0)
        if not winds_up:
            self.integral += growth
        self.integral = clamp(self.integral, -TORQUE_LIMIT, TORQUE_LIMIT)
        self.error = error
        self.proportional = GAIN * error
        return clamp(wanted, -TORQUE_LIMIT, TORQUE_LIMIT)


def play_map(average):
    """Shares of T100 of the two halves, which work against each other so that the gears stay under tension."""
    size = abs(average)
    last, half_1, half_2 = PLAY_MAP[-1]
    beyond = max(0.0, size - last)
    half_1, half_2 = half_1 + beyond, half_2 + beyond
    for (a, a1, a2), (b, b1, b2) in zip(PLAY_MAP, PLAY_MAP[1:]):
        if size < b:
            share = (size - a) / (b - a)
            half_1, half_2 = a1 + share * (b1 - a1), a2 + share * (b2 - a2)
            break
    return (half_1, half_2) if average >= 0.0 else (-half_2, -half_1)


class Monitor:
    """Refuses readings that the machine cannot have made: a flipped bit, a frozen counter, a reading out of its time
    (controller/plausibility.h has the equations). One alone does no harm: the speeds before it are held."""

    def __init__(self):
        self.last = None          # plausible reading
        self.refused = 0          # in a row
        self.distrusted = False   # until plausible for HOLD_TIME
        self.plausible = 0        # in a row, while distrusted

    def judge(self, encoder):
        """The speeds to control by; None where there is nothing to control by."""
        longest = HOLD_TIME * (1.0 + 1e-9)
        if encoder.group_count != GROUPS or not all(map(math.isfinite, encoder.shaft_speed)):
            self.__init__()       # no signal: an encoder says so
            self.distrusted = True
            return None
        in_range = (all(abs(speed) <= SPEED_LIMIT for speed in encoder.shaft_speed)
                    and all(map(math.isfinite, encoder.shaft_position)))
        if in_range and (self.last is None or self._can_follow(encoder)):
            self.last, self.refused = encoder, 0
            if self.distrusted:
                self.plausible += 1
                if self.plausible * PERIOD <= longest:
                    return None
            self.distrusted, self.plausible = False, 0
            return encoder.shaft_speed
        self.plausible = 0
        if not self.distrusted and self.last is not None:
            self.refused += 1
            if self.refused * PERIOD <= longest:
                return self.last.shaft_speed
        self.distrusted = True
        self.last = encoder if in_range else None
        return None

    def _can_follow(self, encoder):
        last = self.last
        cycles = encoder.sequence - last.sequence
        elapsed = (encoder.simulated_time - last.simulated_time) * 1e-9
        if not (elapsed > 0.0 and abs(elapsed - cycles * PERIOD) <= 0.5 * PERIOD):
            return False
        change = ACCELERATION_LIMIT * elapsed
        for speed, before, position, position_before in zip(
                encoder.shaft_speed, last.shaft_speed, encoder.shaft_position, last.shaft_position):
            turned = (position - position_before) / elapsed
            if abs(speed - before) > change + TOLERANCE:
                return False
            if abs(turned - 0.5 * (speed + before)) > 0.25 * change + TOLERANCE:
                return False
        return True


class Controller:
    """One step per ENCODER: fills in TORQUE and CONTROLLER_STATE."""

    def __init__(self):
        self.monitor = Monitor()
        self.start_afresh()

    def start_afresh(self):
        self.mode = STOPPED
        self.ramp = Ramp()
        self.control = [SpeedControl() for _ in range(GROUPS)]
        self.commanded = [0.0] * GROUPS
        self.unusable = False

    def step(self, encoder, operator, torque, state):
        request = clamp(operator.speed_request, -1.0, 1.0) if math.isfinite(operator.speed_request) else 0.0
        acknowledged = operator.acknowledge and not operator.emergency_stop and request == 0.0
        shaft_speed = self.monitor.judge(encoder)
        torque.acknowledge = operator.acknowledge and request == 0.0  # with the joystick at zero alone
        torque.group_count = state.group_count = GROUPS
        if shaft_speed is None or (self.unusable and not acknowledged):
            self._let_go(torque, state)
            return
        self.unusable = False

        if operator.emergency_stop:
            self.mode = EMERGENCY_STOP
        if self.mode in (EMERGENCY_STOP, WAITING):  # latched: it ends at rest, let go of, and acknowledged
            self.ramp.emergency_stop()
            if not self.ramp.moving and not operator.emergency_stop:
                self.mode = STOPPED if operator.acknowledge and request == 0.0 else WAITING
        else:
            self.ramp.step(request * TOP_SPEED)
            self.mode = RUNNING if self.ramp.target != 0.0 or self.ramp.moving else STOPPED

        reference = self.ramp.speed * RATIO
        controlled = [c.step(reference - speed) for c, speed in zip(self.control, shaft_speed)]
        average = sum(controlled) / GROUPS
        # One integral for both: integrals of their own would work the play compensation's offset off.
        shared = sum(c.integral for c in self.control) / GROUPS
        halves = play_map(average / RATED_TORQUE)
        for i, control in enumerate(self.control):
            control.integral = shared
            wanted = controlled[i] + (halves[i] * RATED_TORQUE - average)
            reach = TORQUE_RATE * PERIOD
            wanted = clamp(wanted, self.commanded[i] - reach, self.commanded[i] + reach)
            self.commanded[i] = clamp(wanted, -TORQUE_LIMIT, TORQUE_LIMIT)

        torque.enable, torque.brake = True, False
        torque.motor_torque = list(self.commanded)
        state.mode = self.mode
        state.ramped_speed = self.ramp.speed
        state.average_torque = average
        state.offset_torque = 0.5 * ((halves[0] * RATED_TORQUE - average) - (halves[1] * RATED_TORQUE - average))
        state.proportional_torque = [c.proportional for c in self.control]
        state.integral_torque = [c.integral for c in self.control]

    def _let_go(self, torque, state):
        """Nothing to control by: no torque, brakes, until acknowledged."""
        self.start_afresh()
        self.mode, self.unusable = WAITING, True
        torque.enable, torque.brake = False, True
        torque.motor_torque = [0.0] * GROUPS
        state.mode, state.ramped_speed, state.average_torque, state.offset_torque = WAITING, 0.0, 0.0, 0.0
        state.proportional_torque = state.integral_torque = [0.0] * GROUPS


def decoded(message_class, data):
    """The message; None where the bytes are none: a bit that turned over on its way."""
    try:
        return message_class.decode(data)
    except (ValueError, struct.error):
        return None


class Answers:
    """The wire (docs/wire.md): every ENCODER gets one answer, a repeated one the same bytes again."""

    def __init__(self, bus):
        self.bus = bus
        self.run = None             # run_identity of the run that is answered
        self.candidate = None       # that of another one, heard once
        self.operator = None        # the newest OPERATOR of this run
        self.other_operator = None  # the newest of another run, whose ENCODER may follow
        for channel, handler in (("OPERATOR", self.on_operator), ("ENCODER", self.on_encoder)):
            bus.subscribe(channel, handler).set_queue_capacity(0)  # unlimited: by default the newest are dropped

    def on_operator(self, channel, data):
        message = decoded(operator_t, data)
        if message is None:
            return
        of_this_run = message.run_identity == self.run
        held = self.operator if of_this_run else self.other_operator
        if held and message.run_identity == held.run_identity and message.sequence <= held.sequence:
            return
        if of_this_run:
            self.operator = message
        else:
            self.other_operator = message

    def begin_run(self, run):
        """A run begins with the controller's state anew."""
        self.run, self.candidate = run, None
        self.controller = Controller()
        self.answered = -1  # the newest ENCODER answered
        self.answered_time = 0  # [ns] of that one
        self.leaps = 0  # in a row: ENCODER whose sequence and time do not fit each other
        self.count = 0
        self.bytes = None
        newest, self.other_operator = self.other_operator, None
        self.operator = newest if newest and newest.run_identity == run else None

    def is_of_this_run(self, encoder):
        """An ENCODER of another run begins that run. One alone may be a bit that turned over; the second counts."""
        if encoder.run_identity == self.run:
            self.candidate = None
            return True
        if self.run is not None and encoder.run_identity != self.candidate:
            self.candidate = encoder.run_identity
            return False
        self.begin_run(encoder.run_identity)
        return True

    def comes_in_its_time(self, encoder):
        """A sequence that leaps while the time does not may be a bit that turned over, and whoever believed it would take
        all that come after it for old. The second in a row counts."""
        cycles = encoder.sequence - self.answered
        elapsed = (encoder.simulated_time - self.answered_time) * 1e-9
        fits = self.answered < 0 or cycles == 1 or abs(elapsed - cycles * PERIOD) <= 0.5 * PERIOD
        self.leaps = 0 if fits else self.leaps + 1
        return fits or self.leaps >= 2

    def on_encoder(self, channel, data):
        encoder = decoded(encoder_t, data)
        if encoder is None or not self.is_of_this_run(encoder) or encoder.sequence < self.answered:
            return
        if encoder.sequence > self.answered:
            if self.operator is None or self.operator.sequence < encoder.operator_sequence:
                return  # that OPERATOR was lost; both will be sent again
            if not self.comes_in_its_time(encoder):
                return
            self.compute(encoder)
        self.bus.publish("CONTROLLER_STATE", self.bytes[0])
        self.bus.publish("TORQUE", self.bytes[1])

    def compute(self, encoder):
        torque, state = torque_t(), controller_state_t()
        for message in (torque, state):
            message.sequence = self.count
            message.simulated_time = encoder.simulated_time
            message.configuration_hash = encoder.configuration_hash
            message.run_identity = encoder.run_identity
            message.answered_sequence = encoder.sequence
        torque.alive_counter = self.count
        torque.state_follows = True
        self.controller.step(encoder, self.operator, torque, state)
        self.count += 1
        self.answered, self.answered_time = encoder.sequence, encoder.simulated_time
        self.bytes = (state.encode(), torque.encode())


def main():
    bus = lcm.LCM(os.environ["SLEWLAB_BUS"])
    answers = Answers(bus)  # keep it: it holds the subscriptions' handlers
    assert answers
    while True:
        bus.handle()  # until SIGTERM ends the process


if __name__ == "__main__":
    main()
