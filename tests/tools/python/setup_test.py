"""tools/setup with stand-ins for the system's programs: what it calls, and what it says when it cannot go on."""

import shutil
import subprocess
import tempfile
import unittest
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[3]


class SetupTest(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.root = Path(temporary.name)
        (self.root / "tools" / "python").mkdir(parents=True)
        shutil.copy(REPOSITORY / "tools" / "setup", self.root / "tools" / "setup")
        names = ("requirements.txt", "requirements_development.txt")
        wanted = [Path(shutil.copy(REPOSITORY / "tools" / "python" / name, self.root / "tools" / "python")) for name in names]
        # A Python side that is as the requirements want it.
        version = subprocess.run(["/usr/bin/python3", "--version"], capture_output=True, text=True).stdout.strip()
        (self.root / ".venv" / "bin").mkdir(parents=True)
        self.stand_in(".venv/bin/python", 'echo "venv python $*" >>"$CALLS"')
        (self.root / ".venv" / "slewlab-requirements").write_text(f"{version} " + "".join(path.read_text() for path in wanted))

    def stand_in(self, name, script):
        path = self.root / name
        path.parent.mkdir(exist_ok=True)
        path.write_text(f"#!/bin/sh\n{script}\n")
        path.chmod(0o755)

    def run_setup(self, missing=(), apt_get="exit 0", user=0):
        """Exit code, output, and the calls of apt-get, where `missing` packages are not installed."""
        calls = self.root / "calls"
        calls.write_text("")
        absent = "|".join(missing) or "none"
        self.stand_in("bin/dpkg-query", f'for last; do :; done; case "$last" in {absent}) exit 1;; esac; echo installed')
        self.stand_in("bin/apt-get", f'echo "apt-get $*" >>"$CALLS"\n{apt_get}')
        self.stand_in("bin/id", f"echo {user}")
        # Of the system's own programs only what the script needs: above all no sudo.
        for program in ("dirname", "sh", "env", "mktemp", "rm", "tail", "cat", "sed", "readlink"):
            link = self.root / "bin" / program
            if not link.exists():
                link.symlink_to(shutil.which(program, path="/usr/bin:/bin"))
        result = subprocess.run([self.root / "tools" / "setup"], stdin=subprocess.DEVNULL, capture_output=True, text=True,
                                env={"PATH": str(self.root / "bin"), "CALLS": str(calls), "HOME": str(self.root)})
        return result.returncode, result.stdout + result.stderr, calls.read_text().splitlines()

    def test_where_nothing_is_missing_nothing_is_called(self):
        code, output, calls = self.run_setup()
        self.assertEqual((code, calls), (0, []), output)
        self.assertIn("everything is here", output)

    def test_what_is_missing_and_nothing_else_is_installed(self):
        code, output, calls = self.run_setup(missing=["ninja-build", "liblcm-dev"])
        self.assertEqual(code, 0, output)
        self.assertEqual(calls[0], "apt-get update")
        words = calls[1].split()
        self.assertEqual([w for w in words if not w.startswith("-")], ["apt-get", "install", "ninja-build", "liblcm-dev"])
        self.assertIn("--yes", words)

    def test_a_failed_installation_is_told_with_its_last_words(self):
        code, output, _ = self.run_setup(missing=["ninja-build"], apt_get='echo "E: no such mirror"; exit 100')
        self.assertEqual(code, 1)
        self.assertIn("E: no such mirror", output)
        self.assertIn("apt-get could not install: ninja-build", output)
        self.assertNotIn("everything is here", output)

    def test_without_root_and_sudo_the_command_for_root_is_named(self):
        code, output, calls = self.run_setup(missing=["ninja-build"], user=1000)
        self.assertEqual((code, calls), (1, []))
        self.assertIn("As root, run: apt-get install ninja-build", output)

    def test_an_environment_of_another_tree_is_not_emptied(self):
        other = self.root / "other"
        (self.root / ".venv").rename(other)
        (other / "slewlab-requirements").write_text("of other requirements")
        (self.root / ".venv").symlink_to(other)
        code, output, _ = self.run_setup()
        self.assertEqual(code, 1)
        self.assertIn(".venv is a link to", output)
        self.assertTrue((other / "bin" / "python").exists())

    def test_the_hunt_asks_for_its_compiler(self):
        shutil.copy(REPOSITORY / "tools" / "fuzz", self.root / "tools" / "fuzz")
        self.stand_in("tools/setup", 'echo "$SLEWLAB_MORE_PACKAGES"; exit 7')
        ended = subprocess.run([self.root / "tools" / "fuzz"], stdin=subprocess.DEVNULL, capture_output=True, text=True)
        # Clang's sanitizers and libFuzzer are a package of their own.
        self.assertEqual((ended.returncode, ended.stdout.split()), (7, ["libclang-rt-dev"]), ended.stderr)

    def test_the_second_compiler_is_installed_with_the_first(self):
        """tools/compare-compilers is skipped where there is no clang, or none that knows the OpenMP that SUNDIALS' package asks for."""
        code, output, calls = self.run_setup(missing=["clang", "libomp-dev"])
        self.assertEqual(code, 0, output)
        self.assertEqual([w for w in calls[1].split()[2:] if not w.startswith("-")], ["clang", "libomp-dev"])

    def test_other_requirements_make_the_python_side_anew_and_a_half_made_one_does_not_count(self):
        requirements = self.root / "tools" / "python" / "requirements.txt"
        requirements.write_text("--no-such-option\n")
        code, output, _ = self.run_setup()
        self.assertEqual(code, 1, output)
        self.assertIn("pip could not install", output)
        for name in ("requirements.txt", "requirements_development.txt"):  # nothing to fetch
            (requirements.parent / name).write_text("")
        code, output, _ = self.run_setup()
        self.assertEqual(code, 0, output)
        self.assertIn("making .venv", output)
        self.assertEqual((self.root / ".venv" / "bin" / "python").is_symlink(), True, "still the stand-in")
        code, output, _ = self.run_setup()
        self.assertEqual(code, 0, output)
        self.assertNotIn("making .venv", output)


if __name__ == "__main__":
    unittest.main()
