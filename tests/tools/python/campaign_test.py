"""`slewlab campaign`: draws, the same bytes from any number of workers, a kill at any moment, and the page."""

import dataclasses
import json
import os
import shlex
import signal
import subprocess
import sys
import tempfile
import unittest
import unittest.mock
from pathlib import Path

import numpy as np

import campaign_page
from browser import until
from run_log import REPOSITORY, messages_folder

sys.path.insert(0, str(messages_folder()))
import slewlab  # noqa: E402
from slewlab import campaigns, engine  # noqa: E402
from slewlab.study import Study, Varied, load_study  # noqa: E402

PROGRAM = messages_folder().parent / "bin" / "slewlab"

SCENARIO = """include: {config}/scenarios/thesis_slew.yaml
duration: {{value: 4, unit: s, source: "test: short"}}
operator:
  - time: {{value: 0.5, unit: s, source: "test"}}
    speed_request: {{value: 1, unit: "-", source: "test"}}
  - time: {{value: 2, unit: s, source: "test"}}
    emergency_stop: {{value: true, source: "test"}}
"""
STUDY = """kind: campaign
scenarios: [{{file: short.yaml}}]
limits: {config}/acceptance/thesis.yaml
draw: {{value: random, source: test}}
runs: {{value: {runs}, unit: "-", source: test}}
seed: {{value: 5, unit: "-", source: test}}
vary:
  - key: crane.load.mass
    range: {{value: [10, 60], unit: t, source: test}}
  - key: crane.boom.angle
    values: {{value: [30, 60], unit: deg, source: test}}
  - key: seed
    range: {{value: [1, 1000], unit: "-", source: test}}
    whole: {{value: true, source: test}}
"""


def write_study(folder, runs=8, change=lambda text: text):
    config = slewlab.config()
    (folder / "short.yaml").write_text(SCENARIO.format(config=config))
    path = folder / "study.yaml"
    path.write_text(change(STUDY.format(config=config, runs=runs)))
    return path


def varied(spread, values, unit="-", whole=False):
    return Varied("x", spread, tuple(values), unit, whole)


def ends_its_process(task):
    if task == 3:
        os._exit(9)
    return 10 * task


class DrawTest(unittest.TestCase):
    def study(self, draw, runs, *vary):
        return Study("s", ("a.yaml",), None, draw, runs, 1, vary)

    def test_a_grid_has_every_combination_the_last_key_first(self):
        grid = Study("s", ("a.yaml", "b.yaml"), None, "grid", 0, 0, (Varied("p", "values", ("1", "2"), "t", False), Varied("q", "values", ("u", "v"), "-", False)))
        self.assertEqual([(case.run, case.scenario, dict(case.changes)) for case in grid.cases()][:3] + [len(grid.cases())],
                         [(0, "a.yaml", {"p": "1 t", "q": "u"}), (1, "a.yaml", {"p": "1 t", "q": "v"}), (2, "a.yaml", {"p": "2 t", "q": "u"}), 8])

    def test_a_latin_hypercube_has_one_run_in_every_stratum(self):
        runs = 40
        study = self.study("latin_hypercube", runs, varied("range", ("2", "6")), varied("log_range", ("1", "100")))
        values = np.array(study.draws(), float)
        for shares in ((values[:, 0] - 2) / 4, np.log10(values[:, 1]) / 2):
            self.assertEqual(sorted(np.floor(shares * runs).astype(int)), list(range(runs)))

    def test_a_longer_random_draw_begins_as_the_shorter_one(self):
        self.assertEqual(self.study("random", 9, varied("range", ("0", "1"))).draws()[:5], self.study("random", 5, varied("range", ("0", "1"))).draws())

    def test_drawn_values_have_the_distribution_asked_for(self):
        normal = np.array(self.study("random", 4000, varied("normal", ("30", "2"))).draws(), float)
        self.assertAlmostEqual(normal.mean(), 30.0, delta=4 * 2 / np.sqrt(4000))
        self.assertAlmostEqual(normal.std(), 2.0, delta=4 * 2 / np.sqrt(8000))
        whole = {text for (text,) in self.study("random", 200, varied("range", ("1", "3"), whole=True)).draws()}
        self.assertEqual(whole, {"1", "2", "3"})
        words = {text for (text,) in self.study("random", 100, varied("values", ("s_curve", "linear"))).draws()}
        self.assertEqual(words, {"s_curve", "linear"})


class EngineTest(unittest.TestCase):
    def test_a_worker_that_dies_takes_only_its_task_with_it(self):
        found = dict(engine.run_in_processes(ends_its_process, range(6), 2))
        self.assertIsInstance(found.pop(3), engine.WorkerDied)
        self.assertEqual(found, {task: 10 * task for task in (0, 1, 2, 4, 5)})

    def test_what_a_task_raises_comes_out(self):
        with self.assertRaises(ZeroDivisionError):
            list(engine.run_in_threads(lambda task: 1 / task, [1, 0], 2))


class CampaignTest(unittest.TestCase):
    def setUp(self):
        holder = tempfile.TemporaryDirectory()
        self.addCleanup(holder.cleanup)
        self.folder = Path(holder.name)

    def bytes_of(self, out):
        return (self.folder / out / "campaign.parquet").read_bytes()

    def test_the_bytes_do_not_depend_on_workers_or_where_they_are(self):
        from distributed import Client, LocalCluster

        study = write_study(self.folder)
        for workers in (0, 1, 2, 8):
            slewlab.campaign(study, self.folder / str(workers), workers=workers, progress=False)
        with LocalCluster(n_workers=2, threads_per_worker=1, processes=False, dashboard_address=None) as cluster, Client(cluster) as client:
            slewlab.campaign(study, self.folder / "dask", client=client, progress=False)
        for other in ("1", "2", "8", "dask"):
            self.assertEqual(self.bytes_of(other), self.bytes_of("0"), other)

    def test_rows_say_what_a_run_says_and_how_to_make_it_again(self):
        frame = slewlab.campaign(write_study(self.folder, runs=2), self.folder / "out", workers=0, progress=False)
        row = frame.loc[1]
        scenario = slewlab.Scenario(self.folder / "short.yaml", {"crane.load.mass": f"{row['crane.load.mass']} t", "seed": int(row["seed"]),
                                                                 "crane.boom.angle": f"{row['crane.boom.angle']} deg"})
        self.assertEqual(slewlab.measures(scenario.run())["peak_tip_acceleration"], row["peak_tip_acceleration"])
        self.assertEqual(frame.attrs["units"]["crane.load.mass"], "t")
        self.assertEqual(frame.attrs["units"]["measured.sidelead"], "deg")
        words = shlex.split(row["command"])
        out = self.folder / "again"
        ended = subprocess.run([REPOSITORY / "tools" / "in-private-network", PROGRAM, *words[1:], "--out", out, "--no-plot"],
                               stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=100, check=False)
        self.assertEqual(ended.returncode, 0 if row["outcome"] == "accepted" else 1, ended.stdout + ended.stderr)
        told = json.loads((out / "summary.json").read_text())["run"]
        self.assertEqual((told["log_digest"], told["configuration_hash"]), (row["log_digest"], row["configuration_hash"]))
        checks = {each["name"]: each for each in json.loads((out / "acceptance.json").read_text())["checks"]}
        self.assertEqual(checks["sidelead"]["measured"], row["measured.sidelead"])

    def test_killed_at_any_moment_it_goes_on_where_it_was(self):
        study = write_study(self.folder, runs=12)
        whole = slewlab.campaign(study, self.folder / "whole", workers=0, progress=False)
        self.assertEqual(len(whole), 12)
        out = self.folder / "killed"
        journal = out / "journal.jsonl"
        running = subprocess.Popen([PROGRAM, "campaign", study, "--out", out, "--workers", "2"], stdin=subprocess.DEVNULL,
                                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        until(lambda: (journal.is_file() and journal.read_bytes().count(b"\n") >= 3) or running.poll() is not None, "two runs are done")
        workers = Path(f"/proc/{running.pid}/task/{running.pid}/children").read_text().split() if running.poll() is None else []
        running.send_signal(signal.SIGKILL)
        running.wait()
        until(lambda: not any(Path(f"/proc/{pid}/exe").exists() for pid in workers), "the workers ended with their parent")
        with open(journal, "ab") as file:
            file.write(b'{"run":11,"scena')  # as a power cut leaves it
        slewlab.campaign(study, out, workers=0, progress=False)
        lines = journal.read_bytes().splitlines()
        self.assertEqual(sorted(json.loads(line)["run"] for line in lines[1:]), list(range(12)))  # each once
        self.assertEqual(self.bytes_of("killed"), self.bytes_of("whole"))

    def test_a_damaged_line_is_told_with_file_and_line_and_nothing_is_lost(self):
        study, out = write_study(self.folder, runs=3), self.folder / "out"
        slewlab.campaign(study, out, workers=0, progress=False)
        whole, table = (out / "journal.jsonl").read_bytes().splitlines(keepends=True), self.bytes_of("out")
        for line, damage, said in ((3, lambda text: text[:40] + b"\n", "delete that line"), (2, lambda text: b"\xff" + text, "delete that line"),
                                   (4, lambda text: b'{"run":2}\n', "delete that line"), (1, lambda text: text[7:], "name another folder with --out")):
            damaged = [damage(text) if number == line else text for number, text in enumerate(whole, 1)]
            content = b"".join(damaged) + b'{"run":'  # and one that a kill cut off
            with self.subTest(line=line):
                (out / "journal.jsonl").write_bytes(content)
                ended = self.campaign_command(study, "--out", out)
                self.assertEqual((ended.returncode, ended.stderr.count("\n")), (2, 1), ended.stderr)
                self.assertIn(f"{out / 'journal.jsonl'}:{line}: ", ended.stderr)
                self.assertIn(said, ended.stderr)
                self.assertEqual((out / "journal.jsonl").read_bytes(), content)
                self.assertEqual(self.bytes_of("out"), table)
        (out / "journal.jsonl").write_bytes(b"".join(whole[:2] + whole[3:]))  # as it says
        slewlab.campaign(study, out, workers=0, progress=False)
        self.assertEqual(self.bytes_of("out"), table)

    def campaign_command(self, *words):
        return subprocess.run([PROGRAM, "campaign", *words], stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=100, check=False)

    def test_an_address_that_is_none_is_refused_in_a_sentence(self):
        for address in ("foo", "tcp://host:port", "xyz://host:8786"):
            with self.subTest(address=address):
                ended = self.campaign_command(write_study(self.folder), "--out", self.folder / "out", "--dask", address)
                self.assertEqual((ended.returncode, ended.stderr.count("\n")), (2, 1), ended.stderr)
                self.assertIn(f"--dask: found '{address}'", ended.stderr)
                self.assertIn("expected the address of Dask's scheduler, tcp://HOST:PORT", ended.stderr)

    def test_a_page_does_not_outlive_its_table(self):
        study, out = write_study(self.folder, runs=2), self.folder / "out"
        self.assertIn(self.campaign_command(study, "--out", out).returncode, (0, 1))
        self.assertTrue((out / "campaign.html").is_file())

        def ended(case):
            raise KeyboardInterrupt

        with unittest.mock.patch.object(campaigns, "task_function", return_value=ended), self.assertRaises(KeyboardInterrupt):
            slewlab.campaign(write_study(self.folder, runs=3), out, workers=0, progress=False)
        self.assertEqual(sorted(path.name for path in out.iterdir()), ["journal.jsonl"])

    def test_a_random_campaign_is_made_longer_and_another_one_refused(self):
        slewlab.campaign(write_study(self.folder, runs=2), self.folder / "out", workers=0, progress=False)
        longer = slewlab.campaign(write_study(self.folder, runs=3), self.folder / "out", workers=0, progress=False)
        self.assertEqual(len(longer), 3)
        for change, why in ((("[10, 60]", "[10, 50]"), "its run 0 is not this study's"), (("limits: ", "#"), "limits differ")):
            with self.subTest(why=why), self.assertRaisesRegex(slewlab.CampaignMismatch, why):
                slewlab.campaign(write_study(self.folder, 3, lambda text: text.replace(*change)), self.folder / "out", workers=0, progress=False)

    def test_a_worker_that_works_elsewhere_finds_the_files(self):
        study = write_study(self.folder, runs=1)
        case = load_study(study).cases()[0]
        relative = dataclasses.replace(case, scenario="short.yaml")
        row = campaigns.run_case(relative, str(slewlab.config("acceptance/thesis.yaml")), str(self.folder))
        known = campaigns.run_case(case, str(slewlab.config("acceptance/thesis.yaml")), "/")
        self.assertEqual(row["scenario"], "short.yaml")
        self.assertEqual({**row, "scenario": None}, {**known, "scenario": None})

    def test_ones_own_controller_is_tried_over_lcm(self):
        example = REPOSITORY / "examples" / "controller_in_python" / "controller.py"
        command = f"PYTHONDONTWRITEBYTECODE=1 PYTHONPATH={shlex.quote(str(messages_folder()))} {shlex.quote(sys.executable)} {shlex.quote(str(example))}"
        study = write_study(self.folder, runs=1)
        for name, controller, outcome in (("own", command, "not accepted"), ("dead", "exit 3", "failed")):
            out = self.folder / name
            ended = subprocess.run([REPOSITORY / "tools" / "in-private-network", PROGRAM, "campaign", study, "--out", out, "--workers", "0",
                                    "--controller", controller], stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=100, check=False)
            self.assertEqual(ended.returncode, 1, ended.stdout + ended.stderr)
            row = slewlab.read_table(out / "campaign.parquet").loc[0]
            self.assertEqual(row["outcome"], outcome, row["reason"])
            self.assertEqual(shlex.split(row["command"])[-9:-6], [slewlab.config("acceptance/thesis.yaml").as_posix(), "--controller", controller])
            if name == "dead":
                self.assertEqual(row["reason"], "ProgramFailed: the controller ended before its time: exit code 3")
        # The example is the thesis's controller: its table has what ours has, but for the command.
        ours = slewlab.campaign(study, self.folder / "ours", workers=0, progress=False)
        own = slewlab.read_table(self.folder / "own" / "campaign.parquet")
        self.assertEqual(own["configuration_hash"][0], ours["configuration_hash"][0])
        self.assertAlmostEqual(own["peak_tip_acceleration"][0], ours["peak_tip_acceleration"][0], places=9)

    def test_without_slurm_it_says_so(self):
        ended = subprocess.run([PROGRAM, "campaign", write_study(self.folder), "--out", self.folder / "out", "--slurm", "1"],
                               stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=100, check=False,
                               env=os.environ | {"PATH": str(self.folder)})
        self.assertEqual((ended.returncode, ended.stderr), (1, "slewlab campaign: there is no sbatch here: --slurm is for a machine "
                                                               "from which Slurm takes jobs\n"))

    def test_a_job_that_slurm_does_not_take_or_that_never_works_is_told(self):
        # Stand-ins for Slurm's two commands; tools/check-slurm runs the real ones.
        for sbatch, squeue, told in (
            ("echo 'sbatch: error: Memory specification can not be satisfied' >&2; exit 1", "exit 1",
             "slewlab campaign: Slurm takes no such job: sbatch: error: Memory specification can not be satisfied. What a job asks for stands under "
             "jobqueue: slurm: in ~/.config/dask/jobqueue.yaml\n"),
            ("echo Submitted batch job 7", "exit 0",
             "waiting for the first of 1 jobs of Slurm\nslewlab campaign: every job of Slurm ended (7) and none came to work; what it printed is in its "
             "log-directory. Workers need the package: export PYTHONPATH in job-script-prologue, docs/campaign.md\n"),
        ):
            for name, text in (("sbatch", sbatch), ("squeue", squeue), ("scancel", "exit 0")):
                (self.folder / name).write_text(f"#!/bin/sh\n{text}\n")
                (self.folder / name).chmod(0o755)
            (self.folder / "jobqueue.yaml").write_text("jobqueue: {slurm: {cores: 1, memory: 1GB, interface: lo}}\n")
            with (unittest.mock.patch.dict(os.environ, {"PATH": f"{self.folder}:{os.environ['PATH']}", "DASK_CONFIG": str(self.folder)}),
                  self.subTest(sbatch=sbatch)):
                ended = subprocess.run([sys.executable, "-c", "import sys, campaign_command as c; c.WAIT_FOR_JOBS = 0.2; sys.exit(c.main(sys.argv[1:]))",
                                        write_study(self.folder), "--out", self.folder / "out", "--slurm", "1"],
                                       stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=100, check=False)
                self.assertEqual((ended.returncode, ended.stderr), (1, told))
                self.assertFalse((self.folder / "out").exists())

    def test_a_run_that_is_refused_is_a_row(self):
        study = write_study(self.folder, change=lambda text: text.replace(
            "values: {value: [30, 60], unit: deg", "values: {value: [30, 600], unit: deg").replace("runs: {value: 8", "runs: {value: 6"))
        frame = slewlab.campaign(study, self.folder / "out", workers=0, progress=False)
        refused = frame[frame["crane.boom.angle"] == 600]
        self.assertTrue(len(refused) and (refused["outcome"] == "refused").all())
        self.assertIn("boom.angle", refused["reason"].iloc[0])
        self.assertFalse((frame[frame["crane.boom.angle"] == 30]["outcome"] == "refused").any())

    def test_what_is_wrong_in_a_study_is_told_at_its_line(self):
        for change, said in (
                (("crane.load.mass", "crane.load.mas"), r"study.yaml:8:5: .*load.mas.*'mass'"),
                (("unit: t,", "unit: m,"), r"study.yaml:8:5: .*the unit 'm'"),
                (("[10, 60]", "[60, 10]"), r"study.yaml:9:.*vary.0.range.*found 60, 10, expected a lowest value below the highest"),
                (("value: random", "value: grid"), r"vary.0.range.*expected values: a grid has one run for each"),
                (("key: seed", "key: crane.load.mass"), r"crane.load.mass a second time"),
                (("short.yaml", "long.yaml"), r"long.yaml")):
            with self.subTest(said=said), self.assertRaisesRegex(slewlab.InputError, said):
                load_study(write_study(self.folder, change=lambda text: text.replace(*change)))
        ended = subprocess.run([PROGRAM, "check", write_study(self.folder)], capture_output=True, text=True, check=False)
        self.assertEqual((ended.returncode, ended.stdout), (0, f"{self.folder / 'study.yaml'}: OK\n"), ended.stderr)

    def test_every_value_is_tried_and_told_at_its_place(self):
        def checked(*changes):
            text = STUDY.format(config=slewlab.config(), runs=2)
            for old, new in changes:
                self.assertIn(old, text)
                text = text.replace(old, new)
            study = write_study(self.folder, change=lambda _: text)
            ended = subprocess.run([PROGRAM, "check", study], capture_output=True, text=True, check=False)
            return ended.stderr.replace(str(self.folder) + "/", "").splitlines()

        shape = ("key: crane.boom.angle\n    values: {value: [30, 60], unit: deg", "key: controller.ramp.shape\n    values: {value: [s_curve, liner]")
        [said] = checked(shape)
        self.assertRegex(said, r"study.yaml:11:\d+: key 'controller.ramp.shape': found liner, expected .*linear")
        [said] = checked(("[30, 60]", "[20, 95]"))
        self.assertRegex(said, r"study.yaml:11:26: key 'crane.boom.angle': found 95 deg, expected a number from")
        [said] = checked(("[10, 60]", "[10, 6e12]"))
        self.assertRegex(said, r"study.yaml:9:\d+: key 'crane.load.mass': found 6e\+15 kg, which no machine has")
        [said] = checked(("file: short.yaml", "file: shrt.yaml"))
        self.assertRegex(said, r"study.yaml:2:\d+: key 'scenarios.0.file': found '.*shrt.yaml', which is not there, expected the name of a scenario's file")
        [said] = checked(("value: random", "value: randm"))
        self.assertRegex(said, r"study.yaml:4:\d+: key 'draw': found randm, expected grid or random or latin_hypercube")
        grid = checked(("value: random", "value: grid"), ("range: {value: [10, 60]", "values: {value: [10, 60]"), ("range: {value: [1, 1000]", "values: {value: [1, 1000]"))
        self.assertEqual([line.split(": ", 1)[1] for line in grid],
                         [f"key '{key}': found it beside a grid, expected no such key: a grid has one run for every combination of values" for key in ("runs", "seed")])

    def subject(self, name, text):
        config = slewlab.config()
        path = self.folder / name
        path.write_text("kind: campaign\n" + text.format(crane=config / "cranes" / "thesis.yaml", controller=config / "controllers" / "thesis.yaml",
                                                        soak=config / "soak" / "thesis.yaml"))
        return path

    def soak(self, runs):
        return self.subject("soak.yaml", "soak: {{settings: {soak}, crane: {crane}, controller: {controller}, faults: {{value: true, source: test}}}}\n"
                            f'runs: {{{{value: {runs}, unit: "-", source: test}}}}\nseed: {{{{value: 3, unit: "-", source: test}}}}\n')

    def test_a_soak_is_a_campaign_of_its_tasks(self):
        for workers in (0, 2):
            slewlab.campaign(self.soak(3), self.folder / str(workers), workers=workers, progress=False)
        self.assertEqual(self.bytes_of("2"), self.bytes_of("0"))
        frame = slewlab.campaign(self.soak(4), self.folder / "2", workers=0, progress=False)  # made longer
        self.assertEqual(list(frame["outcome"]), 4 * ["accepted"])
        self.assertTrue((frame["verdict.energy_balance"] == "pass").all())
        self.assertTrue((frame["measured.energy_balance"] < frame["limit.energy_balance"]).all())
        self.assertNotIn("verdict.memory", frame)
        # The tasks are those of `slewlab soak`, by its own journal.
        task_hours = 120 / 3600
        ended = subprocess.run([PROGRAM, "soak", "--hours", str(4 * task_hours), "--seed", "3", "--faults", "--out", self.folder / "soak"],
                               stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=100, check=False)
        self.assertEqual(ended.returncode, 0, ended.stdout + ended.stderr)
        tasks = {line["task"]: line for line in map(json.loads, (self.folder / "soak" / "journal.jsonl").read_text().splitlines()[1:])}
        for run, row in frame.iterrows():
            self.assertEqual((row["log_digest"], row["trips"], row["play_crossings"], row["description"]),
                             tuple(tasks[run][key] for key in ("log_digest", "trips", "play_crossings", "description")))
        again = subprocess.run([PROGRAM, *shlex.split(frame["command"][2])[1:], "--out", self.folder / "again"], stdin=subprocess.DEVNULL,
                               capture_output=True, text=True, timeout=100, check=False)
        self.assertEqual(again.returncode, 0, again.stderr)
        self.assertIn(f"digest {frame['log_digest'][2]}", again.stdout)

    def test_a_task_that_breaks_an_invariant_is_a_row_that_says_which(self):
        limits = self.folder / "strict.yaml"
        limits.write_text(f"include: {slewlab.config('soak/thesis.yaml')}\nlimits:\n  house_speed: {{value: 0.01, unit: rad/s, source: test}}\n")
        study = self.soak(1)
        study.write_text(study.read_text().replace(str(slewlab.config("soak/thesis.yaml")), str(limits)))
        row = slewlab.campaign(study, self.folder / "out", workers=0, progress=False).loc[0]
        self.assertEqual((row["outcome"], row["broken"], row["verdict.speed_limit"]), ("not accepted", "speed_limit", "fail"))
        self.assertIn("speed_limit at ", row["reason"])

    def test_withheld_cases_are_a_campaign_and_stay_sealed(self):
        study = self.subject("withheld.yaml", "withheld: {{crane: {crane}, controller: {controller}, rate: {{value: 50, unit: Hz, source: test}},\n"
                             "  sensors: {{value: none, source: test}}}}\n"
                             'runs: {{value: 2, unit: "-", source: test}}\nseed: {{value: 7, unit: "-", source: test}}\n')
        for workers in (1, 2):
            slewlab.campaign(study, self.folder / str(workers), workers=workers, progress=False)
        self.assertEqual(self.bytes_of("2"), self.bytes_of("1"))
        frame = slewlab.read_table(self.folder / "2" / "campaign.parquet")
        self.assertEqual(list(frame["case"]), ["case_0001", "case_0002"])
        # The set is that of the command of a row: made again beside it, nothing differs.
        words = [str(self.folder / "again") if word == "cases" else word for word in shlex.split(frame["command"][0])]
        ended = subprocess.run([PROGRAM, *words[1:]], stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=300, check=False)
        self.assertEqual(ended.returncode, 0, ended.stderr)
        made = {path.relative_to(self.folder / "again"): path.read_bytes() for path in (self.folder / "again").rglob("*") if path.is_file()}
        ours = {path.relative_to(self.folder / "2" / "cases"): path.read_bytes() for path in (self.folder / "2" / "cases").rglob("*") if path.is_file()}
        self.assertIn(Path("sealed/answers.json"), made)
        self.assertEqual(ours, made)
        # Nothing of the answers is in the table: neither kind nor law.
        answers = json.loads((self.folder / "again" / "sealed" / "answers.json").read_text())
        told = frame.to_csv()
        for case in answers["cases"]:
            for word in [f",{case['kind']},", *(effect["law"] for effect in case["effects"])]:
                self.assertNotIn(word, told)

    def test_options_and_parts_that_cannot_matter_are_refused(self):
        ended = subprocess.run([PROGRAM, "campaign", self.soak(1), "--controller", "true", "--out", self.folder / "out"], stdin=subprocess.DEVNULL,
                               capture_output=True, text=True, timeout=100, check=False)
        self.assertEqual(ended.returncode, 2)
        self.assertIn("--controller: found it beside a soak", ended.stderr)
        study = self.soak(1)
        study.write_text(study.read_text() + f"scenarios: [{{file: {slewlab.config('scenarios/thesis_slew.yaml')}}}]\n")
        with self.assertRaisesRegex(slewlab.InputError, "scenarios"):
            load_study(study)


class PageTest(unittest.TestCase):
    def test_separation_is_the_area_under_the_curve(self):
        self.assertEqual(campaign_page.separation([1.0, 2.0, 3.0, 4.0], [False, False, True, True]), 1.0)
        self.assertEqual(campaign_page.separation([1.0, 2.0, 3.0, 4.0], [True, False, False, True]), 0.5)
        self.assertEqual(campaign_page.separation([1.0, 1.0, 1.0, 1.0], [True, False, False, True]), 0.5)  # ties
        self.assertIsNone(campaign_page.separation([1.0, 2.0], [False, False]))

    def test_the_page_names_what_broke_and_the_value_that_tells_it_most(self):
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            study = write_study(folder, 6)
            limits = (slewlab.config() / "acceptance" / "thesis.yaml").read_text().replace("value: 5.5, unit: deg", "value: 0.2, unit: deg")
            (folder / "limits.yaml").write_text(limits)
            study.write_text(study.read_text().replace(str(slewlab.config()) + "/acceptance/thesis.yaml", "limits.yaml"))
            frame = slewlab.campaign(study, folder / "out", workers=0, progress=False)
            page = campaign_page.draw(frame)
            broken = int((frame["verdict.sidelead"] == "fail").sum())
            self.assertGreater(broken, 0)
            self.assertIn(f"{broken} of 6 runs broke it; limit 0.2 deg", page)
            self.assertIn("crane.boom.angle", page)
            section = page.split("<h2>sidelead</h2>")[1].split("<h2>")[0]
            self.assertEqual(section.count('class="fail"'), broken * len(frame.attrs["varied"]))


if __name__ == "__main__":
    unittest.main()
