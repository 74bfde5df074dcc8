"""slewlab run with a controller that is an FMU, and with a plant of one's own."""

import os
import subprocess
import sys
import tempfile
import unittest
import zipfile
from pathlib import Path

from run_log import REPOSITORY, messages_folder

sys.path.insert(0, str(messages_folder()))
import slewlab  # noqa: E402

PROGRAM = messages_folder().parent / "bin" / "slewlab"
SLEW = slewlab.config("scenarios/thesis_slew.yaml")
OWN_PLANT = f"PYTHONPATH={messages_folder()} {sys.executable} {REPOSITORY / 'examples' / 'plant_in_python' / 'plant.py'}"


def call(*words, stdin="", **environment):
    return subprocess.run([str(word) for word in words], input=stdin, capture_output=True, text=True, timeout=300, env=os.environ | environment)


def run(folder, *words, scenario=SLEW, **environment):
    return call(REPOSITORY / "tools" / "in-private-network", PROGRAM, "run", scenario, "--out", folder, "--progress", "none", *words, **environment)


def changed(fmu, to, *replacements):
    """A copy of the FMU whose model description reads otherwise."""
    with zipfile.ZipFile(fmu) as source, zipfile.ZipFile(to, "w") as target:
        for name in source.namelist():
            content = source.read(name)
            if name == "modelDescription.xml":
                for old, new in replacements:
                    assert old in content.decode(), old
                    content = content.decode().replace(old, new).encode()
            target.writestr(name, content)
    return to


class FmuControllerTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.TemporaryDirectory()
        cls.folder = Path(cls.scratch.name)
        cls.fmus = {}
        for version in ("2", "3"):
            cls.fmus[version] = cls.folder / f"controller_{version}.fmu"
            ended = call(PROGRAM, "export-fmu", slewlab.config("controllers/thesis.yaml"), "--fmi", version, "--out", cls.fmus[version])
            assert ended.returncode == 0, ended.stderr

    @classmethod
    def tearDownClass(cls):
        cls.scratch.cleanup()

    def test_the_demo_under_it_is_the_demo_to_the_byte(self):
        expected = self.folder / "expected.lcmlog"
        slewlab.Scenario(SLEW).run(log=expected)
        for version, fmu in self.fmus.items():
            with self.subTest(version=version):
                ended = run(self.folder / f"run_{version}", "--controller-fmu", fmu)
                self.assertEqual(ended.returncode, 0, ended.stdout + ended.stderr)
                self.assertEqual((self.folder / f"run_{version}" / "run.lcmlog").read_bytes(), expected.read_bytes())
                replayed = call(REPOSITORY / "tools" / "in-private-network", PROGRAM, "replay", self.folder / f"run_{version}",
                                "--controller-fmu", fmu)
                self.assertEqual(replayed.returncode, 0, replayed.stdout + replayed.stderr)
                self.assertRegex(replayed.stdout, "TORQUE +6000 compared, all identical")

    def test_readings_with_flipped_bits_and_lost_ones_do_not_stop_it_and_it_leaves_nothing_behind(self):
        unpacked = self.folder / "unpacked"
        unpacked.mkdir()
        ended = run(self.folder / "bits", "--controller-fmu", self.fmus["2"], scenario=slewlab.config("scenarios/faults/encoder_bits.yaml"),
                    TMPDIR=str(unpacked))
        self.assertEqual(ended.returncode, 0, ended.stdout + ended.stderr)
        self.assertIn("everything under expect: of the scenario came about", ended.stdout)
        self.assertEqual((self.folder / "bits" / "controller.txt").read_text(), "")
        self.assertEqual(list(unpacked.iterdir()), [])
        self.assertEqual(list((self.folder / "bits").glob("*.partial")), [])

    def spoilt(self, name, code):
        """The FMU with another library: one that has its functions as `code` says."""
        fmu, library = self.fmus["2"], self.folder / f"{name}.so"
        call("cc", "-shared", "-fPIC", "-o", library, "-x", "c", "-", stdin=code)
        with zipfile.ZipFile(fmu) as source, zipfile.ZipFile(self.folder / f"{name}.fmu", "w") as target:
            for each in source.namelist():
                target.writestr(each, library.read_bytes() if each.endswith(".so") else source.read(each))
        return self.folder / f"{name}.fmu"

    def test_one_that_does_not_start_leaves_nothing_behind(self):
        dies = "#include <stdlib.h>\n__attribute__((constructor)) static void dies(void) { abort(); }"
        for name, code, said in (("no_function", "int nothing;", "it does not start"), ("dies", dies, "killed by signal 6")):
            with self.subTest(name=name):
                unpacked, out = self.folder / f"temporary_{name}", self.folder / f"run_{name}"
                unpacked.mkdir()
                ended = run(out, "--controller-fmu", self.spoilt(name, code), TMPDIR=str(unpacked))
                self.assertEqual(ended.returncode, 1, ended.stdout + ended.stderr)
                self.assertIn(said, ended.stderr)
                self.assertEqual(list(unpacked.iterdir()), [])
                self.assertFalse((out / "controller_fmu.partial").exists())

    def test_one_without_a_run_around_it_takes_its_copy_away(self):
        unpacked = self.folder / "alone"
        unpacked.mkdir()
        ended = call(sys.executable, REPOSITORY / "tools" / "python" / "controller_fmu.py", self.spoilt("alone", "int nothing;"), TMPDIR=str(unpacked))
        self.assertEqual(ended.returncode, 1)
        self.assertIn("it does not start", ended.stderr)
        self.assertEqual(list(unpacked.iterdir()), [])

    def test_one_for_another_system_is_refused_before_anything_runs(self):
        for version, ours, theirs in (("2", "linux64", "win64"), ("3", "x86_64-linux", "x86_64-windows")):
            with self.subTest(version=version):
                fmu = self.folder / f"other_system_{version}.fmu"
                with zipfile.ZipFile(self.fmus[version]) as source, zipfile.ZipFile(fmu, "w") as target:
                    for each in source.namelist():
                        target.writestr(each.replace(f"binaries/{ours}/", f"binaries/{theirs}/").replace(".so", ".dll"), source.read(each))
                ended = run(self.folder / "never", "--controller-fmu", fmu)
                self.assertEqual(ended.returncode, 2, ended.stdout + ended.stderr)
                self.assertIn(f"it has no library for this machine, binaries/{ours}/", ended.stderr)
                self.assertIn(f"it has libraries for {theirs}", ended.stderr)
                self.assertFalse((self.folder / "never").exists())

    def refusal(self, fmu, *, groups="2", period="10"):
        ended = call(sys.executable, REPOSITORY / "tools" / "python" / "controller_fmu.py", fmu, "--groups", groups, "--period-ms", period, "--check")
        self.assertEqual(ended.returncode, 2, ended.stdout + ended.stderr)
        return ended.stderr

    def test_what_does_not_fit_is_refused_before_anything_runs(self):
        ended = run(self.folder / "never", "--controller-fmu", self.fmus["2"], "--set", "controller_period=5 ms")
        self.assertEqual(ended.returncode, 2, ended.stdout)
        self.assertIn("its communication step is 10 ms", ended.stderr)
        self.assertIn('--set controller_period="10 ms"', ended.stderr)
        self.assertFalse((self.folder / "never").exists())

    def test_what_an_fmu_says_of_its_refusal_is_told(self):
        # Ours refuses a communication step that is not its own; without a step in its description nobody knows before.
        for version in ("2", "3"):
            with self.subTest(version=version), zipfile.ZipFile(self.fmus[version]) as archive:
                description = archive.read("modelDescription.xml").decode()
                experiment = description[description.index("<DefaultExperiment"):]
                experiment = experiment[:experiment.index("/>") + 2]
                silent = changed(self.fmus[version], self.folder / f"silent_{version}.fmu", (experiment, ""))
                ended = run(self.folder / f"refused_{version}", "--controller-fmu", silent, "--set", "controller_period=20 ms")
                self.assertEqual(ended.returncode, 1, ended.stdout)
                self.assertIn("a communication step of 0.020000 s; this controller is asked every 0.010000 s", ended.stderr)
                self.assertIn("its step at 0 s failed", ended.stderr)

    def test_step_unit_and_variables_are_judged_in_words(self):
        self.assertIn("the run asks every 20 ms", self.refusal(self.fmus["3"], period="20"))
        self.assertIn("the machine has 1 motor group", self.refusal(self.fmus["2"], groups="1"))
        self.assertIn("it has no input shaft_speed[3] [rad/s]; its inputs are speed_request,", self.refusal(self.fmus["3"], groups="3"))
        newton_metre = '<BaseUnit kg="1" m="2" s="-2"/>'
        for version, fmu in self.fmus.items():
            with self.subTest(version=version):
                to = self.folder / f"changed_{version}.fmu"
                scaled = changed(fmu, to, (newton_metre, newton_metre.replace("/>", ' factor="1000"/>')))
                self.assertIn("motor_torque[1]: its unit is N.m, which is 1000 N.m, expected N.m", self.refusal(scaled))
                other = changed(fmu, to, ('unit="rad/s"', 'unit="1"'))
                self.assertIn("shaft_speed[1]: its unit is 1, expected rad/s", self.refusal(other))
                without = changed(fmu, to, ('name="motor_torque[2]"', 'name="torque_of_the_second"'))
                said = self.refusal(without)
                self.assertIn("it has no output motor_torque[2] [N.m]", said)
                self.assertIn("torque_of_the_second", said)

    def test_what_is_no_fmu_is_said(self):
        self.assertIn("it cannot be read as an FMU", self.refusal(SLEW))


class OwnPlantTest(unittest.TestCase):
    def test_the_example_is_logged_replayed_and_accepted(self):
        with tempfile.TemporaryDirectory() as scratch:
            folder = Path(scratch) / "run"
            ended = run(folder, "--plant", OWN_PLANT)
            self.assertEqual(ended.returncode, 0, ended.stdout + ended.stderr)
            log = slewlab.open_log(folder)
            self.assertEqual(log.remarks, [])
            self.assertEqual({channel: len(log.messages(channel)) for channel in ("ENCODER", "TORQUE", "CONTROLLER_STATE")},
                             {"ENCODER": 6000, "TORQUE": 6000, "CONTROLLER_STATE": 6000})
            # At constant speed: top speed of the thesis's controller times the ratio.
            speed = log["ENCODER"].shaft_speed_1
            self.assertAlmostEqual(speed[(speed.index > 20.0) & (speed.index < 29.0)].mean(), 0.05 * 2735.58, delta=0.5)
            self.assertLess(abs(speed.iloc[-1]), 0.1)

            accepted = call(PROGRAM, "accept", folder, "--no-plot")
            self.assertEqual(accepted.returncode, 0, accepted.stdout)
            self.assertRegex(accepted.stdout, r"- +tip acceleration +no accelerometer at the tip")

            replayed = call(PROGRAM, "replay", folder)
            self.assertEqual(replayed.returncode, 0, replayed.stdout)
            self.assertIn("plant: not replayed, it was one of your own", replayed.stdout)
            self.assertIn("identical to the bit", replayed.stdout)

            again = Path(scratch) / "again"
            self.assertEqual(run(again, "--plant", OWN_PLANT).returncode, 0)
            self.assertEqual((again / "run.lcmlog").read_bytes(), (folder / "run.lcmlog").read_bytes())

    def test_a_log_that_is_not_this_run_fails_it(self):
        with tempfile.TemporaryDirectory() as scratch:
            for command, words in (("true", "was not written"), ("exit 3", "exit code 3"),
                                   ("cp /dev/null $(sed -n 's/.*\"log\": \"\\(.*\\)\".*/\\1/p' $SLEWLAB_PLANT_TASK)", "not that of this run")):
                with self.subTest(command=command):
                    folder = Path(scratch) / "run"
                    ended = run(folder, "--plant", command)
                    self.assertEqual(ended.returncode, 1, ended.stdout + ended.stderr)
                    self.assertIn(words, ended.stderr)
                    self.assertFalse((folder / "run.lcmlog").exists())

    def test_a_scenario_that_needs_our_plant_is_refused(self):
        with tempfile.TemporaryDirectory() as scratch:
            folder = Path(scratch) / "run"
            for words, scenario, said in ((("--realtime",), SLEW, "--realtime"),
                                          ((), slewlab.config("scenarios/faults/torque_lost.yaml"), "faults on purpose"),
                                          ((), slewlab.config("scenarios/moves_while_slewing.yaml"), "it hoists, luffs or travels (hoisting_request,")):
                ended = run(folder, "--plant", "true", *words, scenario=scenario)
                self.assertEqual(ended.returncode, 2, ended.stdout)
                self.assertIn(said, ended.stderr)
                self.assertFalse(folder.exists())


if __name__ == "__main__":
    unittest.main()
