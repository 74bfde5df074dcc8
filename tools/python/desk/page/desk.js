// The page's main loop: asks for a window, asks for the next when it has come, and draws what came.
"use strict";

const SPECTRUM_EVERY = 500;  // [ms]
const LAYOUT_EVERY = 1000;   // [ms] of a live run
const LONG_SILENCE = 2;      // [s] after which it is said that nothing new comes
const by = (id) => document.getElementById(id);

// Of a log that is read as a whole, nothing more comes; one that is followed says so in its run.json.
function hasEnded(source) { return Boolean(source.facts.end) && (source.silence === null || source.facts.end !== "under way"); }

function isSameQuantity(one, other) { return one.title === other.title && one.unit === other.unit; }

// Why what two sources have of a chart cannot be subtracted; undefined where it can.
function unlikeCharts(sources, first, second) {
  if (!first || !second) return "not in both logs in these terms";
  if (first.unit !== second.unit) return `${sources[0].name} in ${first.unit}, ${sources[1].name} in ${second.unit}`;
  const differs = first.series.some((line) => Math.abs(line.scale / second.series.find(({signal}) => signal === line.signal)?.scale - 1) > 1e-9);
  return differs ? "the machines' ratios or rated torques differ" : undefined;
}

// What is derived of other signals has a difference where these have one.
function hasDifference(signal, charts) { return signal.startsWith("compensation.") || charts.some((chart) => chart.series.some((line) => line.signal === signal)); }

// Of a chart of two sources the lines that their difference has, and words for those that it has not.
function commonLines(sources, first, second) {
  const has = (chart, line) => chart.series.some(({signal}) => signal === line.signal), isTold = (line) => hasDifference(line.signal, sources[2].charts);
  const both = first.series.filter((line) => has(second, line)), left = [
    [`only in ${sources[0].name}`, first.series.filter((line) => !has(second, line))], [`only in ${sources[1].name}`, second.series.filter((line) => !has(first, line))],
    ["in the two logs at no common time, or in messages of another form", both.filter((line) => !isTold(line))]];
  const words = left.filter(([, lines]) => lines.length).map(([why, lines]) => `${lines.map((line) => `“${line.label}”`).join(", ")} (${why})`);
  return {lines: both.filter(isTold), left: words.join(", ")};
}

class Desk {
  constructor() {
    this.charts = [];
    this.layout = null;
    this.at = 0;
    this.window = null;  // [from, to] of a zoom; null: as the window's choice says
    this.playing = false;
    this.following = false;
    this.drawn = 0;  // views, for whoever measures frames
    this.picture = new CranePicture();
    this.steering = new Steering((message) => this.send(message));
    by("play").addEventListener("click", () => this.play(!this.playing));
    by("live").addEventListener("click", () => this.follow(true));
    by("scrub").addEventListener("input", (event) => { this.follow(false); this.seek(Number(event.target.value)); });
    by("span").addEventListener("change", () => { this.window = null; this.ask(); });
    by("compare").addEventListener("change", () => this.build());
    by("record").addEventListener("click", () => this.send({type: "record", on: !this.recording}));
    by("diagnose").addEventListener("click", () => this.send({type: "diagnose"}));
    by("true_scale").addEventListener("click", () => { by("exaggeration").value = 1; this.ask(); });
    by("exaggeration").addEventListener("change", () => this.ask());
    by("viewpoint").addEventListener("change", () => this.ask());
    addEventListener("resize", () => { for (const chart of this.charts) chart.resize(); requestAnimationFrame(() => this.ask()); });  // uPlot is as wide a moment later
    addEventListener("beforeprint", () => { for (const chart of this.charts) chart.drawLatest(); });
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.ask());
    setInterval(() => this.listen(), 500);
    this.connect();
  }

  // A desk that stands still answers nothing and closes nothing.
  listen() {
    const silence = (performance.now() - this.heard) / 1000;
    if (!this.layout?.live || this.socket.readyState !== WebSocket.OPEN || !(silence > LONG_SILENCE)) return;
    this.badge("connection", `nothing heard for ${silence.toFixed(0)} s`, "bad");
    this.steering.letGo("the desk does not answer");
  }

  connect() {
    this.asked = false;
    this.socket = new WebSocket(`${location.protocol === "https:" ? "wss" : "ws"}://${location.host}/socket`);
    this.socket.binaryType = "arraybuffer";
    this.socket.addEventListener("open", () => { this.lost = undefined; this.notice(""); this.runWords = ""; this.send({token: location.hash.slice(1)}); this.send({type: "layout"}); });
    this.socket.addEventListener("message", (event) => {
      this.heard = performance.now();
      if (typeof event.data === "string") this.told(JSON.parse(event.data)); else this.received(event.data);
    });
    this.socket.addEventListener("close", (event) => {
      this.badge("connection", event.code === 4401 ? "refused" : "not connected", "bad");
      if (event.code === 4401) { this.notice(event.reason); return; }
      const lever = this.steering.mine ? " The lever was let go." : "", stop = this.steering.steers ? " The emergency stop of this page does not reach the run." : "";
      this.lost ??= lever + stop;  // of the connection that was there; those that are tried behind it never had the lever
      if (this.layout) this.notice(`The desk is out of reach: what is shown stands still.${this.lost} It is tried again.`);
      for (const id of ["drive", "controller"]) this.badge(id, "");
      this.steering.update(null, false);
      setTimeout(() => this.connect(), 1000);
    });
  }

  send(message) { if (this.socket.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify(message)); }

  badge(id, text, kind) {
    const badge = by(id);
    badge.hidden = !text;
    badge.textContent = text ?? "";
    badge.className = "badge " + (kind ?? "");
  }

  notice(text) { by("notice").hidden = !text; by("notice").textContent = text ?? ""; }

  told(message) {
    if (message.type === "layout") this.laidOut(message);
    else if (message.type === "spectrum") this.drawSpectrum(message);
    else if (message.type === "refused") {
      if (message.of === "view") this.asked = false;
      this.notice(message.why);
    }
    else if (message.type === "told") this.notice(message.text);
    else if (message.type === "nothing yet") {
      this.showRun(message.run);
      this.asked = false;
      setTimeout(() => this.ask(), 200);
    }
  }

  laidOut(layout) {
    const before = this.layout;
    this.layout = layout;
    const sources = layout.sources, first = sources[0];
    by("name").textContent = sources.slice(0, 2).map((source) => source.name).join(" against ");
    document.title = `slewlab desk: ${by("name").textContent}`;
    if (!layout.steered) this.showSources(layout);
    by("live").hidden = by("record").hidden = !layout.live;
    by("comparison").hidden = sources.length < 2;
    by("crane").classList.toggle("axis", first.facts.is_axis);
    by("play").hidden = by("rate").parentElement.hidden = layout.live;
    if (!before && layout.steered && !layout.may_steer) this.notice("This page only watches: it was opened without the token to steer that the desk printed.");
    const remarks = sources.flatMap((source) => source.remarks.map((remark) => `${source.name}: ${remark}`));
    const ended = layout.steered ? [] : sources.filter((source) => hasEnded(source) && source.facts.end !== "complete")
      .map((source) => `${source.name}: ${source.facts.end === "under way" ? "this run was broken off" : source.facts.end}`);
    const ofLogs = [...ended, ...remarks].join(" · ");
    if (ofLogs || this.ofLogs) this.notice(ofLogs);  // of another run in the same folder no more what was said of the one before
    this.ofLogs = ofLogs;
    if (!before && layout.live) this.follow(true);
    if (!before && !layout.live) this.at = first.first ?? 0;
    this.range();
    const shape = JSON.stringify(sources.map((source) => source.charts));
    if (shape !== this.shape) { this.shape = shape; this.build(); }
    this.ask();
    if (layout.live) setTimeout(() => this.send({type: "layout"}), LAYOUT_EVERY);  // a run's signals come one after the other
  }

  // Whether anything new is to be expected of what is not steered from here.
  showSources(layout) {
    const live = layout.sources.filter((source) => source.silence !== null);
    const silence = Math.min(...live.map((source) => source.silence));
    this.isOver = live.length > 0 && (live.every(hasEnded) || silence > LONG_SILENCE);
    if (!live.length) this.badge("connection", "recorded", "good");
    else if (live.every(hasEnded)) this.badge("connection", "run ended", "warn");
    else if (this.isOver) this.badge("connection", `nothing new for ${silence.toFixed(0)} s`, "warn");
    else this.badge("connection", "live", "good");
  }

  // Charts of the first source; a second one over them where quantity and unit are the same, or the difference in their place.
  build() {
    for (const chart of this.charts) chart.remove();
    this.charts = [];
    this.spectrumChart = null;
    by("charts").replaceChildren();
    const sources = this.layout.sources, mode = by("compare").value, isDifference = mode === "difference" && sources.length > 2;
    this.signals = sources.map(() => []);
    if (isDifference) {
      const titles = new Set(sources.slice(0, 2).flatMap((source) => source.charts.map((chart) => chart.title)));
      for (const title of titles) {
        const [first, second] = sources.slice(0, 2).map((source) => source.charts.find((chart) => chart.title === title));
        const unlike = unlikeCharts(sources, first, second), {lines, left} = unlike ? {} : commonLines(sources, first, second);
        if (unlike) this.refuseChart(first ?? second, unlike);
        else if (!lines.length) this.refuseChart(first, left);
        else this.addChart({...first, title: `${title}, difference`, note: left && `left out: ${left}`}, this.lines(2, {...first, series: lines}));
      }
    } else {
      const second = mode === "overlay" ? sources[1]?.charts ?? [] : [];
      for (const description of sources[0].charts) {
        const other = second.find((each) => isSameQuantity(each, description));
        this.addChart(description, [...this.lines(0, description), ...(other ? this.lines(1, other) : [])]);
      }
      for (const other of second) if (!sources[0].charts.some((each) => isSameQuantity(each, other))) this.addChart(other, this.lines(1, other));
    }
    this.ask();
  }

  // What a chart draws of one source, which is asked for from now on.
  lines(number, description) {
    return description.series.map((line) => {
      this.signals[number].push(line.signal);
      return number === 1 ? {...line, key: `1:${line.signal}`, label: `${line.label}, ${this.layout.sources[1].name}`, dash: true, thin: true, band: false}
        : {...line, key: `${number}:${line.signal}`};
    });
  }

  addChart(description, lines) {
    const hooks = {seek: (time) => { this.follow(false); this.seek(time); }, zoom: (from, to) => { this.follow(false); this.window = [from, to]; this.ask(); },
                   unzoom: () => { this.window = null; this.ask(); }};
    this.charts.push(new Chart(by("charts"), description, lines, hooks));
  }

  refuseChart(description, why) {
    const place = document.createElement("div"), heading = document.createElement("h2"), words = document.createElement("p");
    place.className = "chart refused";
    heading.textContent = `${description.title}, difference`;
    const isTold = this.layout.sources.slice(0, 2).every((source) => source.facts.rated_torque);
    words.textContent = `No difference: ${why}.${isTold ? "" : " A log does not tell its machine; where both are of one, open them with --same-machine."}`;
    place.append(heading, words);
    by("charts").append(place);
  }

  range() {
    const firsts = this.layout.sources.map((source) => source.first).filter((time) => time !== null);
    const lasts = this.layout.sources.map((source) => source.last).filter((time) => time !== null);
    this.first = Math.min(...firsts); this.last = Math.max(...lasts);
    if (!firsts.length) { this.first = 0; this.last = 1; }
    const scrub = by("scrub");
    scrub.min = this.first; scrub.max = this.last;
  }

  play(on) {
    this.playing = on;
    by("play").textContent = on ? "Pause" : "Play";
    by("play").classList.toggle("on", on);
    if (on && this.at >= this.last) this.at = this.first;
    this.played = performance.now();
    this.ask();
  }

  follow(on) {
    this.following = on && this.layout?.live;
    by("live").classList.toggle("on", this.following);
    if (this.following) this.window = null;
    this.ask();
  }

  seek(time) {
    if (!Number.isFinite(time)) return;
    this.at = Math.max(this.first, Math.min(this.last, time));
    this.ask();
  }

  span() {
    const chosen = Number(by("span").value);
    return chosen > 0 ? chosen : Math.max(1e-3, this.last - this.first);
  }

  // The window around the cursor: it moves when the cursor reaches its last fifth.
  place() {
    if (this.window) {
      const [from, to] = this.window;
      if (this.at >= from && this.at <= to) return this.window;
      this.window = [this.at - (to - from) / 2, this.at + (to - from) / 2];
      return this.window;
    }
    const span = this.span();
    if (span >= this.last - this.first) return [this.first, this.first + span];
    const from = Math.min(Math.max(this.first, this.at - 0.8 * span), this.last - span);
    return [from, from + span];
  }

  ask() {
    if (!this.layout || this.asked || !this.signals) { this.again = true; return; }
    this.again = false;
    const [from, to] = this.following ? [0, this.span()] : this.place();
    const width = this.charts[0]?.plot.over.clientWidth || 300;
    this.asked = true;
    this.send({type: "view", from, to, at: this.at, live: this.following, pixels: Math.min(2000, width), signals: this.signals});
    this.askSpectrum();
  }

  // Not for every picture; of the last one for certain.
  askSpectrum() {
    const now = performance.now(), wait = SPECTRUM_EVERY - (now - (this.spectrumAsked ?? -1e9));
    if (wait > 0) {
      this.spectrumTimer ??= setTimeout(() => { this.spectrumTimer = null; this.askSpectrum(); }, wait);
      return;
    }
    this.spectrumAsked = now;
    this.send({type: "spectrum", at: this.following ? this.last : this.at});
  }

  received(buffer) {
    this.asked = false;
    const length = new DataView(buffer).getUint32(0, true);
    const header = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, length)));
    const values = new Float32Array(buffer, 4 + length), size = 2 * header.bins, found = {};
    let place = 0;
    header.signals.forEach((names, source) => names.forEach((name, i) => {
      found[`${source}:${name}`] = {columns: values.subarray(place, place + size), value: header.values[source][i], holes: header.holes[source][i]};
      place += size;
    }));
    this.layout.sources.forEach((source, number) => { source.first = header.sources[number].first; source.last = header.sources[number].last; });
    this.range();
    if (this.following) this.at = header.at;
    if (this.playing) {
      const now = performance.now();
      this.at += (now - this.played) / 1000 * Number(by("rate").value);
      this.played = now;
      if (this.at >= this.last) { this.at = this.last; this.play(false); }
    }
    // Before this window is drawn: the next one is made meanwhile. Where two come between two pictures, the newer one is drawn.
    if (!this.waiting) requestAnimationFrame(() => { const waiting = this.waiting; this.waiting = null; this.draw(...waiting); });
    this.waiting = [header, found];
    if (this.playing || this.following || this.again) this.ask();
  }

  draw(header, found) {
    // The picture first: it asks for its size, which is known as long as no text of the page has changed.
    const cranes = header.sources.slice(0, 2).map((source, number) => ({facts: this.layout.sources[number].facts, pose: source.pose}));
    this.picture.draw(by("compare").value === "none" ? cranes.slice(0, 1) : cranes);
    const times = new Float64Array(2 * header.bins), step = (header.to - header.from) / header.bins;
    for (let k = 0; k < header.bins; ++k) times[2 * k] = times[2 * k + 1] = header.from + (k + 0.5) * step;
    const over = new Set(header.sources.flatMap((source, number) => source.ended === null ? [] : [String(number)]));
    for (const chart of this.charts) if (!chart.description.isSpectrum) chart.draw(times, found, header.from, header.to, header.at, over);
    this.showState(header);
    by("scrub").value = header.at;
    by("clock").textContent = `${header.at.toFixed(3)} s of ${this.last.toFixed(1)} s`;
    this.showRun(header.run);
    this.showGap(header.gap, header.diagnosis);
    this.showRecording(header.recording ?? {});
    this.drawn += 1;
  }

  showRun(run) {
    this.steering.update(run ?? null, this.layout.may_steer);
    if (!run) return;
    this.badge("connection", run.ended ? "run ended" : run.paused ? "paused" : "live", run.ended || run.paused ? "warn" : "good");
    this.isOver = run.ended;
    const words = [run.why || run.ended && "The run has ended.", run.lost && `The lever was let go: ${run.lost}; the crane ramps down.`].filter(Boolean).join(" · ");
    if (words !== this.runWords) { this.runWords = words; this.notice(words); }
  }

  // The observer's sizes over the last second against what is usual, and how a diagnosis stands.
  showGap(gap, diagnosis) {
    const place = by("gap");
    place.hidden = !gap;
    if (!gap) return;
    const open = gap.signals.filter((signal) => signal.open);
    const usual = (signal) => signal.usual === null ? "" : ` (usual ${shown(signal.usual)})`;
    const size = (signal) => `${signal.label} ${shown(signal.size)} ${signal.unit}${usual(signal)}`;
    const sizes = gap.signals.filter((signal) => signal.is_effort && signal.size !== null).map(size).join(", ");
    let text = gap.problem ? `Gap to the nominal machine: ${gap.problem}.`
      : open.length ? `A gap has opened at ${gap.since.toFixed(1)} s: ${open.map(size).join(", ")}.`
      : !gap.signals.length ? "The observer has said nothing yet."
      : gap.usual_from !== null ? `Not known yet whether there is a gap: what size is usual is known from about ${gap.usual_from.toFixed(0)} s on${sizes ? `; now ${sizes}` : ""}.`
      : `No gap beyond the usual: ${sizes}.`;
    if (gap.remark) text += ` ${gap.remark}.`;
    if (diagnosis && diagnosis.state !== "ready") text += ` Diagnosis ${diagnosis.state}, ${diagnosis.folder}: ${diagnosis.words.join(" · ")}`;
    if (text !== this.gapText) { this.gapText = text; place.lastElementChild.textContent = text; }
    place.classList.toggle("open", open.length > 0);
    by("diagnose").disabled = !this.layout.may_steer || diagnosis?.state === "under way";
  }

  showRecording({on, folder, from, until, problem}) {
    this.recording = on ?? false;
    const place = by("recording"), button = by("record");
    place.hidden = !folder;
    const text = problem || (on ? `Recording from ${from?.toFixed(2)} s on: ${folder}` : `Recorded from ${from?.toFixed(2)} to ${until?.toFixed(2)} s: ${folder}`);
    if (place.textContent !== text) place.textContent = text;
    const disabled = !this.layout.may_steer || this.isOver === true && !this.recording;  // what was begun can be ended
    if (button.disabled !== disabled) button.disabled = disabled;
    button.setAttribute("aria-pressed", this.recording);
    button.textContent = this.recording ? "Stop recording" : "Record from here";
  }

  showState(header) {
    const {state, ended, trouble} = header.sources[0], pose = header.sources[0].pose ?? {angle: null, deflection: null, rope: null};
    const drives = {running: "good", ready: "good", tripped: "bad", braked: "warn"};
    // What was said last of a run that is over, or says nothing, is no state of today.
    const say = (id, what, kind) => this.badge(id, what && `${id} ${this.isOver ? "last " : ""}${what}`, this.isOver ? "" : kind);
    say("drive", state.drive, drives[state.drive]);
    if ((trouble || state.silent) && !this.isOver) say("controller", "silent", "bad");
    else say("controller", state.controller, state.controller === "running" ? "good" : state.controller === "stopped" ? "" : "warn");
    const tripped = state.trip && `Drive tripped${state.trip_time === null ? "" : ` at ${state.trip_time.toFixed(3)} s`}: ${state.trip}. It is acknowledged at rest, with the lever at zero.`;
    const words = [trouble, tripped].filter(Boolean).join(" "), trip = by("trip");
    trip.hidden = !words;
    if (trip.textContent !== words) trip.textContent = words;
    const motion = pose.motion ?? {}, degrees = 180 / Math.PI, position = this.layout.sources[0].facts.position, rows = [
      ["this log ended at", ended === null ? null : `${ended.toFixed(1)} s`],
      ["request", state.request === null ? null : `${(100 * state.request).toFixed(0)} %${state.emergency_stop ? ", emergency stop" : ""}${state.acknowledge ? ", acknowledge" : ""}`],
      [position.title, pose.angle === null ? null : `${(pose.angle * position.scale).toFixed(position.unit === "°" ? 2 : 4)} ${position.unit}`.replace(" °", "°")],
      ["tip deflection", pose.deflection === null ? null : `${(pose.deflection * 1000).toFixed(0)} mm`],
      ["boom angle", motion.boom_angle == null ? null : `${(motion.boom_angle * degrees).toFixed(2)}°`],
      ["rope", motion.rope_length == null ? null : `${motion.rope_length.toFixed(2)} m`],
      ["travelled", motion.travelled == null ? null : `${motion.travelled.toFixed(2)} m`],
      ["sidelead", pose.rope === null ? null : `${(pose.rope * degrees).toFixed(2)}°`],
      ["stale commands", state.stale], ["missed deadlines", state.missed]];
    const list = by("facts");
    list.replaceChildren(...rows.filter(([, value]) => value !== null).flatMap(([name, value]) => {
      const term = document.createElement("dt"), text = document.createElement("dd");
      term.textContent = name; text.textContent = value;
      return [term, text];
    }));
  }

  // Of one log, or of both over each other: a difference of amplitudes says nothing of the amplitudes of a difference.
  drawSpectrum(message) {
    const sources = this.layout.sources.slice(0, by("compare").value === "none" ? 1 : 2);
    const found = sources.flatMap((source, number) => message.sources[number].map((line) => ({...line, number, name: number ? `${line.label}, ${source.name}` : line.label})));
    if (!found.length) return;
    const labels = found.map((line) => line.name).join();
    if (!this.spectrumChart || this.spectrumLabels !== labels) {
      this.spectrumLabels = labels;
      if (this.spectrumChart) { this.spectrumChart.remove(); this.charts = this.charts.filter((chart) => chart !== this.spectrumChart); }
      const marks = (sources[0].facts.modes ?? []).map((mode) => ({at: mode.frequency, label: `${mode.name} ${mode.frequency.toPrecision(3)} Hz`}));
      const lines = found.map((line) => ({key: line.name, label: line.name, scale: 1, colour: line.label === "tip" ? 0 : "house", dash: line.number === 1, thin: line.number === 1}));
      const spans = message.spans.slice(0, sources.length), isOne = spans.every((span) => span === spans[0]);
      const title = `spectrum of the acceleration, last ${isOne ? spans[0] : spans.join(" and ")} s`;
      this.spectrumChart = new Chart(by("charts"), {title, unit: "m/s² over Hz", isSpectrum: true, marks}, lines, {});
      this.charts.push(this.spectrumChart);
    }
    // Two logs need not have the same frequencies.
    this.spectrumChart.plot.setData(uPlot.join(found.map((line) => [line.frequency, line.amplitude.map((value) => value > 0 ? value : null)])));
  }
}

const desk = new Desk();
