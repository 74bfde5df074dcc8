"""The commands on the pages run as they stand, page after page, in a folder that looks like the source tree; what a page takes
for granted (a recorder's file, a controller) lies there first. What cannot run in the suite stands below with its reason, and
its words are checked: the command, its options and the files of the project that it names are there.

A page's notation is read as a shell cannot: [WHAT MAY BE LEFT OUT], ONE|OTHER.
"""

import contextlib
import functools
import os
import re
import shutil
import signal
import subprocess
import tempfile
import unittest
from pathlib import Path

import numpy as np
import pandas as pd

from run_log import REPOSITORY, messages_folder

PAGES = [*sorted((REPOSITORY / "docs").rglob("*.md")), REPOSITORY / "CONTRIBUTING.md", REPOSITORY / "README.md"]
BUILD = messages_folder().parent

PROGRAM = r"(?:build/release/bin/)?slewlab(?:-[a-z-]+)?|tools/[\w-]+|\.venv/bin/python|python3?|pip|cmake|cpack|ctest|docker|man|source|study/\w+"
COMMAND = re.compile(rf"(?:\$ )?((?:export [A-Z]|[A-Z]+=\S+ |(?:{PROGRAM})(?= |$)).*)", re.DOTALL)
FENCE = re.compile(r"^( *)```(\w*)\n(.*?)^\1```", re.DOTALL | re.MULTILINE)
INDENTED = re.compile(r"(?:^ {4,}\S.*\n)+", re.MULTILINE)
INLINE = re.compile(r"`((?:build/release/bin/)?slewlab [a-z][^`]*)`")
SCRIPT = re.compile(r"(?<![\w./-])tools/[a-z][a-z-]*(?![\w./-])")

# Where a command begins with one of these, it does not run here.
NOT_HERE = {
    "tools/test": "is this suite",
    "tools/demo": "sets up and builds; what it runs, thesis_slew and report, runs below",
    "tools/setup": "sets up and builds the tree that is under test",
    "tools/build": "builds the tree that is under test",
    "tools/benchmark": "measures, for minutes, an idle machine",
    "tools/measure-desk": "measures, for two hours, an idle machine",
    "tools/kill-test": "two hundred runs; the suite has twenty of them",
    "tools/fuzz": "a minute per target; the suite runs the corpus",
    "tools/sanitize": "builds the whole tree anew",
    "python3 -m venv /usr/share": "writes into the system; debian_package uses what it installs",
    "cmake": "installed_library does it",
    "study/": "installed_library does it",
    "build/release/bin/slewlab run config/scenarios/thesis_slew.yaml --out runs/hour": "an hour, simulated",
    "build/release/bin/slewlab report runs/hour": "an hour, simulated",
    "build/release/bin/slewlab export runs/hour": "an hour, simulated",
    "build/release/bin/slewlab soak --hours 24": "a day, simulated",
    "build/release/bin/slewlab desk": "serves until it is stopped; desk_test does it",
    "build/release/bin/slewlab bridge": "serves until it is stopped; bridge_test does it",
    "build/release/bin/slewlab soft-plc": "serves until it is stopped; plc_link_test does it",
    "build/release/bin/slewlab run config/scenarios/thesis_slew.yaml --realtime": "a minute by the clock, with a PLC; plc_link_test does it",
    'build/release/bin/slewlab run config/scenarios/thesis_slew.yaml --controller "exec build/release/bin/slewlab-st-host': "takes what a user's own compiler made; the tests of structured_text do it",
    "slewlab diagnose --crane": "takes minutes; notebook 4 and the tests of diagnosis do it",
    "build/release/bin/slewlab diagnose --crane": "takes minutes; notebook 4 and the tests of diagnosis do it",
    "tools/in-private-network build/release/bin/slewlab run config/scenarios/slew_there_and_back.yaml": "takes what a diagnosis found",
    "slewlab withhold": "hundreds of machines",
    "slewlab campaign config/campaigns/withheld_thesis.yaml": "sixteen machines; campaign_test makes two",
    ".venv/bin/python tools/python/score_report.py": "takes what a scored set found; score_report_test does it",
}

# What a page says that a command ends with, where that is not 0.
EXIT_CODES = {
    "slewlab campaign config/campaigns/load_and_boom.yaml": 1,  # some combinations break a check, which is what it is for
    "build/release/bin/slewlab campaign config/campaigns/quarter_turn_and_back.yaml": 1,  # without play compensation the gears pass their clearance
    "--contoller mine": 2,
    'accept config/scenarios/thesis_slew.yaml --controller ".venv/bin/python mine.py"': 1,  # it has no ramp
}


def read_as_a_shell(command):
    """Without the page's notation."""
    command = re.sub(r" \[[^\]]*\]", "", command)
    return re.sub(r"(?<=[\w.])\|[\w.|]+", "", command)


@functools.cache
def commands():
    """[(page, command)] in the order of the pages."""
    found = []
    for page in PAGES:
        text = page.read_text(encoding="utf-8")
        blocks = [(f.start(), re.sub("^" + f.group(1), "", f.group(3), flags=re.MULTILINE)) for f in FENCE.finditer(text)
                  if f.group(2) in ("", "sh", "bash")]
        bare = FENCE.sub(lambda f: re.sub(r"[^\n]", "x", f.group(0)), text)  # of the same length, and nothing in it
        blocks += [(f.start(), re.sub("^ {4,}", "", f.group(0), flags=re.MULTILINE)) for f in INDENTED.finditer(bare)]
        for _, block in sorted(blocks):
            # A command ends with its line, but for a quotation that goes on, and but for the line's backslash.
            for words in re.split(r"\n(?=(?:[^']*'[^']*')*[^']*$)", re.sub(r"\\\n\s*", " ", block)):
                match = COMMAND.match(words)
                if match and not re.match(r"slewlab[\w -]*: ", match.group(1)):  # what a program answered
                    found.append((page.relative_to(REPOSITORY), match.group(1).strip()))
    return found


@functools.cache
def answers():
    """{(page, command): what the page prints below `$ command`}."""
    found = {}
    for page in PAGES:
        for fence in FENCE.finditer(page.read_text(encoding="utf-8")):
            for command, answer in re.findall(r"^\$ (.*)\n((?:(?!\$ ).+\n)*)", fence.group(3), re.MULTILINE):
                found[page.relative_to(REPOSITORY), command.strip()] = answer.strip()
    return found


def reason_not_here(command):
    return next((why for beginning, why in NOT_HERE.items() if command.startswith(beginning)), None)


@functools.cache
def help_of(*words):
    told = subprocess.run([BUILD / "bin" / "slewlab", *words, "--help"], stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=120)
    assert told.returncode == 0, told.stdout + told.stderr
    return told.stdout


def fault_in_words(command):
    """What is wrong with a command of slewlab that is not run: an unknown command, an unknown option, a file that is not there."""
    words = re.sub(r'"[^"]*"|#.*', "x", command).split()
    words = words[words.index(next(word for word in words if word.endswith("slewlab"))) + 1:]
    path = []
    for word in words:
        below = re.findall(r"^  ([a-z-]+) {2,}", help_of(*path).partition("Subcommands:")[2], re.MULTILINE)
        if not below or word.startswith("-"):
            break
        if word not in below:
            return f"there is no command {' '.join([*path, word])}"
        path.append(word)
    known = set(re.findall(r"(?<![\w-])--?[a-z][\w-]*", help_of(*path)))
    unknown = [word for word in (word.split("=")[0] for word in words) if re.match(r"--?[a-z]", word) and word not in known]
    if unknown:
        return f"{' '.join(path)} has no option {', '.join(unknown)}"
    absent = [word for word in words if word.startswith(("config/", "examples/")) and not (REPOSITORY / word).exists()]
    return f"there is no {', '.join(absent)}" if absent else None


def code_on(page, language, number=0):
    return re.findall(rf"^ *```{language}\n(.*?)^ *```", (REPOSITORY / page).read_text(encoding="utf-8"), re.DOTALL | re.MULTILINE)[number]


def unindented(text):
    lead = min(len(line) - len(line.lstrip()) for line in text.splitlines() if line.strip())
    return "".join(line[lead:] + "\n" for line in text.splitlines())


def lay_out(folder):
    """What the pages take for granted."""
    for name in ("config", "tools", "examples", ".venv"):
        (folder / name).symlink_to(REPOSITORY / name)
    (folder / "build").mkdir()
    (folder / "build" / "release").symlink_to(BUILD)
    programs = folder / "programs"
    programs.mkdir()
    for name in ("my-controller", "new-version"):
        (programs / name).symlink_to(BUILD / "bin" / "slewlab-controller")
    (folder / "plc").symlink_to(BUILD / "bin" / "slewlab-controller")
    for name in ("RUN_DIR", "runs/yesterday", "runs/accepted", "runs/site_march"):
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).symlink_to(folder / "runs" / "thesis_slew")
    shutil.copy(REPOSITORY / "config" / "acceptance" / "thesis.yaml", folder / "my_limits.yaml")

    (folder / "my_controller.py").write_text(code_on("README.md", "python"))
    (folder / "mine.py").write_text(code_on("docs/your_own_controller.md", "python"))

    # A recorder's file: a motor turned there and back by a torque.
    time = np.arange(0.0, 10.0, 0.01)
    angle = 50.0 * (1.0 - np.cos(0.6 * time))  # [rad]
    pd.DataFrame({"time [s]": time, "motor_position [rad]": angle, "motor_speed [rad/s]": 30.0 * np.sin(0.6 * time),
                  "motor_torque [Nm]": 20.0 * np.cos(0.6 * time)}).to_csv(folder / "FILE.csv", index=False)
    (folder / "machine.yaml").write_text(code_on("docs/axis.md", "yaml", 0))
    (folder / "map.yaml").write_text(unindented(code_on("docs/axis.md", "yaml", 1)))
    for name, travel in (("record", 0.1), ("fit_a", 0.1), ("fit_b", 0.15)):  # [m], with the current of a mass of 95 kg and 80 N of dry friction
        force = 95.0 * travel * 0.36 * np.cos(0.6 * time) + 80.0 * np.sign(np.sin(0.6 * time))
        pd.DataFrame({"time_s": time, "position_mm": 1e3 * travel * (1.0 - np.cos(0.6 * time)),
                      "current_A": force * 0.0025 / (2 * np.pi) / 0.0934}).to_csv(folder / f"{name}.csv", index=False)


class DocsCommandsTest(unittest.TestCase):
    def test_pages_are_read_as_they_are_written(self):
        pages = {str(page) for page, _ in commands()}
        for page in ("README.md", "docs/accept.md", "docs/axis.md", "docs/diagnosis/how_to.md", "docs/your_own_controller.md"):
            self.assertIn(page, pages)
        self.assertGreater(len(commands()), 60)
        self.assertEqual(read_as_a_shell("slewlab import --map MAP.yaml FILE.csv|FILE.parquet [--out LOG.lcmlog]"), "slewlab import --map MAP.yaml FILE.csv")

    def test_a_command_that_could_not_be_called_is_noticed(self):
        self.assertIsNone(fault_in_words("build/release/bin/slewlab run config/scenarios/thesis_slew.yaml --set duration=3 --out x"))
        self.assertEqual(fault_in_words("slewlab run config/scenarios/thesis_slew.yaml --contoller mine"), "run has no option --contoller")
        self.assertEqual(fault_in_words("slewlab runn config/scenarios/thesis_slew.yaml"), "there is no command runn")
        self.assertEqual(fault_in_words("slewlab run config/scenarios/no_slew.yaml"), "there is no config/scenarios/no_slew.yaml")

    def test_printed_answers_are_found(self):
        self.assertIn("'--contoller' is no option of it", answers()[Path("docs/command_line.md"), "slewlab run config/scenarios/thesis_slew.yaml --contoller mine"])

    def test_no_reason_stands_for_nothing(self):
        self.assertEqual([beginning for beginning in NOT_HERE if not any(command.startswith(beginning) for _, command in commands())], [])

    def test_what_does_not_run_here_could_be_called(self):
        spoken = [(page, command) for page, command in commands() if reason_not_here(command) and re.match(r"\S*slewlab |tools/in-private", command)]
        spoken += [(page.relative_to(REPOSITORY), text) for page in PAGES for text in INLINE.findall(page.read_text(encoding="utf-8"))]
        for page, command in spoken:
            for way in re.split(r"(?<= )\|(?= )", command):
                with self.subTest(page=str(page), command=way):
                    self.assertIsNone(fault_in_words(re.sub(r"[\[\]]", "", way)))
        for page in PAGES:
            for script in SCRIPT.findall(page.read_text(encoding="utf-8")):
                self.assertTrue((REPOSITORY / script).exists(), f"{page}: {script}")

    def test_what_runs_here_runs(self):
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            lay_out(folder)
            environment = os.environ | {"PATH": f"{folder / 'programs'}:{BUILD / 'bin'}:{os.environ['PATH']}"}
            environment.pop("PYTHONPATH", None)
            first = "build/release/bin/slewlab run config/scenarios/thesis_slew.yaml"  # whose record other pages take for granted
            self.run_one(folder, environment, "before all", first)
            for name in ("fit_a", "fit_b"):
                self.run_one(folder, environment, "before all", f"slewlab import --map map.yaml {name}.csv --out {name}.lcmlog")
            exports = {}
            for page, command in commands():
                command = re.sub(r"\s+# .*", "", read_as_a_shell(command))
                if command.startswith("export "):
                    exports[page] = f"{command}; "
                elif not reason_not_here(command) and command != first:
                    self.run_one(folder, environment, page, exports.get(page, "") + command)

    def run_one(self, folder, environment, page, command):
        wanted = next((code for words, code in EXIT_CODES.items() if words in command), 0)
        with self.subTest(page=str(page), command=command):
            with tempfile.TemporaryFile("w+") as output:
                shell = subprocess.Popen(["bash", "-c", command], cwd=folder, env=environment, stdin=subprocess.DEVNULL, stdout=output,
                                         stderr=subprocess.STDOUT, start_new_session=True)
                try:
                    code = shell.wait(timeout=120)
                finally:  # what it left in the background, or did not end
                    with contextlib.suppress(ProcessLookupError):
                        os.killpg(shell.pid, signal.SIGKILL)
                    shell.wait()
                output.seek(0)
                said = output.read()
                self.assertEqual(code, wanted, said[-3000:])
                self.assertIn(answers().get((page, command), ""), said, "the page shows another answer")


if __name__ == "__main__":
    unittest.main()
