"""Ctrl-C in a program of the Python side: one line, exit code 130, and nothing half written."""

import os
import re
import signal
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import launch
from browser import until
from run_log import REPOSITORY, messages_folder

PROGRAM = messages_folder().parent / "bin" / "slewlab"
LAUNCHER = REPOSITORY / "tools" / "python" / "launch.py"


class LaunchTest(unittest.TestCase):
    def setUp(self):
        holder = tempfile.TemporaryDirectory()
        self.addCleanup(holder.cleanup)
        self.folder = Path(holder.name)

    def test_ctrl_c_ends_it_by_one_line(self):
        data, made = self.folder / "data.csv", self.folder / "map.yaml"
        os.mkfifo(data)
        running = subprocess.Popen([PROGRAM, "new", "map", made, "--data", data], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)

        def is_read():  # a pipe nobody reads cannot be opened like this
            try:
                self.end = os.open(data, os.O_WRONLY | os.O_NONBLOCK)
            except OSError:
                return running.poll() is not None
            return True

        until(is_read, "the program reads the data")
        running.send_signal(signal.SIGINT)
        out, errors = running.communicate(timeout=60)
        os.close(self.end)
        self.assertEqual((running.returncode, out, errors), (130, "", "interrupted\n"))
        self.assertFalse(made.exists())

    def test_while_it_still_imports_too(self):
        program = self.folder / "slow.py"
        program.write_text("import os, signal\nos.kill(os.getpid(), signal.SIGINT)\nimport this_is_never_reached\n")
        ended = subprocess.run([sys.executable, LAUNCHER, program], stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=60, check=False)
        self.assertEqual((ended.returncode, ended.stdout, ended.stderr), (130, "", "interrupted\n"))

    def test_a_library_that_is_not_installed_is_told_with_what_installs_it(self):
        program = self.folder / "other.py"
        program.write_text("import nowhere_installed.part\n")
        ended = subprocess.run([sys.executable, LAUNCHER, program], stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=60, check=False)
        self.assertEqual((ended.returncode, ended.stdout), (1, ""))
        self.assertEqual(ended.stderr, f"slewlab other: the Python library nowhere_installed is not installed for {sys.executable}. tools/setup installs it\n")

    def test_what_installs_a_library_is_what_the_installation_has(self):
        """A Debian package: PREFIX/share/slewlab/tools/python; a wheel: the same within its package."""
        here = self.folder / "share" / "slewlab" / "tools" / "python"
        here.mkdir(parents=True)
        said = launch.what_installs(here)
        self.assertIn(f"pip install -r {here / 'requirements.txt'}; or name an interpreter that has it in SLEWLAB_PYTHON", said)
        (self.folder / "__init__.py").touch()
        self.assertIn("pip install 'WHEEL[commands,plc]'", launch.what_installs(here))

    def test_a_message_names_the_command_that_was_typed(self):
        commands = (REPOSITORY / "tools" / "commands" / "main.cpp").read_text()
        called = {script: name for name, script in re.findall(r'add_python\(app, "([\w-]+)", "(\w+)\.py"', commands)}
        self.assertGreater(len(called), 5)
        for script in re.findall(r'(?:run_python|call_python|draw)\("(\w+)\.py"', commands):
            called.setdefault(script, None)
        words = set(re.findall(r'add_subcommand\("([\w-]+)"', commands)) | set(called.values()) | {"check", "new map"}
        for script, name in called.items():
            told = launch.command_of(script).removeprefix("slewlab ")
            self.assertIn(told, words, script)
            self.assertEqual(told, name or told)

    def test_completion_offers_options_that_can_be_typed(self):
        script = subprocess.run([PROGRAM, "completion"], capture_output=True, text=True, timeout=60, check=True).stdout
        offered = [word for words in re.findall(r'words="([^"]*)"', script) for word in words.split() if word.startswith("--")]
        self.assertGreater(len(offered), 100)
        self.assertEqual([word for word in offered if not re.fullmatch("--[a-z-]+", word)], [])

    def test_arguments_name_and_exit_code_are_the_programs_own(self):
        program = self.folder / "own.py"
        program.write_text("import sys\nprint(__name__, sys.argv)\nsys.exit(7)\n")
        ended = subprocess.run([sys.executable, LAUNCHER, program, "a", "--b"], stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=60, check=False)
        self.assertEqual((ended.returncode, ended.stdout), (7, f"__main__ {[str(program), 'a', '--b']}\n"))


if __name__ == "__main__":
    unittest.main()
