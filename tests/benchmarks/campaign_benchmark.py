"""What a campaign adds to runs of about a second: the campaign with one worker, and the same runs with the same verdicts in a
bare loop, by turns. Processor time of this process and its children.

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


def main(runs=20, rounds=3):
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "long.yaml").write_text(f"include: {slewlab.config()}/scenarios/thesis_slew.yaml\n"
                                          f"duration: {{value: {DURATION}, unit: s, source: benchmark}}\n")
        (folder / "study.yaml").write_text(STUDY.format(config=slewlab.config(), runs=runs))
        study = load_study(folder / "study.yaml")
        for number in range(rounds):
            begin = processor_time()
            slewlab.campaign(study, folder / str(number), workers=1, progress=False)
            between = processor_time()
            bare(study)
            campaign, loop = between - begin, processor_time() - between
            print(f"{runs} runs of {loop / runs:.2f} s: campaign {campaign:.2f} s, bare loop {loop:.2f} s, {100 * (campaign / loop - 1):+.1f} %", flush=True)


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
