"""The sources in an FMU are all of it: the controller, built by its build description with plain calls of the compiler, and the plant, built by
its CMakeLists.txt, give the bits of the libraries that are shipped beside them."""

import shlex
import shutil
import subprocess
import tempfile
import unittest
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import fmpy

from fmu_test import Instance, answers, command, demo, export, slewlab
from run_log import REPOSITORY

COMPILERS = {"C11": ("cc", "-std=c11"), "C++20": ("c++", "-std=c++20")}
# Headers alone, as the description says; where Debian has those that are not among the system's own.
PLACES = {"Eigen3": "/usr/include/eigen3"}
PERIODS = 1500  # of the demo: rest, ramp, full speed
QUICKLY = ["-O0", "-w"]  # to build: optimisation may not change a bit
# In CMake: C++ is compiled ten sources at a time, but for those of which two have a name that each keeps to itself.
TOGETHER = """
file(GLOB_RECURSE alone RELATIVE ${CMAKE_CURRENT_SOURCE_DIR} *.c *.cpp)
list(FILTER alone INCLUDE REGEX "^tools/|[.]c$")
set_source_files_properties(${alone} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
"""


def precompiled(folder):
    """Options with which C++ takes what most sources include from one compilation: half of a source's time."""
    header = folder / "precompiled.h"
    shutil.copy(REPOSITORY / "cmake" / header.name, header)
    eigen = f"-isystem{PLACES['Eigen3']}"
    call(["c++", COMPILERS["C++20"][1], "-ffp-contract=off", *QUICKLY, "-fPIC", "-fvisibility=hidden", eigen, "-x", "c++-header", str(header),
          "-o", f"{header}.gch"], folder)
    return [eigen, "-include", str(header)]


def built_by_description(sources, out, options):
    """The library, by sources/buildDescription.xml of FMI 3; `options` of C++."""
    configuration = ElementTree.parse(sources / "buildDescription.xml").getroot().find("BuildConfiguration")
    includes = [f"-isystem{PLACES[each.get('name')]}" for each in configuration.findall("Library") if each.get("name") in PLACES]
    objects = []
    for part in configuration.findall("SourceFileSet"):
        compiler, standard = COMPILERS[part.get("language")]
        words = [compiler, standard, *shlex.split(part.get("compilerOptions")), *QUICKLY, "-fPIC", "-fvisibility=hidden", *includes]
        words += options if part.get("language") == "C++20" else []
        words += [f"-D{each.get('name')}={each.get('value')}" for each in part.findall("PreprocessorDefinition")]
        words += [f"-I{each.get('name')}" for each in part.findall("IncludeDirectory")]
        for file in part.findall("SourceFile"):
            objects.append(str(out.parent / (file.get("name").replace("/", "_") + ".o")))
            call([*words, "-c", file.get("name"), "-o", objects[-1]], sources)
    call(["c++", "-shared", "-Wl,--no-undefined", *objects, "-o", str(out)], sources)


def built_by_cmake(sources, out, options):
    """The library, by sources/CMakeLists.txt; `options` of C++."""
    folder, together = out.parent / "build", out.parent / "together.cmake"
    together.write_text(TOGETHER, encoding="utf-8")
    call(["cmake", "-S", str(sources), "-B", str(folder), "-DCMAKE_BUILD_TYPE=None", f"-DCMAKE_C_FLAGS={shlex.join(QUICKLY)}",
          f"-DCMAKE_CXX_FLAGS={shlex.join([*QUICKLY, *options])}", "-DCMAKE_UNITY_BUILD=ON", "-DCMAKE_UNITY_BUILD_BATCH_SIZE=10",
          f"-DCMAKE_PROJECT_slewlab_fmu_INCLUDE={together}"], sources)
    call(["cmake", "--build", str(folder), "-j2"], sources)
    shutil.copy(folder / "unit.so", out)


def call(words, folder):
    ended = subprocess.run(words, cwd=folder, stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False)
    assert ended.returncode == 0, shlex.join(words) + "\n" + ended.stderr


class FmuSourcesTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.TemporaryDirectory()
        cls.folder = Path(cls.scratch.name)
        cls.options = precompiled(cls.folder)

    @classmethod
    def tearDownClass(cls):
        cls.scratch.cleanup()

    def built_anew(self, file, build):
        """An instance of the FMU, begun, whose library is built of its sources by `build`."""
        fmu = export(slewlab.config(file), self.folder, "--fmi", "3")
        unpacked = Path(fmpy.extract(str(fmu), unzipdir=str(self.folder / f"{fmu.stem}_unpacked")))
        library = next((unpacked / "binaries").rglob("*.so"))
        shipped = library.read_bytes()
        build(unpacked / "sources", library, self.options)
        self.assertNotEqual(library.read_bytes(), shipped)
        shutil.rmtree(unpacked / "sources")
        return Instance(str(fmu), str(unpacked)).start()

    def test_the_controller_built_of_them_gives_the_shipped_ones_bits(self):
        run = demo()
        torque = run.messages("TORQUE")
        controller = self.built_anew("controllers/thesis.yaml", built_by_description)
        for k in answers(controller, run, PERIODS):
            for group in range(2):
                self.assertEqual(controller.get(f"motor_torque[{group + 1}]"), torque["motor_torque"][k][group], k)
        controller.close()
        self.assertGreater(abs(torque["motor_torque"][:PERIODS]).max(), 10.0)

    def test_the_plant_built_of_them_gives_the_shipped_ones_bits(self):
        run = demo()
        encoder, truth = run.messages("ENCODER"), run.messages("TRUTH")
        plant = self.built_anew("cranes/thesis.yaml", built_by_cmake)
        for k, said in enumerate(run.messages("TORQUE")[:PERIODS]):
            for group in range(2):
                self.assertEqual(plant.get(f"shaft_speed[{group + 1}]"), encoder["shaft_speed"][k][group], k)
            self.assertEqual(plant.get("tip_velocity"), truth["tip_velocity"][k], k)
            command(plant, said)
            plant.step()
        plant.close()
        self.assertGreater(abs(truth["tip_velocity"][:PERIODS]).max(), 1.0)  # [m/s]


if __name__ == "__main__":
    unittest.main()
