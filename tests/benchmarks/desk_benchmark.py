"""What the desk costs (docs/benchmarks.md, The desk); called by tools/measure-desk.

    desk_benchmark.py wake-up SECONDS ROUNDS   wake-up latency of a plant at 1 kHz against the wall clock, by turns alone and with a desk, its
                                               page in a browser, a bridge and a viewer attached
    desk_benchmark.py frames SECONDS           pictures per second of a page that follows a run of 1 kHz with 30 signals and more
"""

import contextlib
import json
import re
import statistics
import subprocess
import sys
import tempfile
import threading
from pathlib import Path

from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect

REPOSITORY = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(REPOSITORY / "tests" / "tools" / "python"), str(REPOSITORY / "tools" / "python")]
from browser import Browser, until  # noqa: E402 the path is set above

SLEWLAB = REPOSITORY / "build" / "release" / "bin" / "slewlab"
CONFIG = REPOSITORY / "config"
HEIGHTS = (900, 2200)  # [px] of a usual window, and of one in which every chart is seen
EVERY_MILLISECOND = ("controller_period", "telemetry.sensors_period", "telemetry.truth_period")


@contextlib.contextmanager
def program(*arguments):
    """(process, its first line); it is asked to end behind the block."""
    process = subprocess.Popen([SLEWLAB, *map(str, arguments)], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, text=True)
    try:
        yield process, process.stdout.readline()
    finally:
        process.terminate()
        process.communicate()


@contextlib.contextmanager
def run(scenario, folder, duration):
    """A run against the wall clock that says everything every millisecond; (process, address of its bus)."""
    changes = [word for key in EVERY_MILLISECOND for word in ("--set", f"{key}=1 ms")]
    with program("run", CONFIG / "scenarios" / scenario, "--realtime", "--progress", "none", "--out", folder, "--set",
                 f"duration={duration} s", *changes) as (process, said):
        yield process, re.search(r"bus (\S+)", said).group(1)


def resident(process):
    """[MB] that the process has held at most."""
    status = Path(f"/proc/{process.pid}/status").read_text()
    return int(re.search(r"VmHWM:\s+(\d+)", status).group(1)) / 1024


def view(address, end):
    """Hears every channel of a bridge, as Foxglove does."""
    with contextlib.suppress(ConnectionClosed), connect(address, subprotocols=["foxglove.sdk.v1"], max_size=None) as viewer:
        while not end.is_set():
            with contextlib.suppress(TimeoutError):
                told = viewer.recv(0.2)
                if isinstance(told, str) and json.loads(told)["op"] == "advertise":
                    subscriptions = [{"id": each["id"], "channelId": each["id"]} for each in json.loads(told)["channels"]]
                    viewer.send(json.dumps({"op": "subscribe", "subscriptions": subscriptions}))


@contextlib.contextmanager
def attached(bus, browser):
    """Everything that may look on; the processes of which the memory is told."""
    with program("desk", "--bus", bus) as (desk, said), program("bridge", "--foxglove", "--port", "0", "--bus", bus) as (bridge, address):
        page, end = browser.open(re.search(r"http://\S+", said).group(0)), threading.Event()
        viewer = threading.Thread(target=view, args=(re.search(r"ws://\S+", address).group(0), end))
        viewer.start()
        try:
            yield desk, bridge
        finally:
            end.set()
            viewer.join()
            browser.close(page)


def wake_up(seconds, rounds):
    found = {False: [], True: []}
    print("plant at 1 kHz     median      99 %    99.9 %   largest [us]   missed   memory of desk and bridge [MB]")
    with tempfile.TemporaryDirectory() as name, Browser() as browser:
        for number in range(2 * rounds):
            is_watched, memory, folder = number % 2 == 1, "", Path(name) / str(number)
            with run("thesis_slew.yaml", folder, seconds) as (process, bus):
                if is_watched:
                    with attached(bus, browser) as watching:
                        process.wait()
                        memory = ", ".join(f"{resident(each):.0f}" for each in watching)
                process.wait()
            timing = json.loads((folder / "summary.json").read_text())["run"]["realtime"]
            latency = timing["wakeup_latency"]
            found[is_watched].append(latency["p99_9"])
            print(f"{'watched' if is_watched else 'alone':12}" + "".join(f"{latency[key]:10.1f}" for key in ("p50", "p99", "p99_9", "largest"))
                  + f"{timing['missed_deadlines']:14d}   {memory}", flush=True)
            print(f"  {timing['permissions']}", file=sys.stderr)
    alone, watched = (statistics.median(found[each]) for each in (False, True))
    print(f"99.9 %, median of {rounds} rounds of {seconds} s: alone {alone:.1f} us, watched {watched:.1f} us, ratio {watched / alone:.2f} (asked: at most 1.05)")


def frames(seconds):
    crane = CONFIG / "cranes" / "offshore_900t.yaml"  # four motor groups: more signals
    with tempfile.TemporaryDirectory() as name, Browser() as browser, run("offshore_900t_slew.yaml", Path(name) / "run", 2 * seconds + 120) as (_, bus):
        until((Path(name) / "run" / "run.lcmlog.partial").exists, "the run begins")
        with program("desk", "--bus", bus, "--run", Path(name) / "run", "--nominal", crane) as (_, said):
            address = re.search(r"http://\S+", said).group(0)
            for height in HEIGHTS:
                page = browser.open(address, height=height)
                page.until("desk.following && desk.signals && desk.signals[0].length >= 30 && desk.at > 20")
                page.value("(() => { window.screens = 0; const count = () => { ++window.screens; requestAnimationFrame(count); }; count(); })()")
                signals, drawn, pictures, screens = page.value(f"""(async () => {{
                    const begin = performance.now(), drawn = desk.drawn, screens = window.screens;
                    await new Promise((done) => setTimeout(done, {1000 * seconds}));
                    const time = (performance.now() - begin) / 1000, seen = desk.charts.filter((chart) => chart.isSeen && !chart.description.isSpectrum);
                    return [desk.signals[0].length, seen.flatMap((chart) => chart.lines).length, (desk.drawn - drawn) / time, (window.screens - screens) / time];
                }})()""")
                browser.close(page)
                print(f"{signals} signals of a run at 1 kHz, window of 20 s, 1400 x {height}, in which {drawn} are drawn: {pictures:.1f} pictures a second "
                      f"(asked: at least 30); the browser draws {screens:.1f} at most", flush=True)


if __name__ == "__main__":
    what, *numbers = sys.argv[1:]
    {"wake-up": wake_up, "frames": frames}[what](*map(int, numbers))
