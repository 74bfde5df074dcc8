"""Serves the page and its data on one port: the page's files by HTTP, everything else by a WebSocket (docs/desk.md).

A page asks for a window of time and gets the envelopes of its charts, the crane's pose and the state at its cursor in one answer;
it asks again when that has come, one at a time. So a slow page is sent less, a closed one nothing, and what is sent is bounded by
its pixels.
"""

import asyncio
import contextlib
import json
import math
import time
from http import HTTPStatus
from pathlib import Path
from urllib.parse import urlsplit

import numpy as np
from websockets.asyncio.server import serve
from websockets.datastructures import Headers
from websockets.exceptions import ConnectionClosed
from websockets.http11 import Response

from desk import charts
from desk.access import Joystick

PAGE = Path(__file__).resolve().parent / "page"
FILES = {  # address: (file, type)
    "/": ("index.html", "text/html; charset=utf-8"),
    "/desk.css": ("desk.css", "text/css"),
    "/desk.js": ("desk.js", "text/javascript"),
    "/crane.js": ("crane.js", "text/javascript"),
    "/charts.js": ("charts.js", "text/javascript"),
    "/steering.js": ("steering.js", "text/javascript"),
    "/vendor/uPlot.iife.min.js": ("vendor/uPlot.iife.min.js", "text/javascript"),
    "/vendor/uPlot.min.css": ("vendor/uPlot.min.css", "text/css"),
}
# The page may run its own files and talk to where it came from; nothing else.
POLICY = "default-src 'none'; script-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' data:; connect-src 'self'; frame-ancestors 'none'; base-uri 'none'"
POLL = 0.02          # [s] between two looks at a growing log
UNANSWERED = 2.0     # [s] of wall clock after which it is said that the controller answers no more
STILL = 0.25         # [s] after which a page that waits for something new is answered all the same
HELLO_PATIENCE = 10  # [s] until a connection has to say who it is
GONE = "the page that had the joystick was closed or is out of sight"
CONTROLLER_ENDED = "the controller ended before its time"  # begins run.json's words for it (tools/commands/run_command.cpp)
MOST_PIXELS = 4096
MOST_SIGNALS = 200
LARGEST_REQUEST = 1 << 16  # [bytes]
SPECTRUM_SEGMENTS = 4  # lengths of a spectrum that tells the machine's frequencies apart (run_numbers.Band), before the cursor: it is of these
LOWEST, HIGHEST = 0.2, 2.3  # of the band's ends, that are shown of it: the load's swing, and twice the highest mode that is looked for


def number(value, lowest, highest):
    """A finite number from a page, within bounds; ValueError where it is none."""
    value = float(value)
    if not math.isfinite(value):
        raise ValueError("not a finite number")
    return min(highest, max(lowest, value))


class Desk:
    """The sources of a page, its pages, and the run that they steer, where there is one."""

    def __init__(self, sources, access, run=None, watch=None):
        """`watch`: makes the Gap of a source, where a nominal machine is given."""
        self.sources, self.access, self.run, self.watch, self.gap, self.diagnosis, self.recorder = sources, access, run, watch, None, None, None
        self.joystick, self.pages = Joystick(), set()
        self.news, self.restarting = asyncio.Condition(), False
        self.began, self.heard = time.monotonic(), {}  # [s] of wall clock; by source: when there was something new
        self.answered = {}  # by source: (which ENCODER was answered last, [s] of wall clock until when there was nothing to complain of)

    @property
    def is_live(self):
        return any(source.is_live for source in self.sources)

    def silence(self, source):
        """[s] of wall clock since there was something new of a live source; None of a recorded one."""
        return time.monotonic() - self.heard.get(source, self.began) if source.is_live else None

    def poll(self, source):
        """Takes what is new of a source; whether there was anything."""
        had_news, now = source.poll(), time.monotonic()
        if had_news:
            self.heard[source] = now
        if source.is_live and (source.incoming.answered >= source.incoming.asked or source.incoming.answered != self.answered.get(source, (None,))[0]):
            self.answered[source] = source.incoming.answered, now
        return had_news

    def is_over(self, source):
        """Whether the run of a live source has ended, by what stands beside its log, and nothing of it comes any more."""
        return source.facts.get("end", "under way") != "under way" and self.silence(source) >= UNANSWERED

    def end_recording(self, had_news):
        """With the run's end, when all of it was heard."""
        if self.recorder is not None and not had_news and (self.run.ended if self.run is not None else self.is_over(self.sources[0])):
            self.recorder.stop()

    def trouble(self, source):
        """What to say of a controller that ended by itself, or that answers no more; nothing of any other."""
        end = source.facts.get("end", "under way")
        if end.startswith(CONTROLLER_ENDED):
            return f"{end[0].upper()}{end[1:]}."
        if not source.is_live or end != "under way" or time.monotonic() - self.answered.get(source, (None, self.began))[1] < UNANSWERED:
            return ""
        incoming, is_silent = source.incoming, self.silence(source) >= UNANSWERED
        if is_silent and source.is_repeated:
            return ""  # a plant that waits asks again: this one has ended
        since = "not answered at all" if incoming.answered < 0 else f"answered nothing since {incoming.answered_time * 1e-9:.3f} s"
        waits = ""
        if incoming.asked == incoming.answered + 1:
            waits = " The plant waits for it, or has ended." if is_silent and self.run is None else " The plant waits for it: the run stands still."
        return f"The controller has {since}.{waits}"

    async def follow(self):
        """Takes what is new of growing sources, and lets go of a joystick that nobody holds any more."""
        if self.watch is not None:
            self.gap = await self.watch(self.sources[0])
        next_look = time.monotonic()
        while True:
            late, next_look, had_news = time.monotonic() - next_look, time.monotonic() + POLL, False
            if late > self.joystick.patience:  # what pages said meanwhile is of long ago
                self.joystick.give_back(self.joystick.holder, f"the desk stood still for {late:.1f} s")
            for source in self.sources:
                had_news = self.poll(source) or had_news
            if self.run is not None and not self.restarting:
                self.joystick.expire(time.monotonic())
                if self.run.ended:
                    self.joystick.give_back(self.joystick.holder)
                self.run.operate(self.joystick)
            if not self.restarting:
                self.end_recording(had_news)
            if had_news:
                async with self.news:
                    self.news.notify_all()
            await asyncio.sleep(next_look - time.monotonic())  # at once where taking it took longer

    async def start_anew(self, play_compensation):
        """The run ends and another begins from rest: what is recorded from here stands in a folder of its own."""
        if self.restarting:
            return
        self.restarting = True
        try:
            await self.run.end()
            if self.gap is not None:
                await self.gap.end()
            source = await self.run.start(play_compensation)
            self.recorder.attach(source)
            if self.watch is not None:
                self.gap = await self.watch(source)
            self.sources[0] = source  # followed from now on, when all hear it
        finally:
            self.restarting = False

    def answer_http(self, connection, request):
        """websockets' process_request: files by HTTP, None for a WebSocket that is let in."""
        origins, hosts = (request.headers.get_all(name) for name in ("Origin", "Host"))
        if len(origins) > 1 or len(hosts) > 1:
            return respond(HTTPStatus.BAD_REQUEST, b"one Host and one Origin at most are expected\n", "text/plain")
        try:
            reason, path = self.access.refuses(next(iter(origins), None), next(iter(hosts), None)), urlsplit(request.path).path
        except ValueError:
            return respond(HTTPStatus.BAD_REQUEST, b"no address can be read from Host or path\n", "text/plain")
        if reason:
            return respond(HTTPStatus.FORBIDDEN, reason.encode(), "text/plain; charset=utf-8")
        if path == "/socket":
            return None
        if path not in FILES:
            return respond(HTTPStatus.NOT_FOUND, b"there is no such page\n", "text/plain")
        name, kind = FILES[path]
        return respond(HTTPStatus.OK, (PAGE / name).read_bytes(), kind)

    async def serve_page(self, socket):
        page = Page(self, socket)
        try:
            if await page.greet():
                self.pages.add(page)
                await page.listen()
        except ConnectionClosed:
            pass
        finally:
            self.pages.discard(page)
            self.joystick.give_back(page, GONE)

    def start(self, host, port):
        return serve(self.serve_page, host, port, process_request=self.answer_http, max_size=LARGEST_REQUEST,
                     compression=None, ping_interval=5, ping_timeout=10)


def respond(status, body, kind):
    headers = Headers([("Content-Type", kind), ("Content-Length", str(len(body))), ("Cache-Control", "no-store"),
                       ("Content-Security-Policy", POLICY), ("X-Content-Type-Options", "nosniff"),
                       ("Referrer-Policy", "no-referrer"), ("Connection", "close")])
    return Response(status.value, status.phrase, headers, body)


class Page:
    """One connection."""

    def __init__(self, desk, socket):
        self.desk, self.socket, self.may_steer, self.seen = desk, socket, False, -1.0

    async def greet(self):
        """Whether the page may watch. Its first word is {"token": ...}."""
        try:
            token = json.loads(await asyncio.wait_for(self.socket.recv(), HELLO_PATIENCE)).get("token")
        except (TimeoutError, ValueError, AttributeError):
            await self.socket.close(4400, "the first word has to be the token")
            return False
        may_watch, self.may_steer = self.desk.access.may(token)
        if not may_watch:
            await self.socket.close(4401, "wrong token: this desk is watched with the address that it printed")
            return False
        return True

    async def listen(self):
        handlers = {"view": self.view, "layout": self.layout, "spectrum": self.spectrum}
        async for text in self.socket:
            try:
                request = json.loads(text)
                kind = request.get("type")
                if kind in handlers:
                    await handlers[kind](request)
                elif kind == "diagnose":
                    await self.diagnose()
                elif kind == "record":
                    await self.record(bool(request["on"]))
                elif self.desk.run is not None:
                    await self.steer(kind, request)
            except (ValueError, TypeError, KeyError, AttributeError, OverflowError) as error:
                await self.say({"type": "refused", "of": kind_of(text), "why": f"not understood: {error}"})

    async def say(self, message):
        await self.socket.send(json.dumps(message))

    async def layout(self, _):
        """What there is to draw; asked for again until a live run's facts and signals are there."""
        sources = [{"name": source.name, "facts": page_facts(source.facts), "remarks": source.remarks,
                    "charts": charts.charts(source.facts, source.store),
                    "silence": self.desk.silence(source), "first": finite(source.store.first), "last": finite(source.store.last)}
                   for source in self.desk.sources]
        await self.say({"type": "layout", "sources": sources, "live": self.desk.is_live,
                        "steered": self.desk.run is not None, "may_steer": self.may_steer})

    async def view(self, request):
        """{"from", "to", "at" [s], "pixels", "signals": [[name, ...] per source]}; "live": the window is "to" - "from" long and
        ends at the newest time, or begins with the run."""
        sources = self.desk.sources
        live = bool(request.get("live"))
        if live:
            await self.wait_for_news()
        newest = max(source.store.last for source in sources)
        if not np.isfinite(newest):
            await self.say({"type": "nothing yet", **self.run_state()})
            return
        span = number(request["to"], -1e9, 1e9) - number(request["from"], -1e9, 1e9)
        oldest = min(source.store.first for source in sources)
        first = max(oldest, newest - span) if live else number(request["from"], -1e9, 1e9)
        last = first + max(span, 1e-6)
        at = newest if live else number(request.get("at", last), -1e9, 1e9)
        pixels = int(number(request["pixels"], 16, MOST_PIXELS))
        header, blocks = {"type": "view", "from": first, "to": last, "at": at, "bins": pixels, "newest": newest, "signals": [],
                          "values": [], "holes": [], "sources": [], **self.run_state()}, []
        for source, signals in zip(sources, request["signals"]):
            found = charts.envelopes(source.store, signals[:MOST_SIGNALS], first, last, pixels)
            names = [signal for signal in signals if signal in found]
            header["signals"].append(names)
            said = charts.values(source.store, names, at)
            header["values"].append([[finite(value) for value in said.get(name, ())] for name in names])
            missing = charts.holes(source.store, names, first, last, pixels)
            header["holes"].append([missing.get(name, []) for name in names])
            has_ended = not source.is_live and at > source.store.last
            header["sources"].append({"pose": None if has_ended else charts.pose(source.facts, source.store, at),
                                      "state": charts.state(source.store, at), "trouble": self.desk.trouble(source), "ended": source.store.last if has_ended else None,
                                      "first": finite(source.store.first), "last": finite(source.store.last)})
            for name in names:
                blocks.append(np.stack(found[name], 1).astype("<f4").tobytes())
        text = json.dumps(header).encode()
        text += b" " * (-len(text) % 4)
        await self.socket.send(len(text).to_bytes(4, "little") + text + b"".join(blocks))

    def run_state(self):
        desk = self.desk
        told = {"gap": desk.gap.state()} if desk.gap is not None else {}
        if desk.diagnosis is not None:
            told["diagnosis"] = desk.diagnosis.state()
        if desk.recorder is not None:
            told["recording"] = desk.recorder.state()
        if desk.run is None:
            return told
        holder = desk.joystick.holder
        return told | {"run": desk.run.state() | {"joystick": "yours" if holder is self else "free" if holder is None else "another page's",
                                           "lost": desk.joystick.lost, "stop": desk.joystick.stop}}

    async def wait_for_news(self):
        """A page that follows a run is answered when there is something new, or after a while."""
        newest = max(source.store.last for source in self.desk.sources)
        if newest == self.seen:
            try:
                async with self.desk.news:
                    await asyncio.wait_for(self.desk.news.wait(), STILL)
            except TimeoutError:
                pass
        self.seen = max(source.store.last for source in self.desk.sources)

    async def spectrum(self, request):
        """{"at" [s]}: amplitudes of the accelerations over the span [s] before it, of every source."""
        at = number(request["at"], -1e9, 1e9)
        lines = []
        for source in self.desk.sources:
            lines.append(spectra(source, at))
        spans = [round(spectrum_span(source), 1) for source in self.desk.sources]
        await self.say({"type": "spectrum", "at": at, "spans": spans, "sources": lines})

    async def diagnose(self):
        """Hands the newest minute over to slewlab diagnose: who may steer may ask for it."""
        if not self.may_steer or self.desk.diagnosis is None:
            await self.say({"type": "refused", "why": "this page only watches" if not self.may_steer else "there is no nominal machine to diagnose against"})
        else:
            await self.desk.diagnosis.begin(self.desk.sources[0])

    async def record(self, on):
        """Begins or ends a log of what goes on from here: it is written where the desk is, so who may steer may ask for it."""
        if not self.may_steer or self.desk.recorder is None:
            await self.say({"type": "refused", "why": "this page only watches" if not self.may_steer else "nothing goes on that could be recorded"})
        elif not on:
            self.desk.recorder.stop()
        elif self.desk.run is not None and self.desk.run.ended:
            await self.say({"type": "refused", "why": "the run has ended: start it anew"})
        elif self.desk.run is None and self.desk.is_over(self.desk.sources[0]):
            await self.say({"type": "refused", "why": "the run has ended"})
        elif not np.isfinite(self.desk.sources[0].store.last):
            await self.say({"type": "refused", "why": "nothing has been heard yet"})
        else:
            self.desk.recorder.begin()

    async def steer(self, kind, request):
        """What changes the run: only with the steering token."""
        if not self.may_steer:
            await self.say({"type": "refused", "why": "this page only watches: steering needs the address with the steering token"})
            return
        now, joystick = time.monotonic(), self.desk.joystick
        if kind == "take":
            if self.desk.run.ended:
                await self.say({"type": "refused", "why": "the run has ended: start it anew"})
            elif not joystick.take(self, now):
                await self.say({"type": "refused", "why": "another page has the joystick"})
        elif kind == "give":
            joystick.give_back(self, GONE if request.get("hidden") else "")
        elif kind == "joystick":
            joystick.move(self, round(number(request["request"], -1.0, 1.0), 3), now)
            if joystick.holder is self:
                joystick.acknowledge = bool(request.get("acknowledge"))
        elif kind == "anew":
            wanted = request.get("play_compensation")
            await self.desk.start_anew(None if wanted is None else bool(wanted))
        elif kind == "stop":  # whoever may steer may stop, with or without the joystick
            if request["pressed"]:
                joystick.stop = True
            elif not joystick.release_stop(self):
                await self.say({"type": "refused", "why": "the emergency stop is released by who has the joystick"})
        else:
            answer = await self.desk.run.command(kind, request)
            if answer:
                await self.say(answer)


def kind_of(text):
    """What a request asked for, as far as it is one."""
    with contextlib.suppress(ValueError, AttributeError):
        return json.loads(text).get("type")
    return None


def finite(value):
    return float(value) if np.isfinite(value) else None


def page_facts(facts):
    """What the page uses of run.json, and how it shows it."""
    return charts.quantities(facts) | {"is_axis": charts.is_axis(facts)} | {key: facts[key] for key in ("geometry", "half_play", "modes", "rated_torque", "top_speed", "end",
                                        "play_compensation", "controller_period", "plant_step") if key in facts}


def spectrum_span(source):
    from run_numbers import band_of

    return SPECTRUM_SEGMENTS * band_of(source.facts).segment


def spectra(source, at):
    from run_numbers import band_of
    from spectrum import amplitude_spectrum

    store, band = source.store, band_of(source.facts)
    found = []
    for name in ("tip", "house"):
        signal = f"SENSORS.{name}_acceleration"
        if not charts.is_there(signal, store):
            continue
        channel, row = store.places[signal]
        time_, values = store.channels[channel].samples(at - spectrum_span(source), at)
        if len(time_) < 64:
            continue
        even, step = charts.evenly(time_, values[row], band.segment)
        frequency, amplitude = amplitude_spectrum(even, step, band.segment)
        shown = (frequency >= LOWEST * band.lowest) & (frequency <= HIGHEST * band.highest)
        if shown.any():
            found.append({"label": name, "frequency": [round(float(f), 4) for f in frequency[shown]],
                          "amplitude": [float(f"{a:.4g}") for a in amplitude[shown]]})
    return found
