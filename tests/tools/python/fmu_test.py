"""FMUs by slewlab export-fmu: valid, and the bits of slewlab run, by FMPy and by libcosim."""

import contextlib
import functools
import io
import os
import shutil
import subprocess
import sys
import tempfile
import unittest
import zipfile
from pathlib import Path

import fmpy
import fmpy.fmi2
import fmpy.fmi3
from fmpy.fmi1 import FMICallException
from fmpy.validation import validate_fmu

from run_log import REPOSITORY, messages_folder

sys.path.insert(0, str(messages_folder()))
import slewlab  # noqa: E402

PROGRAM = messages_folder().parent / "bin" / "slewlab"
PERIOD = 0.01  # [s] of the demo's controller
SAMPLES = 5  # of SENSORS' fields and TRUTH's every so many periods: reading all of them is most of the test's time


def export(file, folder, *words):
    out = Path(folder) / f"{Path(file).parent.name}_{Path(file).stem}{''.join(words).replace('-', '_')}.fmu"
    ended = subprocess.run([PROGRAM, "export-fmu", file, "--out", out, *words], capture_output=True, text=True, timeout=60)
    assert ended.returncode == 0, ended.stdout + ended.stderr
    return out


@functools.cache
def demo():
    return slewlab.Scenario(slewlab.config("scenarios/thesis_slew.yaml")).run()


class Instance:
    """An FMU of either version, unpacked and begun; variables by name."""

    def __init__(self, fmu, folder=None):
        self.model = fmpy.read_model_description(fmu)
        self.folder = folder or fmpy.extract(fmu)
        self.owns_folder = folder is None
        self.variables = {variable.name: variable for variable in self.model.modelVariables}
        self.is_2 = self.model.fmiVersion == "2.0"
        made = (fmpy.fmi2.FMU2Slave if self.is_2 else fmpy.fmi3.FMU3Slave)(
            guid=self.model.guid, unzipDirectory=self.folder, modelIdentifier=self.model.coSimulation.modelIdentifier, instanceName="one")
        self.fmu, self.time = made, 0.0
        made.instantiate()
        if self.is_2:
            made.setupExperiment()
        made.enterInitializationMode()

    def start(self):
        self.fmu.exitInitializationMode()
        return self

    def _call(self, verb, name):
        kind = {"Float64": "Real", "Int64": "Integer"}.get(self.variables[name].type, self.variables[name].type)
        if not self.is_2:
            kind = {"Real": "Float64", "Integer": "Int64"}.get(kind, kind)
        return getattr(self.fmu, verb + kind), self.variables[name].valueReference

    def set(self, name, value):
        call, reference = self._call("set", name)
        call([reference], [value])

    def get(self, name):
        call, reference = self._call("get", name)
        return call([reference])[0]

    def step(self, step=PERIOD):
        self.fmu.doStep(self.time, step)
        self.time += step

    def close(self):
        self.fmu.terminate()
        self.fmu.freeInstance()
        if self.owns_folder:
            shutil.rmtree(self.folder, ignore_errors=True)


def answers(controller, run, periods=None):
    """Feeds a controller of two groups with what a run's controller heard, period by period: yields each period, when it has answered."""
    encoder, moves = run.messages("ENCODER"), run.messages("OPERATOR")
    by_sequence = {move["sequence"]: move for move in moves}
    for k in range(len(run.messages("TORQUE")) if periods is None else periods):
        move = by_sequence[encoder["operator_sequence"][k]]
        controller.set("speed_request", float(move["speed_request"]))
        controller.set("emergency_stop", bool(move["emergency_stop"]))
        controller.set("operator_acknowledge", bool(move["acknowledge"]))
        for group in range(2):
            controller.set(f"shaft_speed[{group + 1}]", float(encoder["shaft_speed"][k][group]))
            controller.set(f"shaft_position[{group + 1}]", float(encoder["shaft_position"][k][group]))
        controller.step()
        yield k


def command(plant, torque):
    plant.set("enable", bool(torque["enable"]))
    plant.set("brake", bool(torque["brake"]))
    plant.set("acknowledge", bool(torque["acknowledge"]))
    for group, value in enumerate(torque["motor_torque"]):
        plant.set(f"motor_torque[{group + 1}]", float(value))


class FmuTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.TemporaryDirectory()
        cls.crane = slewlab.config("cranes/thesis.yaml")
        cls.controller = slewlab.config("controllers/thesis.yaml")
        cls.fmus = {(kind, version): export(file, cls.scratch.name, "--fmi", version)
                    for kind, file in (("plant", cls.crane), ("controller", cls.controller)) for version in ("2", "3")}

    @classmethod
    def tearDownClass(cls):
        cls.scratch.cleanup()

    def test_fmpy_finds_nothing_wrong_with_any_machine_or_controller(self):
        for fmu in self.fmus.values():
            self.assertEqual(validate_fmu(str(fmu)), [], fmu)
        for name in ("cranes/one_group", "cranes/rigid_boom", "cranes/no_load", "axes/example_axis"):
            for version in ("2", "3"):
                with self.subTest(name=name, version=version):
                    fmu = export(slewlab.config(f"{name}.yaml"), self.scratch.name, "--fmi", version)
                    self.assertEqual(validate_fmu(str(fmu)), [])

    def test_every_variable_says_what_it_is_and_in_which_unit(self):
        for fmu in self.fmus.values():
            model = fmpy.read_model_description(str(fmu))
            for variable in model.modelVariables:
                self.assertTrue(variable.description, variable.name)
                self.assertIn(variable.causality, ("parameter", "input", "output", "independent"))
                if variable.type in ("Real", "Float64"):
                    self.assertTrue(variable.unit, variable.name)

    def test_the_sources_are_all_that_their_includes_name(self):
        for (kind, _), fmu in self.fmus.items():
            with zipfile.ZipFile(fmu) as archive:
                names = {name.removeprefix("sources/") for name in archive.namelist() if name.startswith("sources/")}
                self.assertIn("CMakeLists.txt", names)
                self.assertIn("tools/fmu/fmi2.c", names)
                self.assertIn({"plant": "sim/integrate/plant.cpp", "controller": "controller/ramp.cpp"}[kind], names)
                self.assertNotIn({"plant": "controller/ramp.cpp", "controller": "sim/integrate/plant.cpp"}[kind], names)
                for name in names:
                    for line in archive.read(f"sources/{name}").decode().splitlines():
                        if line.startswith('#include "'):
                            included = line.split('"')[1]
                            beside = str(Path(name).parent / included)
                            self.assertTrue(included in names or beside in names, f"{name}: {line}")

    def test_two_exports_are_the_same_bytes(self):
        again = export(self.crane, self.scratch.name, "--fmi", "2", "--seed", "0")
        self.assertEqual(again.read_bytes(), self.fmus["plant", "2"].read_bytes())

    def test_the_seeds_are_those_that_the_page_says(self):
        page = (REPOSITORY / "docs" / "fmu.md").read_text(encoding="utf-8")
        self.assertIn("an FMU has 0 unless `--seed` says another, the scenarios of slewlab have 1", page)
        plant = Instance(str(self.fmus["plant", "3"])).start()
        self.assertEqual(plant.get("seed"), 0)
        plant.close()
        self.assertEqual({slewlab.Scenario(path).seed for path in slewlab.config("scenarios").glob("*.yaml")}, {1})

    def test_the_plant_gives_the_bits_of_the_demo(self):
        run = demo()
        encoder, torque, truth = (run.messages(channel) for channel in ("ENCODER", "TORQUE", "TRUTH"))
        sensors = {message["simulated_time"]: message for message in run.messages("SENSORS")}
        for version in ("2", "3"):
            with self.subTest(version=version):
                plant = Instance(str(self.fmus["plant", version])).start()
                for k, said in enumerate(torque):
                    for group in range(2):
                        self.assertEqual(plant.get(f"shaft_speed[{group + 1}]"), encoder["shaft_speed"][k][group], k)
                        self.assertEqual(plant.get(f"shaft_position[{group + 1}]"), encoder["shaft_position"][k][group], k)
                    if k % SAMPLES == 0:
                        measured = sensors[encoder["simulated_time"][k]]
                        for field in ("house_acceleration", "tip_acceleration", "slew_angle"):
                            self.assertEqual(plant.get(field), measured[field], (k, field))
                        for field in ("tip_velocity", "rope_angle", "mechanical_energy"):
                            self.assertEqual(plant.get(field), truth[field][k], (k, field))
                        self.assertEqual(plant.get("shear_force[6]"), truth["shear_force"][k][5], k)
                        self.assertEqual(plant.get("play_crossings[1]"), truth["play_crossings"][k][0], k)
                    command(plant, said)
                    plant.step()
                plant.close()
        self.assertEqual(len(torque), 6000)

    def test_a_machine_with_effects_that_draw_numbers_gives_its_bits(self):
        crane = Path(self.scratch.name) / "gusty.yaml"
        crane.write_text(f"""include: {self.crane}
effects:
  - effect: gusts
    deviation: {{value: 4, unit: m/s, source: "test"}}
    mean_speed: {{value: 12, unit: m/s, source: "test"}}
    direction: {{value: 90, unit: deg, source: "test"}}
    correlation_time: {{value: 5, unit: s, source: "test"}}
    boom_drag_area: {{value: 80, unit: m^2, source: "test"}}
    load_drag_area: {{value: 20, unit: m^2, source: "test"}}
  - effect: command_jitter
    spread: {{value: 40, unit: ms, source: "test"}}
""")
        run = slewlab.Scenario(slewlab.config("scenarios/thesis_slew.yaml"), {"crane": str(crane), "seed": 7, "duration": 12}).run()
        encoder, torque = run.messages("ENCODER"), run.messages("TORQUE")
        plant = Instance(str(export(crane, self.scratch.name, "--fmi", "3", "--seed", "7"))).start()
        for k, said in enumerate(torque):
            self.assertEqual(plant.get("shaft_speed[2]"), encoder["shaft_speed"][k][1], k)
            command(plant, said)
            plant.step()
        plant.close()

    def test_the_controller_gives_the_bits_of_the_demo(self):
        run = demo()
        torque, state = run.messages("TORQUE"), run.messages("CONTROLLER_STATE")
        for version in ("2", "3"):
            with self.subTest(version=version):
                controller = Instance(str(self.fmus["controller", version])).start()
                answered = 0
                for k in answers(controller, run):
                    answered += 1
                    for group in range(2):
                        self.assertEqual(controller.get(f"motor_torque[{group + 1}]"), torque["motor_torque"][k][group], k)
                    if k % SAMPLES == 0:
                        self.assertEqual(controller.get("ramped_speed"), state["ramped_speed"][k], k)
                        self.assertEqual(controller.get("mode"), state["mode"][k], k)
                        self.assertEqual(controller.get("integral_torque[2]"), state["integral_torque"][k][1], k)
                controller.close()
                self.assertEqual(answered, len(torque))

    def test_libcosim_gives_the_bits_of_the_demo(self):
        from libcosimpy.CosimExecution import CosimExecution
        from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
        from libcosimpy.CosimManipulator import CosimManipulator
        from libcosimpy.CosimObserver import CosimObserver
        from libcosimpy.CosimSlave import CosimLocalSlave

        run = demo()
        encoder, torque = run.messages("ENCODER"), run.messages("TORQUE")
        model = fmpy.read_model_description(str(self.fmus["plant", "2"]))
        reference = {variable.name: variable.valueReference for variable in model.modelVariables}
        log_output_level(CosimLogLevel.WARNING)
        execution = CosimExecution.from_step_size(step_size=int(PERIOD * 1e9))  # [ns]
        slave = execution.add_local_slave(CosimLocalSlave(fmu_path=str(self.fmus["plant", "2"]), instance_name="plant"))
        hand, watch = CosimManipulator.create_override(), CosimObserver.create_last_value()
        execution.add_manipulator(hand)
        execution.add_observer(watch)
        said = [reference[f"motor_torque[{group}]"] for group in (1, 2)]
        asked = [reference[f"shaft_{what}[{group}]"] for what in ("speed", "position") for group in (1, 2)]
        switches = [reference[name] for name in ("enable", "brake", "acknowledge")]
        for k in range(len(torque) - 1):
            self.assertTrue(hand.slave_real_values(slave, said, [float(value) for value in torque["motor_torque"][k]]))
            self.assertTrue(hand.slave_boolean_values(slave, switches, [bool(torque[name][k]) for name in ("enable", "brake", "acknowledge")]))
            self.assertTrue(execution.step())
            expected = [*encoder["shaft_speed"][k + 1], *encoder["shaft_position"][k + 1]]
            self.assertEqual(watch.last_real_values(slave, asked), expected, k)

    def test_a_kept_state_goes_on_as_the_first_time_and_two_instances_do_not_mix(self):
        torque = demo().messages("TORQUE")[500:900]
        for version in ("2", "3"):
            with self.subTest(version=version):
                one = Instance(str(self.fmus["plant", version])).start()
                other = Instance(str(self.fmus["plant", version]), one.folder).start()
                kept, first = None, []
                for k, said in enumerate(torque):
                    if k == 200:
                        kept, kept_time = one.fmu.getFMUState(), one.time
                    command(one, said)
                    one.step()
                    other.step()
                    if k >= 200:
                        first.append(one.get("tip_velocity"))
                one.fmu.setFMUState(kept)
                one.time = kept_time
                for k, said in enumerate(torque[200:]):
                    command(one, said)
                    one.step()
                    self.assertEqual(one.get("tip_velocity"), first[k], k)
                self.assertNotEqual(first[-1], 0.0)
                self.assertEqual(other.get("shaft_speed[1]"), 0.0)
                one.fmu.freeFMUState(kept)
                one.fmu.reset()
                other.close()
                one.close()

    def test_what_it_cannot_do_is_refused_in_words(self):
        for kind, version, step, words in (("plant", "2", 0.0105, "multiple of plant_step"), ("plant", "3", 0.0, "above 0"),
                                           ("controller", "2", 0.02, "parameter period"), ("controller", "3", 0.005, "parameter period")):
            with self.subTest(kind=kind, version=version):
                unit = Instance(str(self.fmus[kind, version])).start()
                with contextlib.redirect_stdout(io.StringIO()) as said, self.assertRaises(FMICallException):
                    unit.step(step)
                self.assertIn(words, said.getvalue())
                with contextlib.redirect_stdout(io.StringIO()) as said, self.assertRaises(FMICallException):
                    unit.set("motor_torque[1]" if kind == "controller" else "shaft_speed[1]", 1.0)
                self.assertIn("is an output", said.getvalue())
                unit.close()
        # Another configuration under the description of this one.
        folder = fmpy.extract(str(self.fmus["plant", "2"]))
        self.addCleanup(shutil.rmtree, folder, True)
        unit = Path(folder) / "resources" / "unit.json"
        unit.write_text(unit.read_text().replace('"seed": 0', '"seed": 1'))
        with contextlib.redirect_stdout(io.StringIO()) as said, self.assertRaises(Exception):  # noqa: B017 - FMPy's own, of no kind
            Instance(str(self.fmus["plant", "2"]), folder)
        self.assertIn("export the FMU again", said.getvalue())

    def test_a_wrong_file_is_named(self):
        ended = subprocess.run([PROGRAM, "export-fmu", slewlab.config("scenarios/thesis_slew.yaml"), "--out", os.devnull],
                               capture_output=True, text=True, timeout=60)
        self.assertEqual(ended.returncode, 2)
        self.assertIn("crane or axis (the plant), or controller", ended.stderr)

    def test_a_folder_in_the_files_place_is_a_wrong_call(self):
        with tempfile.TemporaryDirectory() as folder:
            ended = subprocess.run([PROGRAM, "export-fmu", slewlab.config("controllers/thesis.yaml"), "--out", folder], capture_output=True, text=True, timeout=60)
            self.assertEqual(ended.returncode, 2)
            self.assertEqual(ended.stderr, f"--out: found '{folder}', a folder, expected the name of the FMU to write, such as {folder}/thesis.fmu\n")
            self.assertEqual(list(Path(folder).iterdir()), [])

    def test_motions_that_have_no_inputs_are_told(self):
        with tempfile.TemporaryDirectory() as folder:
            fmu = Path(folder) / "moving.fmu"
            ended = subprocess.run([PROGRAM, "export-fmu", slewlab.config("cranes/thesis_moving.yaml"), "--out", fmu], capture_output=True, text=True,
                                   timeout=60)
            self.assertEqual(ended.returncode, 0, ended.stderr)
            self.assertIn("note: The FMU has no inputs for hoisting, luffing, travelling", ended.stdout)
            self.assertIn("no inputs for hoisting, luffing, travelling", fmpy.read_model_description(fmu).description)

    def test_options_of_a_plant_are_refused_beside_a_controller(self):
        for option in ("--seed", "--plant-step"):
            ended = subprocess.run([PROGRAM, "export-fmu", slewlab.config("controllers/thesis.yaml"), option, "1", "--out", os.devnull],
                                   capture_output=True, text=True, timeout=60)
            self.assertEqual(ended.returncode, 2)
            self.assertIn(f"{option}: found it beside a controller, expected it beside a machine", ended.stderr)


if __name__ == "__main__":
    unittest.main()
