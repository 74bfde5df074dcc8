"""What the page draws of a run: charts with their units, and what the crane's picture and the state panel need."""

import numpy as np

from desk.source import HELD, SPORADIC
from spectrum import Spectrum

GROUPS = 8  # [-] the most that a machine has

TRIPPED = 2
DRIVE_STATES = {0: "ready", 1: "running", TRIPPED: "tripped", 3: "braked"}
CONTROLLER_MODES = {0: "stopped", 1: "running", 2: "emergency stop", 3: "waiting for acknowledgement", 4: "link to the PLC lost"}
# The codes of docs/wire.md, in words.
TRIP_CAUSES = {
    0: "",
    1: "a message on TORQUE was cut off",
    2: "a message on TORQUE was of another version",
    3: "what came on TORQUE was no message",
    4: "TORQUE of another configuration or run",
    5: "TORQUE answered the wrong ENCODER",
    6: "TORQUE answered an ENCODER twice",
    7: "TORQUE was for another number of motor groups",
    8: "a commanded torque was not a number",
    9: "a commanded torque was infinite",
    10: "a commanded torque was beyond the drive's limit",
    11: "a commanded torque changed faster than the drive allows",
    12: "the controller's alive counter stood still",
    13: "no command came from the controller in time",
    14: "a motor group was lost",
    15: "the main power was lost",
}


def series(signal, label, scale=1.0, colour=0, **more):
    """`held`: stands until the next value; `dash`: drawn broken; `band`: filled between this one and the one before."""
    return {"signal": signal, "label": label, "scale": scale, "colour": colour} | more


def is_axis(facts):
    return facts.get("machine", {}).get("kind") == "axis"


def ratio_of(facts):
    """Motor shaft per axis. Of a plain axis the machine's: the controller's may be of another unit."""
    return facts["machine"]["ratio"] if is_axis(facts) else facts.get("total_ratio")


def quantities(facts):
    """What the position, the motors' torque and that at the gearbox are called and shown in: {"position", "effort", "gear"}."""
    if not is_axis(facts):
        return {"position": {"title": "slew angle", "unit": "°", "scale": 180.0 / np.pi},
                "effort": {"title": "motor torque", "missing": "missing torque", "unit": "N m per motor", "share": "% of T100"},
                "gear": {"title": "gearbox torque", "unit": "MN m", "of": " on the slew axis", "scale": 1e-6}}
    is_force = any(effort["name"] == "motor force" for effort in facts["machine"].get("efforts", []))  # of a motor that does not turn
    unit = facts["machine"].get("position_unit", "rad")
    is_linear = unit == "m"
    return {"position": {"title": "position of the axis" if is_linear else "angle of the axis", "unit": unit, "scale": 1.0},
            "effort": ({"title": "motor force", "missing": "missing force", "unit": "N per motor", "share": "% of the rated force"} if is_force
                       else {"title": "motor torque", "missing": "missing torque", "unit": "N m per motor", "share": "% of T100"}),
            "gear": ({"title": "force on the axis", "unit": "kN", "of": "", "scale": 1e-3} | ({"label": "axis"} if is_force else {}) if is_linear
                     else {"title": "gearbox torque", "unit": "kN m", "of": " on the axis", "scale": 1e-3})}


def charts(facts, store):
    """The charts of a run, those that its signals allow."""
    of_axis, ratio, top, rated = is_axis(facts), ratio_of(facts), facts.get("top_speed"), facts.get("rated_torque")
    machine = facts.get("machine", {})
    position, effort, gear = (quantities(facts)[name] for name in ("position", "effort", "gear"))
    groups = range(GROUPS)
    share = 100.0 / rated if rated else 1.0
    speed_unit = machine.get("speed_unit", "rad/s")
    found = [
        {"title": "speed of the axis" if of_axis else "slewing speed" if ratio else "motor speed", "unit": speed_unit, "series": [
            *([series("OPERATOR.speed_request", "request", top, "grey", held=True, dash=True)] if top else []),
            *[series(f"ENCODER.shaft_speed.{g}", f"motors {g + 1}", 1.0 / (ratio or 1.0), g) for g in groups],
            *([series("CONTROLLER_STATE.ramped_speed", "ramp", 1.0, "ramp", dash=True)] if ratio else []),
            *([series("TRUTH.house_speed", "axis" if of_axis else "house", 1.0, "house")] if ratio else [])]},
        {"title": effort["title"], "unit": effort["share" if rated else "unit"], "series": [
            *[series(f"TORQUE.motor_torque.{g}", f"group {g + 1}", share, g, held=True) for g in groups],
            *([series("compensation.high", "compensation, upper", share, "band", held=True, dash=True),
               series("compensation.low", "compensation, lower", share, "band", held=True, dash=True, band=True)]
              if compensates(store) else [])]},
        {"title": gear["title"], "unit": gear["unit"] + gear["of"], "series": [
            series(f"TRUTH.gearbox_torque.{g}", gear.get("label", f"gearbox {g + 1}"), gear["scale"], g) for g in groups]},
        {"title": "acceleration, lateral", "unit": "m/s²", "series": [
            series("SENSORS.tip_acceleration", "tip", 1.0, 0), series("SENSORS.middle_acceleration", "middle", 1.0, 1),
            series("SENSORS.pivot_acceleration", "pivot", 1.0, 3), series("SENSORS.house_acceleration", "house", 1.0, "house")]},
        {"title": "sidelead (swing of the load across the boom)", "unit": "°", "series": [
            *([] if of_axis else [series("TRUTH.rope_angle", "rope", 180.0 / np.pi, 0), series("TRUTH.rod_angle", "load", 180.0 / np.pi, 1)])]},
        {"title": position["title"], "unit": position["unit"], "series": [
            series("SENSORS.slew_angle", "axis" if of_axis else "house", position["scale"], "house")]},
    ]
    observed = [
        {"title": f"{effort['missing']}, of the machine against its nominal model", "unit": effort["share" if rated else "unit"],
         "series": [series(f"OBSERVER.missing_torque.{g}", f"group {g + 1}", share, g) for g in groups]},
        {"title": "acceleration, measured minus observer", "unit": "m/s²", "series": [
            series(f"OBSERVER.{place}_difference", place, 1.0, colour)
            for place, colour in (("tip", 0), ("middle", 1), ("pivot", 3), ("house", "house"))]}]
    found = observed + found
    for chart in found:
        chart["series"] = [each for each in chart["series"] if is_there(each["signal"], store)]
    return [chart for chart in found if chart["series"]]


def is_there(signal, store):
    if signal in DERIVED:
        return all(store.has(part) for part in DERIVED[signal])
    return store.told(signal)


def compensates(store):
    """Whether the play compensation has ever held the groups against each other: it may be switched while the run goes on."""
    if not store.has("CONTROLLER_STATE.offset_torque"):
        return False
    name, row = store.places["CONTROLLER_STATE.offset_torque"]
    return any(level.count and (level.low[row, :level.count].any() or level.high[row, :level.count].any())
               for level in store.channels[name].levels)


COMPENSATION = (("compensation.high", 1.0), ("compensation.low", -1.0))
# Made of two signals of one channel: mean torque plus and minus half the difference that the play compensation adds.
DERIVED = {"compensation.high": ("CONTROLLER_STATE.average_torque", "CONTROLLER_STATE.offset_torque"),
           "compensation.low": ("CONTROLLER_STATE.average_torque", "CONTROLLER_STATE.offset_torque")}


def plain(signals):
    """Signals of messages, those too that others are derived of."""
    return sorted({part for signal in signals for part in DERIVED.get(signal, (signal,))})


def channel_of(signal):
    return DERIVED.get(signal, (signal,))[0].split(".")[0]


def expected(store, name, now):
    """Up to when [s] a channel's messages should be there. The observer goes on when PLANT_STATUS has said whether the drive had tripped, so
    by the newest of these it is at the one before; where none comes, it goes on as long as what it hears does."""
    if name != "OBSERVER":
        return now
    if "PLANT_STATUS" in store.channels:
        return min(now, store.channels["PLANT_STATUS"].newest_but_one)
    heard = [store.channels[each] for each in ("ENCODER", "TORQUE") if each in store.channels]
    return now if any(channel.is_over(now) for channel in heard) else -np.inf


def silent(store, time):
    """Channels of which messages are missing at a time: before others, or since their newest one."""
    now = min(time, store.last)
    return {name for name, channel in store.channels.items()
            if name not in SPORADIC and (channel.holes_within(time, time) or channel.is_over(expected(store, name, now)))}


def holes(store, signals, first, last, bins):
    """{signal: [[begin, end], ...]} of the window's columns between those that hold the messages before and behind a hole, or behind the last
    one of a channel that has stopped; of what is said when something changes, no message is missing."""
    def column(time):
        return int((time - first) / (last - first) * bins)

    of_channel = {}
    for name in {channel_of(signal) for signal in signals} - set(SPORADIC):
        channel = store.channels.get(name)
        within = list(channel.holes_within(first, last)) if channel is not None else []
        if channel is not None and channel.last_time < last and channel.is_over(expected(store, name, store.last)):
            within.append((channel.last_time, last))
        columns = [[column(before) + 1 if before >= first else 0, min(bins, column(behind))] for before, behind in within]
        of_channel[name] = [[begin, end] for begin, end in columns if begin < end]
    return {signal: of_channel[channel_of(signal)] for signal in signals if of_channel.get(channel_of(signal))}


def values(store, signals, time):
    """{signal: (lowest, highest)} of what was said last at a time: twice the sample's value, or what a piece of a long run holds of which
    no sample is kept. Nothing where messages are missing."""
    found = store.ranges_at(plain(signals), time)
    for signal, sign in COMPENSATION:
        if signal in signals and all(part in found for part in DERIVED[signal]):
            (low, high), (offset_low, offset_high) = (found[part] for part in DERIVED[signal])
            offset = 0.5 * (offset_low + offset_high)
            found[signal] = low + sign * offset, high + sign * offset
    missing = silent(store, time)
    return {signal: found[signal] for signal in signals if signal in found and channel_of(signal) not in missing}


def envelopes(store, signals, first, last, bins):
    """{signal: (low, high)} with what is derived; what stands until the next value stands there, but not where messages are missing."""
    found = store.envelopes(plain(signals), first, last, bins)
    missing = holes(store, found, first, last, bins)
    for signal, envelope in found.items():
        if signal.split(".")[0] in HELD:
            store.hold(signal, envelope, first, last)
        for begin, end in missing.get(signal, ()):
            for part in envelope:
                part[begin:end] = np.nan
    for signal, sign in COMPENSATION:
        if signal in signals and all(part in found for part in DERIVED[signal]):
            (low, high), (offset_low, offset_high) = (found[part] for part in DERIVED[signal])
            offset = 0.5 * (offset_low + offset_high)
            found[signal] = low + sign * offset, high + sign * offset
    return found


def evenly(time, values, segment):
    """(series, step [s]) of samples at even times, up to the newest: a spectrum takes its segments from the beginning, so the series begins
    where the last one ends with the last sample."""
    step = (time[-1] - time[0]) / (len(time) - 1)
    even = np.interp(np.linspace(time[0], time[-1], len(time)), time, values)
    spectrum = Spectrum(step, segment)
    return even[(len(even) - spectrum.length) % spectrum.hop if len(even) > spectrum.length else 0:], step


def pose(facts, store, time):
    """Where everything of the crane is at a time: SI units, None for what the log does not tell, or not there."""
    missing = silent(store, time)

    def known(value):
        return float(value) if np.isfinite(value) else None

    def at(signal):
        return np.nan if channel_of(signal) in missing else store.at(signal, time, True)

    ratio, angle_signal, share = ratio_of(facts), "SENSORS.slew_angle", 1.0
    if not store.told(angle_signal) and ratio:
        angle_signal, share = "ENCODER.shaft_position.0", 1.0 / ratio
    here = [signal for signal in (angle_signal, "TRUTH.tip_displacement") if channel_of(signal) not in missing]
    time = min([time, *newest_of(store, *here)])
    angle, tip = share * at(angle_signal), at("TRUTH.tip_displacement")
    deflection = tip - tip_radius(facts, store, time) * angle
    gears = [known(at(f"TRUTH.gear_deflection.{g}")) for g in range(GROUPS) if store.has(f"TRUTH.gear_deflection.{g}")]
    torques = [known(at(f"TRUTH.gearbox_torque.{g}")) for g in range(len(gears))]
    rope, rod = (np.nan if is_axis(facts) else at(f"TRUTH.{part}_angle") for part in ("rope", "rod"))
    motion = {name: known(at(f"MOTION.{name}")) for name in ("boom_angle", "rope_length", "travelled") if store.has(f"MOTION.{name}")}
    return {"angle": known(angle), "deflection": known(deflection), "rope": known(rope), "rod": known(rod), "gears": gears, "gear_torques": torques, "motion": motion}


def tip_radius(facts, store, time):
    """[m] in which the tip's displacement counts a turn of the house: of a boom that luffs, that of the moment. NaN where the log does not
    tell it, as of a boom that is bent in the luffing plane and luffs."""
    radius, shape = facts.get("tip_radius", np.nan), facts.get("geometry")
    if not store.has("MOTION.boom_angle"):
        return radius
    # The plant's boom angle goes by stretches of a controller period and is that of the middle of each.
    angles = [store.at("MOTION.boom_angle", time - back, True) for back in (0.5 * facts.get("controller_period", 0.0), 0.0)]
    angle = next((each for each in angles if np.isfinite(each)), np.nan)
    if shape is None:
        return np.nan
    if abs(angle - shape["boom_angle"]) < 1e-9:
        return radius
    is_straight = abs(shape["pivot_radius"] + shape["boom_length"] * np.cos(shape["boom_angle"]) - radius) < 1e-6
    return shape["pivot_radius"] + shape["boom_length"] * np.cos(angle) if is_straight else np.nan


def newest_of(store, *signals):
    """Newest times [s] of the channels of signals: a boom that turns is elsewhere in the last message of a slower one."""
    return [store.channels[store.places[signal][0]].last_time for signal in signals if store.has(signal)]


def state(store, time):
    """The drive, the controller and the operator at a time, in words."""
    def number(signal):
        value = store.at(signal, time)
        return int(value) if np.isfinite(value) else None

    drive, cause = number("PLANT_STATUS.drive_state"), number("PLANT_STATUS.trip_cause")
    tripped = store.at("PLANT_STATUS.trip_time", time)
    next_cause, next_tripped = (store.next_at(f"PLANT_STATUS.{field}", time) for field in ("trip_cause", "trip_time"))
    if not cause and next_cause > 0 and 0 <= next_tripped <= time * 1e9 and next_tripped != tripped:  # it has happened, and is told later
        drive, cause, tripped = TRIPPED, int(next_cause), next_tripped
    request = store.at("OPERATOR.speed_request", time)
    missing = silent(store, time)
    is_silent = "TORQUE" in missing and "ENCODER" not in missing  # it is asked and does not answer
    return {"drive": DRIVE_STATES.get(drive), "trip": TRIP_CAUSES.get(cause, f"cause {cause}") if cause else "",
            "trip_time": tripped * 1e-9 if np.isfinite(tripped) and tripped >= 0 else None,
            "controller": CONTROLLER_MODES.get(number("CONTROLLER_STATE.mode")) if is_silent or "CONTROLLER_STATE" not in missing else None,
            "silent": is_silent,
            "stale": number("PLANT_STATUS.stale_commands"), "missed": number("PLANT_STATUS.missed_deadlines"),
            "request": float(request) if np.isfinite(request) else None,
            "emergency_stop": bool(number("OPERATOR.emergency_stop")), "acknowledge": bool(number("OPERATOR.acknowledge"))}
