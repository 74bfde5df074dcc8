"""What a campaign adds to runs of about a second: the campaign with one worker, and the same runs with the same verdicts in a
bare loop, by turns. Processor time of this process and its children; what the campaign takes before its first run is told apart.

    PYTHONPATH=build/release/python .venv/bin/python tests/benchmarks/campaign_benchmark.py [RUNS] [ROUNDS]
"""

import resource
import sys
import tempfile
from pathlib import Path

import slewlab
from slewlab import campaigns
from slewlab.study import load_study

STUDY = """kind: campaign
scenarios: [{{file: long.yaml}}]
limits: {config}/acceptance/thesis.yaml
draw: {{value: latin_hypercube, source: benchmark}}
runs: {{value: {runs}, unit: "-", source: benchmark}}
seed: {{value: 1, unit: "-", source: benchmark}}
vary: [{{key: crane.load.mass, range: {{value: [10, 40], unit: t, source: benchmark}}}}]
"""
DURATION = 900  # [s] simulated: about a second of computing


def processor_time():
    return sum(sum(resource.getrusage(whose)[:2]) for whose in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))


def bare(study):
    for case in study.cases():
        scenario = slewlab.Scenario(case.scenario, dict(case.changes))
        with tempfile.TemporaryDirectory() as folder:
            log = Path(folder) / "run.lcmlog"
            slewlab.measures(scenario.run(channels=campaigns.MEASURED, log=log))
            slewlab._core.log_digest(log)
            scenario._core.judge(log, Path(study.limits))


def write(folder, runs, duration):
    (folder / "long.yaml").write_text(f"include: {slewlab.config()}/scenarios/thesis_slew.yaml\n"
                                      f"duration: {{value: {duration}, unit: s, source: benchmark}}\n")
    (folder / "study.yaml").write_text(STUDY.format(config=slewlab.config(), runs=runs))
    return load_study(folder / "study.yaml")


def main(runs=20, rounds=3):
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        write(folder, 2, 1)
        for number in range(rounds):
            times = [processor_time()]
            slewlab.campaign(write(folder, 2, 1), folder / f"start_{number}", workers=1, progress=False)
            times.append(processor_time())
            study = write(folder, runs, DURATION)
            slewlab.campaign(study, folder / str(number), workers=1, progress=False)
            times.append(processor_time())
            bare(study)
            times.append(processor_time())
            start, campaign, loop = (after - before for before, after in zip(times, times[1:]))
            print(f"{runs} runs of {loop / runs:.2f} s: bare loop {loop:.2f} s, campaign {campaign:.2f} s ({100 * (campaign / loop - 1):+.1f} %), "
                  f"of which its start is {start:.2f} s; a run {100 * ((campaign - start) / loop - 1):+.1f} %", flush=True)


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
