"""A controller that is an FMU, as a process on the bus: slewlab run --controller-fmu FILE starts it.

In lockstep: every ENCODER is one communication step from its simulated time on. Inputs are set to what ENCODER and OPERATOR say, the
step is done, and the outputs behind it are the answer. What the wire asks of a controller: docs/wire.md; the variables: docs/fmu.md.
"""

import ctypes
import gc
import math
import os
import shutil
import signal
import struct
import sys
import tempfile
import zipfile
from dataclasses import dataclass

from arguments import ArgumentParser
from message_layout import MessageLayout
from run_log import messages_folder
from wire_bus import WireBus

sys.path.insert(0, str(messages_folder()))

MILLISECOND = 1e-3  # [s]
HALF = 0.5
LONGEST_GAP = 1000  # periods that are made up for
WARNING = 1  # fmi2Warning, fmi3Warning: statuses above it are failures
REALS, BOOLEANS = ("Real", "Float64", "Float32"), ("Boolean",)
WHOLES = ("Integer", "Enumeration", "Int8", "UInt8", "Int16", "UInt16", "Int32", "UInt32", "Int64", "UInt64")

# Exponents of the SI units, and how a unit is spelled where the FMU does not define it.
UNITS = {"rad/s": ({"rad": 1, "s": -1}, ("rad/s",)), "rad": ({"rad": 1}, ("rad",)),
         "N.m": ({"kg": 1, "m": 2, "s": -2}, ("N.m", "Nm", "N m", "N*m")), "1": ({}, ("1", "-"))}
STATE_SCALARS, STATE_ARRAYS = ("mode", "ramped_speed", "average_torque", "offset_torque"), ("proportional_torque", "integral_torque")


class NotFit(Exception):
    """The FMU cannot be this run's controller: what it has, and what would be right."""


@dataclass
class Wanted:
    """A variable that the controller must or may have."""

    name: str
    causality: str
    unit: str = ""  # "" of one that is no physical quantity
    needed: bool = True


def wanted(groups):
    """All that a run knows of, by what it stands for: (message's field, group from 0 or None)."""
    found = {("speed_request", None): Wanted("speed_request", "input", "1"),
             ("emergency_stop", None): Wanted("emergency_stop", "input", needed=False),
             ("operator_acknowledge", None): Wanted("operator_acknowledge", "input", needed=False)}
    for group in range(groups):
        found["shaft_speed", group] = Wanted(f"shaft_speed[{group + 1}]", "input", "rad/s")
        found["shaft_position", group] = Wanted(f"shaft_position[{group + 1}]", "input", "rad", needed=False)
        found["motor_torque", group] = Wanted(f"motor_torque[{group + 1}]", "output", "N.m")
        for name in STATE_ARRAYS:
            found[name, group] = Wanted(f"{name}[{group + 1}]", "output", "N.m", needed=False)
    for name in ("enable", "brake", "acknowledge", "mode"):
        found[name, None] = Wanted(name, "output", needed=False)
    found["ramped_speed", None] = Wanted("ramped_speed", "output", "rad/s", needed=False)
    for name in ("average_torque", "offset_torque"):
        found[name, None] = Wanted(name, "output", "N.m", needed=False)
    return found


def unit_problem(model, variable, unit):
    """Why the variable's unit is not the one of the wire; empty where it is. None where it has none."""
    name = variable.unit or (variable.declaredType.unit if variable.declaredType else None)
    if not name:
        return None if unit != "1" else ""
    exponents, spellings = UNITS[unit]
    base = next((known.baseUnit for known in model.unitDefinitions if known.name == name), None)
    if base is None:
        return "" if name in spellings else f"its unit is {name}"
    for key in ("kg", "m", "s", "A", "K", "mol", "cd", "rad"):
        has, wants = getattr(base, key), exponents.get(key, 0)
        if has != wants and not (key == "rad" and has == 0):  # many tools take rad for 1
            return f"its unit is {name}"
    if base.factor != 1.0 or base.offset != 0.0:
        return f"its unit is {name}, which is {base.factor:g} {unit}" + (f" and an offset of {base.offset:g}" if base.offset else "")
    return ""


def variables_of(model, groups):
    """{what it stands for: variable}, and remarks. Throws NotFit with every reason."""
    by_name = {variable.name: variable for variable in model.modelVariables}
    found, problems, remarks = {}, [], []
    for meaning, want in wanted(groups).items():
        variable = by_name.get(want.name)
        if variable is None and groups == 1:
            variable = by_name.get(want.name.removesuffix("[1]"))
        if variable is None:
            if want.needed:
                near = [name for name, other in by_name.items() if other.causality == want.causality]
                problems.append(f"it has no {want.causality} {want.name}" + (f" [{want.unit}]" if want.unit not in ("", "1") else "") +
                                f"; its {want.causality}s are {', '.join(near) or 'none'}")
            continue
        if variable.causality != want.causality:
            if want.needed:
                problems.append(f"{variable.name} is of causality {variable.causality}, expected {want.causality}")
            continue
        if variable.type not in REALS + BOOLEANS + WHOLES:
            problems.append(f"{variable.name} is of type {variable.type}, expected a number or a Boolean")
            continue
        if want.unit and variable.type in REALS:
            problem = unit_problem(model, variable, want.unit)
            if problem:
                problems.append(f"{variable.name}: {problem}, expected {want.unit}")
            elif problem is None:
                remarks.append(f"{variable.name} has no unit and is taken to be in {want.unit}")
        found[meaning] = variable
    beyond = f"motor_torque[{groups + 1}]"
    if beyond in by_name:
        problems.append(f"it has an output {beyond}; the machine has {groups} motor group{'s' if groups > 1 else ''}")
    if problems:
        raise NotFit("; ".join(problems))
    for name in ("emergency_stop", "enable"):
        if (name, None) not in found:
            said = "is never told of an emergency stop" if name == "emergency_stop" else "is taken to enable the drives all the time"
            remarks.append(f"it has no {name}, and {said}")
    return found, remarks


def check_step(model, period):
    """Throws NotFit where the FMU cannot be asked every `period` [s]."""
    co_simulation, experiment = model.coSimulation, model.defaultExperiment
    if co_simulation is None:
        raise NotFit("it is not for co-simulation")
    own = experiment.stepSize if experiment is not None else None
    own = float(own) if own else None
    said = f"the run asks every {period / MILLISECOND:g} ms (controller_period of the scenario)"
    if not co_simulation.canHandleVariableCommunicationStepSize and own and not math.isclose(own, period, rel_tol=1e-9):
        raise NotFit(f"its communication step is {own / MILLISECOND:g} ms, and it takes no other; {said}: "
                     f'--set controller_period="{own / MILLISECOND:g} ms", or export it with that step')
    inner = co_simulation.fixedInternalStepSize
    inner = float(inner) if inner else None
    if inner and not math.isclose(period / inner, round(period / inner), rel_tol=1e-9):
        raise NotFit(f"its own step is {inner / MILLISECOND:g} ms, and a communication step a whole multiple of it; {said}")


def check_library(path, model):
    """Throws NotFit where the FMU has no library for this machine: its folder's name is by its version of FMI."""
    import fmpy

    folder = fmpy.platform if model.fmiVersion.startswith("2.") else fmpy.platform_tuple
    wanted = f"binaries/{folder}/{model.coSimulation.modelIdentifier}{fmpy.sharedLibraryExtension}"
    with zipfile.ZipFile(path) as archive:
        names = archive.namelist()
    if wanted not in names:
        others = sorted({name.split("/")[1] for name in names if name.startswith("binaries/") and name.count("/") > 1})
        raise NotFit(f"it has no library for this machine, {wanted}; it has libraries for {', '.join(others) or 'none'}")


class Values:
    """Variables of one type that are set or got together, without a new array each time."""

    TYPES = {"Real": ctypes.c_double, "Float64": ctypes.c_double, "Float32": ctypes.c_float, "Integer": ctypes.c_int,
             "Enumeration": ctypes.c_int, "Int8": ctypes.c_int8, "UInt8": ctypes.c_uint8, "Int16": ctypes.c_int16,
             "UInt16": ctypes.c_uint16, "Int32": ctypes.c_int32, "UInt32": ctypes.c_uint32, "Int64": ctypes.c_int64,
             "UInt64": ctypes.c_uint64}

    def __init__(self, fmu, is_2, verb, kind, variables):
        boolean = ctypes.c_int if is_2 else ctypes.c_bool
        number = ctypes.c_int64 if kind == "Enumeration" and not is_2 else self.TYPES.get(kind, boolean)
        self.meanings = list(variables)
        references = (ctypes.c_uint * len(variables))(*[variable.valueReference for variable in variables.values()])
        self.values = (number * len(variables))()
        name = {"Enumeration": "Integer"}.get(kind, kind) if is_2 else {"Enumeration": "Int64"}.get(kind, kind)
        self.name = f"fmi{2 if is_2 else 3}{verb}{name}"
        counts = (len(variables),) if is_2 else (len(variables), len(variables))
        self.call = function_of(fmu, self.name)
        self.arguments = (fmu.component, references, counts[0], self.values, *counts[1:])

    def move(self):
        if self.call(*self.arguments) > WARNING:
            raise RuntimeError(f"{self.name} failed")


def function_of(fmu, name):
    """A function of the FMU as FMPy loaded it, without what FMPy does around each call."""
    return getattr(fmu.dll, name)


class FmuController:
    """The FMU, begun. step() takes the values of all that a run knows of (`known`, in that order) and answers with those of `said`."""

    def __init__(self, path, model, found, period, known, unpack_in=None):
        self.is_2, self.period, self.steps = model.fmiVersion == "2.0", period, 0
        self.folder = os.path.abspath(tempfile.mkdtemp(dir=unpack_in))  # an FMU is told where it lies by a URI
        try:
            self._begin(path, model, found, known)
        except BaseException:  # a signal, too
            self.close()
            raise

    def _begin(self, path, model, found, known):
        import fmpy
        import fmpy.fmi2
        import fmpy.fmi3

        fmpy.extract(path, unzipdir=self.folder, include=lambda name: not name.startswith(("sources/", "documentation/")))
        made = (fmpy.fmi2.FMU2Slave if self.is_2 else fmpy.fmi3.FMU3Slave)(
            guid=model.guid, unzipDirectory=self.folder, modelIdentifier=model.coSimulation.modelIdentifier, instanceName="controller")
        self.fmu = made
        made.instantiate()
        if self.is_2:
            made.setupExperiment(startTime=0.0)
        made.enterInitializationMode()
        made.exitInitializationMode()
        self.inputs, self.outputs, self.said = [], [], []
        for causality, verb in (("input", "Set"), ("output", "Get")):
            chosen = {meaning: variable for meaning, variable in found.items() if variable.causality == causality}
            for kind in sorted({variable.type for variable in chosen.values()}):
                alike = {meaning: variable for meaning, variable in chosen.items() if variable.type == kind}
                part = Values(made, self.is_2, verb, kind, alike)
                if causality == "input":
                    self.inputs.append((part, [known.index(meaning) for meaning in part.meanings]))
                else:
                    self.outputs.append(part)
                    self.said += part.meanings
        self.do_step = function_of(made, f"fmi{2 if self.is_2 else 3}DoStep")
        self.told = [] if self.is_2 else [ctypes.byref(each) for each in (ctypes.c_bool(), ctypes.c_bool(), ctypes.c_bool(), ctypes.c_double())]

    def step(self, given):
        for part, places in self.inputs:
            part.values[:] = [given[place] for place in places]
            part.move()
        if self.do_step(self.fmu.component, self.steps * self.period, self.period, True, *self.told) > WARNING:
            raise RuntimeError(f"its step at {self.steps * self.period:g} s failed")
        self.steps += 1
        said = []
        for part in self.outputs:
            part.move()
            said += part.values[:]
        return said

    def close(self):
        shutil.rmtree(self.folder, ignore_errors=True)


class Answers:
    """The wire: every ENCODER gets one answer, a repeated one the same bytes again; of one run alone, as slewlab run has it."""

    def __init__(self, bus, controller, groups, sends_state):
        from slewlab_msgs import controller_state_t, encoder_t, operator_t, torque_t

        self.bus, self.controller, self.groups, self.sends_state = bus, controller, groups, sends_state
        self.encoder, self.operator = MessageLayout(encoder_t, groups), MessageLayout(operator_t, groups)
        self.torque, self.state = MessageLayout(torque_t, groups), MessageLayout(controller_state_t, groups)
        self.encoder_t = encoder_t
        self.head_of = self.encoder.getter("sequence", "simulated_time", "configuration_hash", "run_identity", "operator_sequence")
        self.measured_of = self.encoder.getter("shaft_speed", "shaft_position")
        self.asked_of = self.operator.getter("speed_request", "emergency_stop", "acknowledge")
        self.place_of_run = self.operator.places["run_identity"][0]
        self.place_of_sequence = self.operator.places["sequence"][0]
        self.run, self.operators = None, {}  # the newest OPERATOR of each run that was heard of
        self.answered, self.answered_time, self.leaps, self.count = -1, 0, 0, 0
        self.first_time, self.given = None, None  # [ns] at which the FMU's time begins; inputs of its newest step
        self.bytes = None
        # What the FMU does not say stands behind what it says: enable, brake, acknowledge.
        said = [*controller.said, ("enable", None), ("brake", None), ("acknowledge", None)]
        switches = [said.index((name, None)) for name in ("enable", "brake", "acknowledge")]
        self.torque_places = [*switches, *(said.index(("motor_torque", group)) for group in range(groups))]
        self.state_places = [said.index((name, None)) for name in STATE_SCALARS] if sends_state else []
        self.array_places = [said.index((name, group)) for name in STATE_ARRAYS for group in range(groups)] if sends_state else []
        for channel, handler in (("OPERATOR", self.on_operator), ("ENCODER", self.on_encoder)):
            bus.subscribe(channel, handler)
        bus.hear_subscribed_only()

    def on_operator(self, data):
        message = self.operator.unpack(data)
        if message is None:
            return
        run = message[self.place_of_run]
        held = self.operators.get(run)
        if held is None or message[self.place_of_sequence] > held[self.place_of_sequence]:
            self.operators = {self.run: self.operators.get(self.run)} if len(self.operators) > 8 else self.operators
            self.operators[run] = message

    def comes_in_its_time(self, sequence, time):
        """A sequence that leaps while the time does not may be a bit that turned over; the second in a row counts."""
        cycles = sequence - self.answered
        elapsed = (time - self.answered_time) * 1e-9
        period = self.controller.period
        fits = self.answered < 0 or cycles == 1 or abs(elapsed - cycles * period) <= HALF * period
        self.leaps = 0 if fits else self.leaps + 1
        return fits or self.leaps >= 2

    def on_encoder(self, data):
        encoder = self.encoder.unpack(data)
        head, measured = (self.head_of(encoder), self.measured_of(encoder)) if encoder else (self.head_of_other(data), None)
        if head is None:
            return
        sequence, time, _, run, operator_sequence = head
        if self.run is None:
            self.run = run
        if run != self.run or sequence < self.answered:
            return
        if sequence > self.answered:
            operator = self.operators.get(run)
            if operator is None or operator[self.place_of_sequence] < operator_sequence:
                return  # that OPERATOR was lost; both will be sent again
            if not self.comes_in_its_time(sequence, time):
                return
            self.compute(head, measured, operator)
        if self.sends_state:
            self.bus.publish("CONTROLLER_STATE", self.bytes[0])
        self.bus.publish("TORQUE", self.bytes[1])

    def head_of_other(self, data):
        """Of an ENCODER of another number of groups; None where it is none at all."""
        try:
            message = self.encoder_t.decode(data)
        except (ValueError, struct.error):
            return None
        return message.sequence, message.simulated_time, message.configuration_hash, message.run_identity, message.operator_sequence

    def compute(self, head, measured, operator):
        sequence, time, configuration, run, _ = head
        request, stop, acknowledge = self.asked_of(operator)
        if measured is None:
            said = self.let_go()
        else:
            said = self.said_to(time, (request, stop, acknowledge, *measured))
            said += (True, False, acknowledge and request == 0.0)
        torque = [said[place] for place in self.torque_places]
        torque[:3] = map(bool, torque[:3])
        count = self.count
        state_bytes = None
        if self.sends_state:
            state_bytes = self.state.pack(count, time, configuration, run, sequence, int(said[self.state_places[0]]),
                                          *[said[place] for place in self.state_places[1:]], self.groups,
                                          *[said[place] for place in self.array_places])
        torque_bytes = self.torque.pack(count, time, configuration, run, sequence, count, *torque[:3], self.sends_state, self.groups, *torque[3:])
        self.count += 1
        self.answered, self.answered_time = sequence, time
        self.bytes = (state_bytes, torque_bytes)

    def let_go(self):
        """An ENCODER of another number of motor groups is nothing to control by: no torque, brakes."""
        said = [0] * (len(self.controller.said) + len(self.torque_places) - self.groups)
        said[self.torque_places[1]] = True
        return said

    def said_to(self, time, given):
        """What the FMU's outputs say behind its next step."""
        if self.first_time is None:
            self.first_time = time
        due = round((time - self.first_time) * 1e-9 / self.controller.period)
        for _ in range(min(due - self.controller.steps, LONGEST_GAP)):  # ENCODER that were lost: a cycle with the inputs before
            self.controller.step(self.given or given)
        self.given = given
        return self.controller.step(given)


class Ended(BaseException):
    """SIGTERM: the ordinary end, behind which what was unpacked of the FMU is taken away."""


def end(number, frame):
    raise Ended


def answer(path, model, found, period, groups, unpack_in):
    sends_state = all((name, None) in found for name in STATE_SCALARS) and all(
        (name, group) in found for name in STATE_ARRAYS for group in range(groups))
    controller = None
    try:
        signal.signal(signal.SIGTERM, end)
        known = [(name, None) for name in ("speed_request", "emergency_stop", "operator_acknowledge")]
        known += [(name, group) for name in ("shaft_speed", "shaft_position") for group in range(groups)]
        controller = FmuController(path, model, found, period, known, unpack_in)
        bus = WireBus(os.environ["SLEWLAB_BUS"])
        answers = Answers(bus, controller, groups, sends_state)
        gc.freeze()  # what is there now stays; a step leaves nothing that only a collection finds
        while answers:
            bus.handle()
    except (Ended, KeyboardInterrupt):
        return 0
    except Exception as error:  # noqa: BLE001 - what the FMU refuses comes through FMPy
        print(f"{path}: {'it does not start: ' if controller is None else ''}{error}", file=sys.stderr)
        return 1
    finally:
        if controller is not None:
            controller.close()


def main():
    parser = ArgumentParser(prog="controller_fmu.py", description=__doc__.splitlines()[0])
    parser.add_argument("fmu", metavar="FILE")
    parser.add_argument("--groups", type=int, help="motor groups of the machine (as many as the FMU has)")
    parser.add_argument("--period-ms", type=float, default=float(os.environ.get("SLEWLAB_CONTROLLER_PERIOD_MS", "10")))
    parser.add_argument("--unpack-in", metavar="FOLDER", help="where its copy lies while it runs (a temporary folder); whoever names one takes it "
                        "away where this process is killed")
    parser.add_argument("--check", action="store_true", help="say whether it can be the controller, and end")
    arguments = parser.parse_args()
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())  # FMPy prints there what an FMU logs, the sentence that says why it refused among it
    period = arguments.period_ms * MILLISECOND
    try:
        import fmpy
    except ImportError:
        print(f"{arguments.fmu}: an FMU is run by FMPy, which is not here; tools/setup installs it", file=sys.stderr)
        return 2
    try:
        model = fmpy.read_model_description(arguments.fmu)
    except Exception as error:  # noqa: BLE001 - FMPy's errors are of many kinds
        print(f"{arguments.fmu}: it cannot be read as an FMU: {error}", file=sys.stderr)
        return 2
    groups = arguments.groups or max(1, sum(variable.name.startswith("motor_torque[") for variable in model.modelVariables))
    try:
        check_step(model, period)
        check_library(arguments.fmu, model)
        found, remarks = variables_of(model, groups)
    except NotFit as error:
        print(f"{arguments.fmu}: it cannot be the controller of this run: {error}", file=sys.stderr)
        return 2
    if arguments.check:
        for remark in remarks:
            print(f"{arguments.fmu}: note: {remark}", file=sys.stderr)
        return 0
    if arguments.unpack_in:
        os.makedirs(arguments.unpack_in, exist_ok=True)
    return answer(arguments.fmu, model, found, period, groups, arguments.unpack_in)


if __name__ == "__main__":
    sys.exit(main())
