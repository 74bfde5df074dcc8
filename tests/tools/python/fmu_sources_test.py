"""The sources in an FMU are all of it: built by its build description with plain calls of the compiler, the controller gives the bits of the
library that is shipped beside them."""

import shlex
import shutil
import subprocess
import tempfile
import unittest
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import fmpy

from fmu_test import Instance, answers, demo, export, slewlab

COMPILERS = {"C11": ("cc", "-std=c11"), "C++20": ("c++", "-std=c++20")}
# Headers alone, as the description says; where Debian has those that are not among the system's own.
PLACES = {"Eigen3": "/usr/include/eigen3"}
PERIODS = 1500  # of the demo: rest, ramp, full speed


def built(sources, out):
    """The library, by sources/buildDescription.xml of FMI 3. Without optimisation, which is faster to build and may not change a bit."""
    configuration = ElementTree.parse(sources / "buildDescription.xml").getroot().find("BuildConfiguration")
    includes = [f"-isystem{PLACES[each.get('name')]}" for each in configuration.findall("Library") if each.get("name") in PLACES]
    objects = []
    for part in configuration.findall("SourceFileSet"):
        compiler, standard = COMPILERS[part.get("language")]
        words = [compiler, standard, *shlex.split(part.get("compilerOptions")), "-O0", "-w", "-fPIC", "-fvisibility=hidden", *includes]
        words += [f"-D{each.get('name')}={each.get('value')}" for each in part.findall("PreprocessorDefinition")]
        words += [f"-I{each.get('name')}" for each in part.findall("IncludeDirectory")]
        for file in part.findall("SourceFile"):
            objects.append(str(out.parent / (file.get("name").replace("/", "_") + ".o")))
            call([*words, "-c", file.get("name"), "-o", objects[-1]], sources)
    call(["c++", "-shared", *objects, "-o", str(out)], sources)


def call(words, folder):
    ended = subprocess.run(words, cwd=folder, stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False)
    assert ended.returncode == 0, shlex.join(words) + "\n" + ended.stderr


class FmuSourcesTest(unittest.TestCase):
    def test_the_controller_built_of_them_gives_the_shipped_ones_bits(self):
        run = demo()
        torque = run.messages("TORQUE")
        with tempfile.TemporaryDirectory() as scratch:
            folder = Path(scratch)
            fmu = export(slewlab.config("controllers/thesis.yaml"), folder, "--fmi", "3")
            unpacked = Path(fmpy.extract(str(fmu), unzipdir=str(folder / "unpacked")))
            library = next((unpacked / "binaries").rglob("*.so"))
            shipped = library.read_bytes()
            built(unpacked / "sources", library)
            self.assertNotEqual(library.read_bytes(), shipped)
            shutil.rmtree(unpacked / "sources")
            controller = Instance(str(fmu), str(unpacked)).start()
            for k in answers(controller, run, PERIODS):
                for group in range(2):
                    self.assertEqual(controller.get(f"motor_torque[{group + 1}]"), torque["motor_torque"][k][group], k)
            controller.close()
            self.assertGreater(abs(torque["motor_torque"][:PERIODS]).max(), 10.0)


if __name__ == "__main__":
    unittest.main()
