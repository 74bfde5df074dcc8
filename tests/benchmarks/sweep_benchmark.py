"""How long so many runs of the demo's manoeuvre take in one Python process (docs/benchmarks.md).

    PYTHONPATH=build/release/python .venv/bin/python tests/benchmarks/sweep_benchmark.py [RUNS] [THREADS]

Each run draws another load, keeps every channel, and is measured. Wall clock, and processor time beside it: on a busy
machine the two differ.
"""

import sys
import time

import slewlab

runs = int(sys.argv[1]) if len(sys.argv) > 1 else 1000
threads = int(sys.argv[2]) if len(sys.argv) > 2 else 2
scenario = slewlab.Scenario(slewlab.config("scenarios/thesis_slew.yaml"))
wall, processor = time.perf_counter(), time.process_time()
table = slewlab.monte_carlo(scenario, {"crane.load.mass": lambda random: f"{random.uniform(10, 40)} t"}, runs, seed=1, threads=threads)
wall, processor = time.perf_counter() - wall, time.process_time() - processor
print(f"{len(table)} runs of {scenario.duration:g} s on {threads} thread(s): {wall:.1f} s wall clock, {processor:.1f} s of processor time")
