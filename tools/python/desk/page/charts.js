// The charts: one uPlot per quantity, all over the same window of time. What comes for a signal is the lowest and the highest
// value of every column of pixels, so that no peak is lost and drawing costs what the screen has, not what the log has.
"use strict";

const CHART_HEIGHT = 150, SPECTRUM_HEIGHT = 210;  // [px] as .plot in desk.css
const TICK_SPACING = 22;  // [px] at least, beside a chart: a fifth of its height, so that two numbers or more stand there
const DECADES = [3, 1];  // of a spectrum that are shown below and above the decade of its peak; the modes' names stand above it
const SPECTRUM_AXIS = [0.1, 100];  // [Hz]
const TOLERANCE = 0.25;  // [px] by which a line may pass beside a value: less than shows
const MARK_SPACING = 12;  // [px] that the names of two modes need

function colour(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(`--${typeof name === "number" ? "c" + (name % 8) : name}`).trim();
}

function shown(value) {
  if (value === null || value === undefined || !Number.isFinite(value)) return "–";
  const size = Math.abs(value);
  if (size !== 0 && (size < 0.001 || size >= 100000)) return value.toExponential(2);
  return value.toFixed(size >= 100 ? 1 : size >= 1 ? 2 : 4);
}

// A sample's value, or the lowest and the highest of a stretch of which no sample is held any more.
function shownRange(range, scale) {
  if (!range?.length) return shown(null);
  const [low, high] = range.map((value) => value === null ? null : value * scale);
  return low === high ? shown(low) : `${shown(low)} … ${shown(high)}`;
}

// Beside an axis, where there is room for some six signs.
function tickText(value) { return value !== 0 && Math.abs(value) < 1e-3 ? value.toExponential() : String(value); }

// The path of a line through the lowest and the highest value of every column of pixels, in as few points as show the same: a browser takes
// as long to stroke a path as it has points and is long. Of a column in which nothing moves one point stands, of a straight stretch its ends
// (swinging door: no point lies farther than TOLERANCE from the line), and of a column that is gone through the end that is nearer comes
// first. `drawn()`: {columns, holes, scale} of the line; `isHeld`: a value stands until the next column with one.
function linePath(drawn, isHeld) {
  return (plot, number) => {
    const stroke = new Path2D(), path = {stroke, fill: null, clip: null, band: null, gaps: null, flags: 1}, {columns, holes, scale} = drawn();
    if (!columns) return path;
    const {left, top, width, height} = plot.bbox, along = plot.scales.x, across = plot.scales[plot.series[number].scale], times = plot.data[0];
    const toX = width / (along.max - along.min), toY = height / (across.max - across.min), tolerance = TOLERANCE * devicePixelRatio;
    const firstX = left + (times[0] - along.min) * toX, step = (times[times.length - 1] - times[0]) * toX / (columns.length / 2 - 1);
    const zero = top + across.max * toY, near = 1.5 * devicePixelRatio;
    // The line stands at an anchor and will go on to what is next, at a slope between least and most.
    let isDown = false, anchorX = 0, anchorY = 0, nextX = 0, nextY = 0, least = -Infinity, most = Infinity, hole = 0;
    const add = (x, y) => {
      const slope = (y - anchorY) / (x - anchorX);
      if (nextX > anchorX && (x <= nextX || slope < least || slope > most)) {
        stroke.lineTo(nextX, nextY);
        anchorX = nextX; anchorY = nextY; least = -Infinity; most = Infinity;
      }
      if (x <= anchorX) {
        stroke.lineTo(x, y);
        anchorY = y; least = -Infinity; most = Infinity;
      } else {
        least = Math.max(least, (y - tolerance - anchorY) / (x - anchorX));
        most = Math.min(most, (y + tolerance - anchorY) / (x - anchorX));
      }
      nextX = x; nextY = y;
    };
    for (let k = 0, before = 0; 2 * k < columns.length; ++k) {
      while (hole < holes.length && k >= holes[hole][1]) ++hole;
      const isMissing = hole < holes.length && k >= holes[hole][0];
      if (isMissing && isDown) { if (nextX > anchorX) stroke.lineTo(nextX, nextY); isDown = false; }
      if (columns[2 * k] !== columns[2 * k]) continue;
      const x = firstX + k * step;
      let low = zero - columns[2 * k] * scale * toY, high = zero - columns[2 * k + 1] * scale * toY;
      if (Math.abs(high - low) <= 2 * tolerance) low = high = (low + high) / 2;
      if (!isDown) {
        stroke.moveTo(x, low);
        isDown = true; anchorX = nextX = x; anchorY = nextY = low; least = -Infinity; most = Infinity;
      } else {
        const isNear = x - nextX < near;
        if (isHeld && !isNear) add(x, before);
        else if (Math.abs(before - high) < Math.abs(before - low)) [low, high] = [high, low];
        add(x, low);
      }
      if (high !== low) add(x, high);
      before = high;
    }
    if (isDown && nextX > anchorX) stroke.lineTo(nextX, nextY);
    return path;
  };
}

class Chart {
  // `lines`: what is drawn, [{key, signal, source, label, scale, colour, held, dash, band}].
  constructor(parent, description, lines, hooks) {
    this.description = description;
    this.lines = lines;
    this.hooks = hooks;
    this.element = document.createElement("div");
    this.element.className = description.isSpectrum ? "chart spectrum" : "chart";
    this.height = description.isSpectrum ? SPECTRUM_HEIGHT : CHART_HEIGHT;
    const heading = document.createElement("h2");
    heading.textContent = description.title + " ";
    const unit = document.createElement("small");
    unit.textContent = `[${description.unit}]`;
    heading.append(unit);
    this.legend = document.createElement("div");
    this.legend.className = "legend";
    this.values = lines.map((line) => {
      const item = document.createElement("span");
      const mark = document.createElement("i");
      mark.style.borderTopColor = `var(--${typeof line.colour === "number" ? "c" + (line.colour % 8) : line.colour})`;
      if (line.dash) mark.className = "dash";
      const value = document.createElement("b");
      item.append(mark, line.label + " ", value);
      this.legend.append(item);
      return value;
    });
    const isOff = (mark) => mark.at < SPECTRUM_AXIS[0] || mark.at > SPECTRUM_AXIS[1];
    const off = description.isSpectrum ? (description.marks ?? []).filter(isOff).map((mark) => mark.label) : [];
    for (const words of [off.length && `off the axis: ${off.join(", ")}`, description.note].filter(Boolean)) {
      const note = document.createElement("span");
      note.textContent = words;
      this.legend.append(note);
    }
    this.place = document.createElement("div");
    this.place.className = "plot";
    this.element.append(heading, this.legend, this.place);
    parent.append(this.element);
    this.cursor = null;
    // What is out of sight is drawn when it comes into it.
    this.isSeen = false;
    this.observer = new IntersectionObserver((changes) => { this.isSeen = changes.at(-1).isIntersecting; if (this.isSeen) this.drawLatest(); }, {rootMargin: `${CHART_HEIGHT}px`});
    this.observer.observe(this.element);
    this.begin();
  }

  begin() {
    const axis = {stroke: () => colour("faint"), grid: {stroke: () => colour("grid"), width: 1}, ticks: {stroke: () => colour("line"), width: 1}, font: "11px system-ui, Arial, sans-serif"};
    const unitAlong = this.description.isSpectrum ? "Hz" : "s";
    const options = {
      width: this.width(), height: this.height, legend: {show: false}, cursor: {drag: {x: true, y: false, setScale: false}, bind: {dblclick: () => null}, points: {show: false}, sync: {key: "desk"}},
      scales: {x: this.description.isSpectrum ? {distr: 3, range: SPECTRUM_AXIS} : {time: false}, y: this.description.isSpectrum ? {distr: 3, range: (plot, low, high) => this.decades(high)} : {range: (plot, low, high) => this.range(low, high)}},
      axes: [{...axis, size: 28, values: (plot, ticks) => ticks.map((tick) => tick === null ? "" : `${+tick.toPrecision(9)} ${unitAlong}`)},
             {...axis, size: 58, ...(this.description.isSpectrum ? {} : {space: TICK_SPACING}), values: (plot, ticks) => ticks.map((tick) => tick === null ? "" : tickText(+tick.toPrecision(4)))}],
      series: [{}, ...this.lines.map((line, i) => ({stroke: () => colour(line.colour), width: line.thin ? 1 : 1.3, dash: line.dash ? [5, 4] : undefined, spanGaps: this.description.isSpectrum, points: {show: false},
                                                 ...(this.description.isSpectrum ? {} : !line.band && !this.lines[i + 1]?.band ? {paths: linePath(() => this.drawn[i], line.held)}
                                                 // Between two lines is filled what uPlot's own paths bound. The step behind a hole is none of the signal's.
                                                   : line.held ? {paths: uPlot.paths.stepped({align: 1}), gaps: (plot, i, from, to, gaps) => gaps.map(([begin, end]) => [begin, end + 2 * devicePixelRatio])} : {})}))],
      bands: this.lines.flatMap((line, i) => line.band ? [{series: [i, i + 1], fill: () => colour("band") + "22"}] : []),
      hooks: {draw: [(plot) => this.drawMarks(plot)], setSelect: [(plot) => this.selected(plot)],
              ready: [(plot) => {
                plot.over.addEventListener("click", (event) => this.clicked(plot, event));
                plot.over.addEventListener("dblclick", () => this.hooks.unzoom?.());
              }]},
    };
    this.drawn = this.lines.map((line) => ({columns: null, holes: [], scale: line.scale}));
    this.plot = new uPlot(options, [[], ...this.lines.map(() => [])], this.place);
  }

  range(low, high) {
    if (!Number.isFinite(low) || !Number.isFinite(high)) return [-1, 1];
    // No finer than what a picture's numbers can say.
    const span = Math.max(high - low, 1e-3 * Math.max(Math.abs(low), Math.abs(high)), 1e-6), middle = (low + high) / 2;
    return [middle - 0.56 * span, middle + 0.56 * span];
  }

  // Whole powers of ten: uPlot's logarithmic ticks begin at nothing else.
  decades(high) {
    const top = Math.ceil(Math.log10(Math.max(1e-9, high ?? 1)));
    return [10 ** (top - DECADES[0]), 10 ** (top + DECADES[1])];
  }

  width() { return Math.max(120, Math.floor(this.place.clientWidth || 300)); }

  resize() { if (this.plot.width !== this.width()) this.plot.setSize({width: this.width(), height: this.height}); }

  clicked(plot, event) {
    if (!this.description.isSpectrum) this.hooks.seek(plot.posToVal(event.clientX - plot.over.getBoundingClientRect().left, "x"));
  }

  selected(plot) {
    if (plot.select.width > 4 && !this.description.isSpectrum) {
      this.hooks.zoom(plot.posToVal(plot.select.left, "x"), plot.posToVal(plot.select.left + plot.select.width, "x"));
    }
    if (plot.select.width > 0) plot.setSelect({left: 0, width: 0, top: 0, height: 0}, false);
  }

  drawMarks(plot) {
    const context = plot.ctx, box = plot.bbox;
    context.save();
    context.beginPath(); context.rect(box.left, box.top, box.width, box.height); context.clip();
    context.textAlign = "right";
    context.textBaseline = "alphabetic";
    let named = -Infinity;
    for (const mark of this.description.marks ?? []) {
      const x = plot.valToPos(mark.at, "x", true);
      if (x < box.left || x > box.left + box.width) continue;
      context.strokeStyle = colour("grey"); context.setLineDash([4, 4]); context.lineWidth = devicePixelRatio;
      context.beginPath(); context.moveTo(x, box.top); context.lineTo(x, box.top + box.height); context.stroke();
      context.setLineDash([]);
      if (x - named < MARK_SPACING * devicePixelRatio) continue;
      named = x;
      context.fillStyle = colour("faint"); context.font = `${10 * devicePixelRatio}px system-ui, Arial, sans-serif`;
      context.save(); context.translate(x - 3 * devicePixelRatio, box.top + 3 * devicePixelRatio); context.rotate(-Math.PI / 2); context.fillText(mark.label, 0, 0); context.restore();
    }
    if (this.cursor !== null) {
      const x = plot.valToPos(this.cursor, "x", true);
      context.setLineDash([]);
      context.strokeStyle = colour("accent"); context.lineWidth = devicePixelRatio;
      context.beginPath(); context.moveTo(x, box.top); context.lineTo(x, box.top + box.height); context.stroke();
    }
    context.restore();
  }

  // `found`: {key: {columns: Float32Array of (lowest, highest) by column, value: at `at`, holes: [[begin, end] columns]}}. `over`: the
  // sources that end before `at`. To uPlot undefined is a column without a sample, which a line crosses, and null one without messages.
  draw(times, found, from, to, at, over) {
    this.lines.forEach((line, i) => {
      const {columns = null, value, holes = []} = found[line.key] ?? {};
      this.values[i].textContent = shownRange(over.has(line.key.split(":")[0]) ? null : value, line.scale);
      this.drawn[i] = {columns, holes, scale: line.scale};
    });
    this.cursor = at;
    this.latest = {times, from, to};
    if (this.isSeen) this.drawLatest();
  }

  drawLatest() {
    if (!this.latest) return;
    const {times, from, to} = this.latest, data = [times];
    this.latest = null;
    for (const {columns, holes, scale} of this.drawn) {
      const values = new Array(times.length).fill(undefined);
      if (columns) for (let k = 0; k < values.length; ++k) if (columns[k] === columns[k]) values[k] = columns[k] * scale;
      for (const [begin, end] of holes) for (let k = 2 * begin; k < 2 * end; ++k) values[k] ??= null;
      data.push(values);
    }
    this.plot.batch(() => {
      this.plot.setData(data, false);
      this.plot.setScale("x", {min: from, max: to});
    });
  }

  remove() { this.observer.disconnect(); this.plot.destroy(); this.element.remove(); }
}
