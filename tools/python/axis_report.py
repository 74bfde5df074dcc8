"""The report of a plain axis (docs/axis.md): its signals in its own units, and of a simulation what it differs by from the
record that drove it. run.json beside a log says what the machine is; a record that came alone is of the axis of the run
it is shown with."""

import numpy as np

from panel import DARK, GREEN, GREY, GROUP_COLOURS, Panel, line
from run_log import seconds

WINDOWS = 10  # parts of the record, each with a difference of its own: an open loop drifts


def machine_of(run):
    return run.facts.get("machine", {})


def is_axis(run):
    return machine_of(run).get("kind") == "axis"


def is_same_scale(first, second):
    """Whether signals of the two can be taken from each other: the same transmission, the same units."""
    keys = ("ratio", "position_unit", "speed_unit", "is_rigid", "efforts")
    return all(machine_of(first)[key] == machine_of(second)[key] for key in keys)


def share_machine(runs):
    """Gives records without a run.json the axis of the run beside them, where all others are axes; says so."""
    known = [run for run in runs if is_axis(run)]
    for run in runs:
        if known and not run.facts and run.log.has("ENCODER") and run.log.channel("ENCODER")["shaft_speed"].shape[1] == 1:
            shared = known[0].facts
            run.facts = {key: shared[key] for key in ("machine", "total_ratio", "rated_torque") if key in shared}
            run.log.remarks.append(f"no run.json: taken for a record of the axis of {known[0].name}")


def motion(run):
    """Time [s], position and speed of the axis as the motor's encoder has them."""
    encoder = run.log.channel("ENCODER")
    ratio = machine_of(run)["ratio"]
    return seconds(encoder), encoder["shaft_position"][:, 0] / ratio, encoder["shaft_speed"][:, 0] / ratio


def load_position(run):
    """Time and reading of the load-side encoder; None where the log has none."""
    if not run.log.has("SENSORS"):
        return None
    sensors = run.log.channel("SENSORS")
    return (seconds(sensors), sensors["slew_angle"]) if np.isfinite(sensors["slew_angle"]).all() else None


def record_of(run, runs):
    """The run that drove this simulation, where it is shown beside it."""
    wanted = run.facts.get("open_loop", {}).get("record_hash")
    for other in runs:
        hash_of_other = int(other.log.channel("ENCODER")["configuration_hash"][0]) if other.log.has("ENCODER") else None
        if wanted is not None and other is not run and hash_of_other is not None and f"{hash_of_other & (1 << 64) - 1:016x}" == wanted:
            return other
    return None


def difference(run, record):
    """{signal: (time, simulated minus recorded)} where both have an instant."""
    result = {}
    (t, position, speed), (t_record, position_record, speed_record) = motion(run), motion(record)
    _, mine, others = np.intersect1d(t, t_record, return_indices=True)
    result["position"] = (t[mine], position[mine] - position_record[others])
    result["speed"] = (t[mine], speed[mine] - speed_record[others])
    load, load_record = load_position(run), load_position(record)
    if load and load_record:
        _, mine, others = np.intersect1d(load[0], load_record[0], return_indices=True)
        result["load position"] = (load[0][mine], load[1][mine] - load_record[1][others])
    return result


def rms(values):
    return float(np.sqrt(np.mean(values**2))) if len(values) else float("nan")


def windows(values):
    """RMS in each tenth of the record."""
    return [rms(part) for part in np.array_split(values, WINDOWS)]


def torque_unit(run):
    return machine_of(run)["efforts"][0]["unit"]


def unit_of(run, signal):
    return machine_of(run)["speed_unit" if signal == "speed" else "position_unit"]


def table(runs):
    """Rows (label, one text per run)."""
    def row(label, text):
        return (label, [text(run) for run in runs])

    def reach(run):
        _, position, _ = motion(run)
        return f"{position.min():.4g} ... {position.max():.4g} {unit_of(run, 'position')}"

    def push(run):
        if not run.log.has("TORQUE"):
            return "not in the log"
        largest, rated = np.abs(run.log.channel("TORQUE")["motor_torque"]).max(), run.facts.get("rated_torque")
        return f"{largest:.3g} {torque_unit(run)}" + (f" ({100 * largest / rated:.0f} % of rated)" if rated else "")

    rows = [row("position", reach), row("largest speed", lambda run: f"{np.abs(motion(run)[2]).max():.3g} {unit_of(run, 'speed')}"),
            row(machine_of(runs[0])["efforts"][0]["name"] + ", largest", push)]
    if any(run.log.has("TRUTH") for run in runs) and not machine_of(runs[0])["is_rigid"]:
        rows.append(row("crossings of the play", lambda run: str(int(run.log.channel("TRUTH")["play_crossings"][-1, 0]))
                        if run.log.has("TRUTH") else "not in the log"))
    differences = [(run, difference(run, record_of(run, runs)) if record_of(run, runs) else {}) for run in runs]
    for signal in ("position", "speed", "load position"):
        if not any(signal in found for _, found in differences):
            continue
        rows.append((f"{signal} against the record, RMS",
                     [f"{rms(found[signal][1]):.3g} {unit_of(run, signal)}" if signal in found else "-" for run, found in differences]))
        rows.append(("  by tenths of the record",
                     [" / ".join(f"{value:.2g}" for value in windows(found[signal][1])) if signal in found else "-"
                      for _, found in differences]))
    return rows


def gaps_of(*places):
    """Of what is drawn of several (run, channel): where messages of any of them are missing."""
    return sorted(gap for run, channel in places for gap in run.overview.gaps[channel])


def panels(runs):
    """The rows of the picture: position, speed, torque, what the transmission carries, and the differences."""
    def with_record(signal, draw):
        def drawn(run):
            record = record_of(run, runs)
            traces = [line(*draw(record), "record", GREY, width=2.2, gaps=record.overview.gaps["ENCODER"])] if record else []
            name = "simulated" if record else signal
            return traces + [line(*draw(run), name, GROUP_COLOURS[0], gaps=run.overview.gaps["ENCODER"])]
        return drawn

    def position(run):
        traces = with_record("motor encoder", lambda r: motion(r)[:2])(run)
        load = load_position(run)
        return traces + ([line(*load, "load encoder", GREEN, "5px,2px", gaps=run.overview.gaps["SENSORS"])] if load else [])

    def speed(run):
        traces = with_record("motor encoder", lambda r: (motion(r)[0], motion(r)[2]))(run)
        if run.log.has("OPERATOR") and run.facts.get("top_speed"):
            moves = run.log.channel("OPERATOR")
            wish = np.where(moves["emergency_stop"], 0.0, moves["speed_request"]) * run.facts["top_speed"]
            traces.append(line(np.append(seconds(moves), motion(run)[0][-1]), np.append(wish, wish[-1]), "request", GREY, "dot",
                               line_shape="hv"))
        if run.log.has("CONTROLLER_STATE"):
            state = run.log.channel("CONTROLLER_STATE")
            traces.append(line(seconds(state), state["ramped_speed"], "ramp", DARK, "dash", gaps=run.overview.gaps["CONTROLLER_STATE"]))
        return traces

    def torque(run):
        if not run.log.has("TORQUE"):
            return []
        messages = run.log.channel("TORQUE")
        return [line(seconds(messages), messages["motor_torque"][:, 0], "command", GROUP_COLOURS[1], gaps=run.overview.gaps["TORQUE"], line_shape="hv")]

    def carried(run):
        if machine_of(run)["is_rigid"] or not run.log.has("TRUTH"):
            return []
        truth = run.log.channel("TRUTH")
        return [line(seconds(truth), truth["gearbox_torque"][:, 0], "transmission", GROUP_COLOURS[2], gaps=run.overview.gaps["TRUTH"])]

    def twist(run):
        load = load_position(run)
        if not load:
            return []
        time, angle, _ = motion(run)
        apart = np.interp(load[0], time, angle) - load[1]
        return [line(load[0], apart - apart[0], "motor minus load", GROUP_COLOURS[3], gaps=gaps_of((run, "SENSORS"), (run, "ENCODER")))]

    def apart(signal):
        def drawn(run):
            record = record_of(run, runs)
            found = difference(run, record).get(signal) if record else None
            if not found:
                return []
            return [line(*found, "simulated minus recorded", GROUP_COLOURS[4], gaps=gaps_of((run, "ENCODER"), (record, "ENCODER")))]
        return drawn

    first = machine_of(runs[0])
    place, rate = first["position_unit"], first["speed_unit"]
    effort, on_axis = first["efforts"][0], first["efforts"][1]
    rows = [Panel("position", place, position), Panel("speed", rate, speed), Panel(effort["name"], effort["unit"], torque),
            Panel("transmission", on_axis["unit"] + ", on the axis", carried), Panel("motor minus load", place, twist),
            Panel("position difference", place, apart("position")), Panel("speed difference", rate, apart("speed"))]
    return [panel for panel in rows if any(panel.draw(run) for run in runs)]
