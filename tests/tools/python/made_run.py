"""Logs whose content is known in closed form, for the tests of the Python side."""

import json
import math
from pathlib import Path

import lcm

from run_log import message_types

types = message_types()

STOP = 10.0   # [s] emergency stop
END = 20.0    # [s]
HASH = 0x1234
RUN = 0x5678
# Times [s] at which each gearbox crosses its play; 10.0 is the stop's own moment and belongs behind it.
CROSSINGS = [[5.0, 7.5, 10.0, 11.0], [5.0, 15.0]]


def tip_acceleration(time):
    """[m/s^2] two sines before the stop, one behind it."""
    if time < STOP:
        return 0.30 * math.sin(2 * math.pi * 1.3 * time) + 0.12 * math.sin(2 * math.pi * 5.2 * time)
    return 0.80 * math.sin(2 * math.pi * 1.3 * time)


def rope_angle(time):
    """[rad] 3 degrees of swing before the stop, 6 behind it, period 16 s."""
    return math.radians(3.0 if time < STOP else 6.0) * math.sin(2 * math.pi * time / 16.0)


def messages(configuration_hash=HASH, run_identity=RUN):
    """All events of the run in the order of time: (channel, time [ns], message)."""
    events = []

    def add(channel, message, sequence, milliseconds):
        message.sequence = sequence
        message.simulated_time = milliseconds * 1_000_000
        message.configuration_hash = configuration_hash
        message.run_identity = run_identity
        events.append((channel, message.simulated_time, message))

    for k, (milliseconds, request, stop) in enumerate([(0, 0.0, False), (2000, 1.0, False), (10000, 1.0, True)]):
        message = types.operator_t()
        message.speed_request, message.emergency_stop = request, stop
        add("OPERATOR", message, k, milliseconds)
    for k in range(int(END * 200) + 1):
        message = types.sensors_t()
        message.tip_acceleration = tip_acceleration(k * 0.005)
        message.house_acceleration = 0.5 * message.tip_acceleration
        add("SENSORS", message, k, k * 5)
    for k in range(int(END * 100) + 1):
        time = k * 0.01
        truth = types.truth_t()
        truth.group_count = 2
        truth.gearbox_torque = [1e6, -2e6]
        truth.gear_deflection = [0.0, 0.0]
        truth.play_crossings = [sum(1 for t in times if t <= time + 1e-9) for times in CROSSINGS]
        truth.rope_angle = rope_angle(time)
        truth.element_count, truth.shear_force = 3, [1.0, 2.0, 3.0]
        truth.mode_count, truth.modal_energy = 1, [0.5]
        add("TRUTH", truth, k, k * 10)
        if time >= END:
            continue
        encoder = types.encoder_t()
        encoder.group_count = 2
        encoder.shaft_speed, encoder.shaft_position = [100.0, 100.0], [0.0, 0.0]
        add("ENCODER", encoder, k, k * 10)
        torque = types.torque_t()
        torque.answered_sequence = k
        torque.group_count = 2
        torque.motor_torque = [100.0, -50.0] if time < STOP else [-240.0, 30.0]
        add("TORQUE", torque, k, k * 10)
    return sorted(events, key=lambda event: event[1])


def write_log(path, events):
    """Writes (channel, time [ns], message or bytes) as an LCM log."""
    log = lcm.EventLog(str(path), "w", overwrite=True)
    for channel, time, message in events:
        log.write_event(time // 1000, channel, message if isinstance(message, bytes) else message.encode())
    log.close()


def write_run(folder, rated_torque=250.0, play_compensation=True, events=None):
    """A run's folder as `slewlab run` leaves it."""
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    write_log(folder / "run.lcmlog", messages() if events is None else events)
    (folder / "run.json").write_text(json.dumps({
        "rated_torque": rated_torque, "total_ratio": 2000.0, "top_speed": 0.05,
        "play_compensation": play_compensation, "simulated_time": 20.0, "wall_time": 2.0,
        "modes": [{"name": "load 1", "frequency": 0.074, "damping_ratio": 0.006}, {"name": "bending 1", "frequency": 1.3, "damping_ratio": 0.01}],
    }))
    return folder
