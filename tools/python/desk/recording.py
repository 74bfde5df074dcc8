"""A part of a run as a log of its own: from the moment at which a page says so, until it says stop or the run is over."""

import json
from pathlib import Path

from whole_file import next_folder
from desk.source import HELD, event_bytes

OF_ITS_RUN = ("duration", "simulated_time", "wall_time", "cycles", "resends")  # of run.json: of the whole run, none of a part of it


class Recorder:
    """Hears everything of a source that goes on; writes OUT/recording_1, _2, ... with run.lcmlog and run.json."""

    def __init__(self, out):
        self.out, self.source, self.file, self.folder = Path(out), None, None, None
        self.standing, self.run, self.newest, self.count, self.since, self.until, self.problem = {}, None, None, 0, None, None, ""

    def attach(self, source):
        self.stop()
        self.source, self.standing, self.run = source, {}, source.incoming.run
        source.incoming.taps.append(self.take)

    def begin(self):
        """What the last messages say that stand until the next one is in front."""
        self.stop()
        self.folder, self.problem, self.count = next_folder(self.out, "recording_"), "", 0
        self.since, self.newest, self.until = self.source.store.last, self.source.store.last, None
        try:
            self.folder.mkdir(parents=True)
            self._tell({"end": "under way"})
            self.file = self._partial.open("wb")
        except OSError as error:
            self._give_up(error)
            return
        self._write(list(self.standing.items()))

    @property
    def _partial(self):
        return self.folder / "run.lcmlog.partial"

    def _tell(self, more):
        facts = {name: value for name, value in self.source.facts.items() if name not in OF_ITS_RUN}
        text = json.dumps(facts | {"recorded_from": self.since} | more, indent=2) + "\n"
        (self.folder / "run.json").write_text(text, encoding="utf-8")

    def take(self, events):
        if self.source.incoming.run != self.run:  # another one: of what stood before, nothing does any more
            self.stop()
            self.standing, self.run, events = {}, self.source.incoming.run, self.source.incoming.of_this_run(events)
        self.newest = self.source.store.last
        self._write(events)
        self.standing.update((channel, data) for channel, data in events if channel in HELD)

    def _write(self, events):
        if self.file is None:
            return
        try:
            for channel, data in events:
                self.file.write(event_bytes(self.count, self.source.store.last, channel, data))
                self.count += 1
        except OSError as error:
            self._give_up(error)

    def _give_up(self, error):
        """What could be written stays, as of a run that was broken off."""
        self.problem, self.file = f"{self.folder}: not recorded any more: {error.strerror or error}", None

    def stop(self):
        if self.file is None:
            return
        file, self.file, self.until = self.file, None, self.newest
        try:
            file.close()
            how = self.source.facts.get("end", "under way")  # the run's end, where that is this recording's
            self._tell({"end": "complete" if how == "under way" else how, "recorded_until": self.until})
            self._partial.replace(self.folder / "run.lcmlog")
        except OSError as error:
            self._give_up(error)

    def state(self):
        """For the page; nothing where nothing was recorded yet."""
        if self.folder is None:
            return {}
        return {"folder": str(self.folder), "on": self.file is not None, "from": self.since, "until": self.until, "problem": self.problem}
