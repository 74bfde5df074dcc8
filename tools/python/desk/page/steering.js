// The operator's side of the page: lever, keys, gamepad, buttons. The lever springs back when it is let go, and while this page
// has the joystick it says where it stands every BEAT: the server takes silence for a hand that let go.
"use strict";

const BEAT = 100;  // [ms]
const KEY_RATE = 1.6;  // [1/s] of the lever under a held key

class Steering {
  constructor(send) {
    this.send = send;
    this.request = 0;
    this.keys = new Set();
    this.mine = false;
    this.acknowledging = false;
    this.stopPressed = false;
    this.padStop = false;
    this.lever = document.getElementById("lever");
    this.knob = document.getElementById("knob");
    const by = (id) => document.getElementById(id);
    this.lever.addEventListener("pointerdown", (event) => {
      if (!this.mine) return;
      this.lever.setPointerCapture(event.pointerId);
      this.pointer = event.pointerId;
      this.pull(event);
    });
    this.lever.addEventListener("pointermove", (event) => { if (event.pointerId === this.pointer) this.pull(event); });
    for (const kind of ["pointerup", "pointercancel", "lostpointercapture"]) {
      this.lever.addEventListener(kind, (event) => { if (event.pointerId === this.pointer) { this.pointer = null; this.set(0); } });
    }
    by("take").addEventListener("click", () => this.send({type: this.mine ? "give" : "take"}));
    // A second finger, while the first holds the lever, makes no click: it counts where it comes down. A click counts where no pointer
    // made it (detail 0): by a key, or a screen reader.
    const stop = by("stop"), turn = () => { if (!stop.disabled) this.stop(!this.stopPressed); };
    stop.addEventListener("pointerdown", (event) => { if (event.button === 0) turn(); });
    stop.addEventListener("click", (event) => { if (event.detail === 0) turn(); });
    stop.addEventListener("keydown", (event) => { if (event.key === "Enter" && event.repeat) event.preventDefault(); });  // a key that is held
    const acknowledge = by("acknowledge");
    acknowledge.addEventListener("pointerdown", () => this.acknowledge(true));
    for (const kind of ["pointerup", "pointerleave", "pointercancel"]) acknowledge.addEventListener(kind, () => this.acknowledge(false));
    acknowledge.addEventListener("keydown", (event) => { if (event.key === "Enter") this.acknowledge(true); });
    acknowledge.addEventListener("keyup", (event) => { if (event.key === "Enter") this.acknowledge(false); });
    by("pause").addEventListener("click", () => this.send({type: this.paused ? "resume" : "pause"}));
    by("cycle").addEventListener("click", () => this.send({type: "cycle"}));
    by("pace").addEventListener("change", (event) => this.send({type: "speed", speed: Number(event.target.value)}));
    by("save").addEventListener("click", () => this.send({type: "save"}));
    by("anew").addEventListener("click", () => this.send({type: "anew", play_compensation: this.compensation === null ? undefined : by("compensation").checked}));
    by("compensation").addEventListener("change", (event) => { if (this.switchable) this.send({type: "play_compensation", on: event.target.checked}); });
    addEventListener("keydown", (event) => this.key(event, true));
    addEventListener("keyup", (event) => this.key(event, false));
    addEventListener("blur", () => { this.blurred = true; this.letGo("the window lost the focus"); });
    addEventListener("focus", () => { this.blurred = false; });
    document.addEventListener("visibilitychange", () => { if (document.hidden) { this.letGo(); if (this.mine) this.send({type: "give", hidden: true}); } });
    // A box, choice or slider that was used would take the next key for itself.
    document.addEventListener("change", (event) => { if (this.steers && event.target.matches("[type=checkbox], [type=range], select")) event.target.blur(); });
    setInterval(() => this.beat(), BEAT);
  }

  // `why` is said where the lever stood elsewhere than at zero.
  letGo(why) {
    if (why && this.mine && (this.request !== 0 || this.keys.size)) this.sayWhy(why);
    this.keys.clear();
    this.pointer = null;
    this.acknowledging = false;
    this.padIsReady = false;
    this.set(0);
  }

  sayWhy(why) {
    const place = document.getElementById("let_go");
    place.hidden = !why;
    place.textContent = why ? `The lever was let go: ${why}.` : "";
  }

  // Space stops from everywhere: of the page's fields none takes one. Arrows and A are the lever's for who has the joystick, but
  // while a number is typed. A key that comes up counts wherever it does.
  key(event, down) {
    if (!this.steers || down && (event.ctrlKey || event.altKey || event.metaKey)) return;
    const isTyping = event.target instanceof Element && event.target.matches("[type=number], [type=text], textarea");
    if (event.key === " ") {
      if (down && !event.repeat) this.stop(true);
    } else if (!this.mine || down && isTyping) {
      return;
    } else if (event.key === "ArrowLeft" || event.key === "ArrowRight") {
      if (down) this.keys.add(event.key); else if (this.keys.delete(event.key) && !this.keys.size) this.set(0);
    } else if (event.key === "a" || event.key === "A") {
      this.acknowledge(down);
    } else {
      return;
    }
    event.preventDefault();
  }

  pull(event) {
    const box = this.lever.getBoundingClientRect();
    this.set((event.clientX - box.left - box.width / 2) / (box.width / 2 - 27));
  }

  set(request) {
    if (!this.mine) request = 0;
    request = Math.max(-1, Math.min(1, request));
    if (Math.abs(request) < 0.03) request = 0;  // a hand that rests
    const before = this.request;
    this.request = Math.round(request * 100) / 100;
    if (this.request !== 0) this.sayWhy("");
    this.show();
    if (this.mine && this.request !== before) this.say();
  }

  show() {
    this.knob.style.left = `calc(50% + ${this.request} * (50% - 27px))`;
    this.lever.setAttribute("aria-valuenow", this.request);
    document.getElementById("request").textContent = this.request.toFixed(2);
  }

  say() { this.send({type: "joystick", request: this.request, acknowledge: this.acknowledging}); }

  acknowledge(pressed) {
    if (this.acknowledging === pressed) return;
    this.acknowledging = pressed;
    if (this.mine) this.say();
  }

  stop(pressed) { this.send({type: "stop", pressed}); }

  beat() {
    if (this.keys.size) {
      const direction = (this.keys.has("ArrowRight") ? 1 : 0) - (this.keys.has("ArrowLeft") ? 1 : 0);
      this.set(this.request + direction * KEY_RATE * BEAT / 1000);
    }
    this.gamepad();
    if (this.mine && !document.hidden) this.say();
  }

  // The stick moves the lever once it has been seen at rest, in a window that has the focus: what is held meanwhile is no wish.
  gamepad() {
    const pad = (navigator.getGamepads ? [...navigator.getGamepads()] : []).find((each) => each && each.connected);
    if (!pad) {
      if (this.padMoved || this.padAcknowledge) this.letGo("the gamepad is gone");
      this.padIsReady = this.padMoved = this.padStop = this.padAcknowledge = false;
      return;
    }
    const axis = pad.axes[0] ?? 0, stop = pad.buttons[1]?.pressed ?? false, pressed = pad.buttons[0]?.pressed ?? false;
    const isAway = Math.abs(axis) > 0.08;
    if (!isAway && !pressed && !this.blurred) this.padIsReady = true;
    const moved = isAway && this.padIsReady, acknowledge = pressed && this.padIsReady;
    if (moved || this.padMoved) this.set(moved ? axis : 0);
    if (stop && !this.padStop) this.stop(true);
    if (acknowledge !== (this.padAcknowledge ?? false)) this.acknowledge(acknowledge);
    this.padMoved = moved;
    this.padStop = stop;
    this.padAcknowledge = acknowledge;
  }

  // What the server says of the run.
  update(run, maySteer) {
    const section = document.getElementById("steering");
    section.hidden = !run;
    document.getElementById("stop").hidden = !run;
    this.steers = Boolean(run && maySteer);
    if (!run) {
      if (this.mine) { this.mine = false; this.letGo(); }
      return;
    }
    const had = this.mine;
    this.mine = run.joystick === "yours" && !run.ended;
    if (had && !this.mine) this.letGo();
    this.paused = run.paused;
    this.stopPressed = run.stop;
    const by = (id) => document.getElementById(id);
    by("take").textContent = this.mine ? "Give the joystick back" : run.joystick === "free" ? "Take the joystick" : "Another page has the joystick";
    by("take").disabled = !maySteer || run.ended || (!this.mine && run.joystick !== "free");
    by("acknowledge").disabled = !this.mine;
    by("stop").disabled = !maySteer || (run.stop && !this.mine);
    by("stop").title = run.stop && !this.mine ? "who has the joystick releases it" : "";
    by("stop").setAttribute("aria-pressed", run.stop);
    by("stop").textContent = run.stop ? (this.mine ? "STOPPED: PULL TO RELEASE" : "STOPPED") : "EMERGENCY STOP";
    by("pause").textContent = run.paused ? "Go on" : "Pause";
    for (const id of ["pause", "cycle", "pace", "save", "anew"]) by(id).disabled = !maySteer || (run.ended && id !== "save" && id !== "anew");
    by("cycle").disabled ||= !run.paused;
    if (document.activeElement !== by("pace")) by("pace").value = String(run.speed);
    this.lever.classList.toggle("off", !this.mine);
    for (const id of ["pause", "cycle"]) by(id).hidden = !run.lockstep;
    by("pace").parentElement.hidden = !run.lockstep;
    by("compensation_label").hidden = run.play_compensation === null;
    if (run.folder !== this.folder || run.play_compensation !== this.compensation) by("compensation").checked = run.play_compensation === true;
    this.switchable = run.is_switchable && !run.ended;  // else the box is for the next run
    by("compensation").disabled = !maySteer;
    by("compensation_label").title = this.switchable ? "switched at once" : "of the run that is started anew";
    this.folder = run.folder;
    this.compensation = run.play_compensation;
    this.updateSwitches("fault", "faults", run.faults, maySteer && !run.ended);
    this.updateSwitches("effect", "effects", run.effects, maySteer && !run.ended);
  }

  // Boxes for what a page may switch: of faults, or of the machine's effects.
  updateSwitches(kind, title, switches, enabled) {
    const place = document.getElementById(title), names = switches.map((each) => each.name).join();
    this.names ??= {};
    this.on ??= {};
    if (names !== this.names[kind]) {
      this.names[kind] = names;
      const legend = document.createElement("legend");
      legend.textContent = title;
      place.replaceChildren(legend, ...switches.map((each) => {
        const label = document.createElement("label"), box = document.createElement("input");
        box.type = "checkbox";
        box.id = `${kind}_${each.name}`;
        box.addEventListener("change", () => this.send({type: kind, name: each.name, on: box.checked}));
        label.append(box, each.label);
        return label;
      }));
    }
    place.hidden = switches.length === 0;
    for (const each of switches) {
      const box = document.getElementById(`${kind}_${each.name}`);
      box.disabled = !enabled;
      if (box.checked !== each.on && this.on[kind]?.[each.name] !== each.on) box.checked = each.on;
    }
    this.on[kind] = Object.fromEntries(switches.map((each) => [each.name, each.on]));
  }
}
