"""Runs a study: scenarios over a grid, a random or a Latin-hypercube draw of values; one table with a row per run, and a page
that shows which values break which acceptance check. docs/campaign.md

    slewlab campaign STUDY.yaml [--out DIR] [--workers N]

Ended early by whatever, the same command goes on where it was.
"""

import argparse
import contextlib
import importlib.util
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from arguments import ArgumentParser, output_folder, shell_command
from campaign_page import write_page
from run_log import built_module

INTERRUPTED = 130  # as a shell has it: 128 + SIGINT
WAIT_FOR_JOBS = 30  # s between two looks at Slurm's queue


class Unavailable(Exception):
    pass


class WrongAddress(Exception):
    pass


@contextlib.contextmanager
def cluster(options):
    """A distributed.Client, or None for processes of this machine."""
    if options.dask is None and options.slurm is None:
        yield None
        return
    if importlib.util.find_spec("distributed") is None:
        raise Unavailable("Dask is not installed here: pip install distributed")
    from distributed import Client

    if options.dask is not None:
        try:
            found = Client(options.dask, timeout=30)
        except (ValueError, OverflowError) as error:
            raise WrongAddress(f"--dask: found '{options.dask}' ({error}), expected the address of Dask's scheduler, tcp://HOST:PORT") from None
        with found as client:
            yield client
        return
    if importlib.util.find_spec("dask_jobqueue") is None:
        raise Unavailable("Slurm's jobs are started by dask-jobqueue, which is not installed here: pip install dask-jobqueue")
    if shutil.which("sbatch") is None:
        raise Unavailable("there is no sbatch here: --slurm is for a machine from which Slurm takes jobs")
    from dask_jobqueue import SLURMCluster

    try:
        jobs = SLURMCluster()
    except ValueError as error:
        raise Unavailable(f"{str(error).splitlines()[0]} That stands under jobqueue: slurm: in ~/.config/dask/jobqueue.yaml") from error
    with jobs, Client(jobs) as client:
        check_that_slurm_takes(jobs.job_script())
        jobs.scale(jobs=options.slurm)
        print(f"waiting for the first of {options.slurm} jobs of Slurm", file=sys.stderr)
        wait_for_first_job(client, jobs)
        yield client


def check_that_slurm_takes(script):
    """dask-jobqueue logs a job that Slurm refuses, and waits for it without end."""
    with tempfile.NamedTemporaryFile("w", suffix=".sh") as file:
        file.write(script)
        file.flush()
        asked = subprocess.run(["sbatch", "--test-only", file.name], stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False)
    if asked.returncode != 0:
        raise Unavailable(f"Slurm takes no such job: {'; '.join(asked.stderr.splitlines())}. "
                          "What a job asks for stands under jobqueue: slurm: in ~/.config/dask/jobqueue.yaml")


def wait_for_first_job(client, jobs):
    """Until a job is a worker; a queue may be long, so only an end of all jobs ends the wait."""
    from distributed import TimeoutError as NoWorker

    while True:
        try:
            client.wait_for_workers(1, timeout=WAIT_FOR_JOBS)
            return
        except NoWorker:
            submitted = [job.job_id for job in jobs.workers.values() if getattr(job, "job_id", None)]
            queue = subprocess.run(["squeue", "--noheader", "--jobs", ",".join(submitted), "--format", "job %i: %T %r"],
                                   stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False)
            states = [line for line in queue.stdout.splitlines() if line.strip()]
            if not submitted or not states:
                raise Unavailable(f"every job of Slurm ended ({', '.join(submitted) or 'none was taken'}) and none came to work; what it printed is in its "
                                  "log-directory. Workers need the package: export PYTHONPATH in job-script-prologue, docs/campaign.md") from None
            print("no job works yet; " + "; ".join(states), file=sys.stderr)


def at_least(lowest, text):
    if not text.isdecimal() or int(text) < lowest:
        raise argparse.ArgumentTypeError(f"found {text}, expected a whole number from {lowest} on")
    return int(text)


def count(text):
    return at_least(1, text)


def count_or_none(text):
    return at_least(0, text)


def change(text):
    key, equals, value = text.partition("=")
    if not (key and equals):
        raise argparse.ArgumentTypeError(f"found {text}, expected KEY=VALUE")
    return key, value


def parse(arguments):
    parser = ArgumentParser(prog="slewlab campaign", description="Run a study and judge every run (docs/campaign.md).")
    parser.add_argument("study", metavar="STUDY.yaml", help="what is run: kind: campaign")
    parser.add_argument("--out", metavar="DIR", type=output_folder, help="folder for journal, table and page (runs/campaign_<study>)")
    parser.add_argument("--controller", metavar="CMD", type=shell_command, help="shell command of your own controller, as of slewlab run; runs over LCM")
    where = parser.add_mutually_exclusive_group()
    where.add_argument("--workers", metavar="N", type=count_or_none, help="processes of this machine (as many as it has processors); 0: in the command's own")
    where.add_argument("--dask", metavar="ADDRESS", help="on a cluster: address of Dask's scheduler, tcp://HOST:PORT")
    where.add_argument("--slurm", metavar="N", type=count, help="on a cluster: N jobs of Slurm, by dask-jobqueue and its jobqueue.yaml")
    parser.add_argument("--set", dest="changes", metavar="KEY=VALUE", type=change, action="append", default=[], help="over the study: runs=10")
    parser.add_argument("--page", action="store_true", help="draw the page of a table that is there already, and run nothing")
    return parser.parse_args(arguments)


def told(frame, out):
    counts = frame["outcome"].value_counts()
    print(f"{len(frame)} runs: " + ", ".join(f"{number} {outcome}" for outcome, number in counts.items()))
    broken = frame["broken"].str.split(", ").explode()
    for check, number in broken[broken != ""].value_counts().items():
        print(f"  {check}: broken by {number}")
    for run, row in frame[frame["outcome"].isin(["refused", "failed"])].head(3).iterrows():
        print(f"  run {run} {row['outcome']}: {row['reason'].splitlines()[0]}")
    print(f"table: {out / 'campaign.parquet'}   page: {out / 'campaign.html'}")
    return 0 if frame["outcome"].isin(["accepted", "complete"]).all() else 1


def main(arguments):
    options = parse(arguments)
    slewlab = built_module("slewlab", "the package slewlab is")
    from slewlab import campaigns
    from slewlab.study import load_study

    out = options.out or Path("runs") / f"campaign_{Path(options.study).stem}"
    campaigns.stop_on_termination()
    try:
        if options.page:
            frame = slewlab.read_table(out / campaigns.TABLE)
        else:
            study = load_study(options.study, dict(options.changes))
            if options.controller and (study.soak or study.withheld):
                print("--controller: found it beside a soak or withheld cases, expected it beside scenarios: those have their study's own", file=sys.stderr)
                return 2
            with cluster(options) as client:
                frame = slewlab.campaign(study, out, controller=options.controller, workers=options.workers, client=client)
        write_page(frame, out / campaigns.PAGE)
    except (slewlab.InputError, slewlab.CampaignMismatch, slewlab.JournalDamaged, WrongAddress) as error:
        print(error, file=sys.stderr)
        return 2
    except (OSError, Unavailable) as error:
        print(f"slewlab campaign: {error}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print(f"\ninterrupted; what is done stands in {out / campaigns.JOURNAL}, and the same command goes on from there", file=sys.stderr)
        return INTERRUPTED
    return told(frame, out)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
