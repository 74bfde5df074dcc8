"""The fuzz targets of the Python side: measured data with its map (`slewlab import`), and a log (`slewlab report` and
`export`).

    python_fuzz.py import|run_log                       every file of the corpus, and its beginnings: for the suite
    python_fuzz.py import|run_log --seconds S ...       seeded mutations of it for S seconds: for tools/fuzz

A target gets bytes and must answer or refuse as its documentation says; another exception, a log half written, or memory
out of proportion is a finding. Mutations are guided by coverage, as libFuzzer's are: an input that reaches a line of our
own modules which none has reached before joins the corpus. An input is written down before it is tried, so that it is
there after a crash of the interpreter, too.
"""

import argparse
import contextlib
import hashlib
import io
import random
import resource
import signal
import sys
import tempfile
import time
import traceback
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[2]
CORPUS = REPOSITORY / "tests" / "fuzz" / "corpus"
sys.path.insert(0, str(REPOSITORY / "tools" / "python"))

import import_data  # noqa: E402
from run_log import LogProblem, read_run_log  # noqa: E402

MOST_MEMORY = 4 << 30   # [bytes] of address space
LONGEST = 20            # [s] that one input may take
SPLIT = b"\n%%%%\n"     # between a map and its data
WORDS = (b",", b";", b"\n", b"\t", b'"', b"nan", b"inf", b"-1", b"1e308", b"1e-308", b"", b"0", b"99999999999999999999",
         b"true", b"2026-11-21T02:00:00", b": ", b"- ", b"{", b"}", b"[", b"unit: ", b"column: ", b"\x00", b"\xff",
         b"resample: mean\n", b"resample: linear\n", b"sign: -1", b"derive: central_difference", b"%", b"rpm", b"deg")


def try_import(data, folder):
    text, _, table = data.partition(SPLIT)
    (folder / "map.yaml").write_bytes(text)
    (folder / "data.csv").write_bytes(table)
    out = folder / "out.lcmlog"
    out.unlink(missing_ok=True)
    said, complaints = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(said), contextlib.redirect_stderr(complaints):
        code = import_data.main(["--map", str(folder / "map.yaml"), str(folder / "data.csv"), "--out", str(out)])
    assert code in (0, 1, 2), f"exit code {code}"
    assert out.is_file() == (code == 0), "a log appears where, and only where, the import succeeds"
    assert sorted(p.name for p in folder.iterdir() if p != out) == ["data.csv", "map.yaml"], "nothing half written stays"
    assert bool(complaints.getvalue().strip()) == (code != 0), "a refusal says why"
    if code == 0:
        log = read_run_log(out)
        assert len(log.channel("ENCODER")) == len(log.channel("TORQUE")), "as many TORQUE as ENCODER"


def try_run_log(data, folder):
    path = folder / "run.lcmlog"
    path.write_bytes(data)
    try:
        log = read_run_log(path)
    except LogProblem:
        return
    for name in log.tables:
        assert len(log.channel(name)) > 0, "a channel that is there holds messages"


TARGETS = {"import": try_import, "run_log": try_run_log}


class Coverage:
    """Lines of our own modules that were reached."""

    def __init__(self):
        self.lines, self.fresh = set(), False
        self.own = {str(p) for p in (REPOSITORY / "tools" / "python").glob("*.py")}

    def trace(self, frame, event, _):
        if frame.f_code.co_filename not in self.own:
            return None
        if event == "line":
            at = (frame.f_code.co_filename, frame.f_lineno)
            if at not in self.lines:
                self.lines.add(at)
                self.fresh = True
        return self.trace

    def run(self, target, data, folder):
        """Whether the input reached something new."""
        self.fresh = False
        sys.settrace(self.trace)
        try:
            target(data, folder)
        finally:
            sys.settrace(None)
        return self.fresh


def mutated(data, corpus, draw):
    data = bytearray(data)
    for _ in range(draw.choice((1, 1, 2, 3, 5))):
        at = draw.randrange(len(data) + 1)
        kind = draw.randrange(7)
        if kind == 0 and data:
            data[min(at, len(data) - 1)] = draw.randrange(256)
        elif kind == 1:
            data[at:at] = draw.choice(WORDS)
        elif kind == 2:
            del data[at:at + draw.choice((1, 2, 4, 16, 64, 256))]
        elif kind == 3:
            length = draw.choice((1, 4, 16, 64))
            start = draw.randrange(len(data) + 1)
            data[at:at] = data[start:start + length]
        elif kind == 4:
            other = draw.choice(corpus)
            start = draw.randrange(len(other) + 1)
            data[at:at + draw.choice((0, 8, 64))] = other[start:start + draw.choice((4, 16, 64, 256))]
        elif kind == 5 and data:
            at = min(at, len(data) - 1)
            data[at] ^= 1 << draw.randrange(8)
        else:
            start, end = at, at
            while start > 0 and chr(data[start - 1]).isalnum():
                start -= 1
            while end < len(data) and chr(data[end]).isalnum():
                end += 1
            data[start:end] = draw.choice(WORDS)
    return bytes(data[:1 << 16])


def beginnings(data, count=16):
    yield data
    for k in range(count if len(data) > count else 0):
        yield data[:len(data) * k // count]


def out_of_time(*_):
    raise TimeoutError(f"took more than {LONGEST} s")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("target", choices=TARGETS)
    parser.add_argument("--seconds", type=float)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--found", type=Path, help="folder for the input that fails")
    parser.add_argument("--grown", type=Path, help="folder for inputs that reach new lines, and to go on from")
    options = parser.parse_args()
    target = TARGETS[options.target]
    seeds = [p.read_bytes() for p in sorted((CORPUS / options.target).iterdir())]
    if options.grown:
        seeds += [p.read_bytes() for p in sorted(options.grown.iterdir())]
    assert seeds, "no corpus"
    if options.seconds:  # the suite's sanitizers need more address space than this
        resource.setrlimit(resource.RLIMIT_AS, (MOST_MEMORY, resource.RLIM_INFINITY))
    read_run_log(CORPUS / "run_log" / "whole")  # where the reader is missing every log would be refused
    signal.signal(signal.SIGALRM, out_of_time)
    coverage, executions = Coverage(), 0

    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        current = (options.found or folder.parent) / f"{options.target}-current-{folder.name}"

        def attempt(data):
            nonlocal executions
            executions += 1
            current.write_bytes(data)
            signal.alarm(LONGEST)
            try:
                return coverage.run(target, data, folder)
            except BaseException:
                signal.alarm(0)
                traceback.print_exc()
                keep = current.with_name(f"{options.target}-crash-{hashlib.sha1(data).hexdigest()}")
                current.replace(keep)
                print(f"failed with the input {keep}", file=sys.stderr)
                raise SystemExit(1) from None
            finally:
                signal.alarm(0)

        for seed in seeds:
            for data in beginnings(seed):
                attempt(data)
        if options.seconds:
            draw = random.Random(options.seed)
            corpus = list(seeds)
            end = time.monotonic() + options.seconds
            while time.monotonic() < end:
                data = mutated(draw.choice(corpus), corpus, draw)
                if attempt(data):
                    corpus.append(data)
                    if options.grown:
                        (options.grown / hashlib.sha1(data).hexdigest()).write_bytes(data)
        current.unlink()
    print(f"executions: {executions}\nlines: {len(coverage.lines)}")


if __name__ == "__main__":
    main()
