// The crane's picture: from above, from the side, and the teeth of every gearbox in their backlash.
"use strict";

class CranePicture {
  constructor() {
    this.above = document.getElementById("above");
    this.side = document.getElementById("side");
    this.teeth = document.getElementById("teeth");
    this.exaggeration = document.getElementById("exaggeration");
    this.viewpoint = document.getElementById("viewpoint");
  }

  canvas(element) {
    const ratio = devicePixelRatio || 1, width = element.clientWidth, height = element.clientHeight;
    if (element.width !== Math.round(width * ratio) || element.height !== Math.round(height * ratio)) {
      element.width = Math.round(width * ratio);
      element.height = Math.round(height * ratio);
    }
    const context = element.getContext("2d");
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.clearRect(0, 0, width, height);
    context.lineCap = "round";
    context.font = "11px system-ui, Arial, sans-serif";
    return {context, width, height};
  }

  // `crane`: [{facts, pose}], the first drawn in full, a second one thin.
  draw(cranes) {
    const factor = Math.max(1, Number(this.exaggeration.value) || 1);
    const above = this.canvas(this.above), side = this.canvas(this.side), teeth = this.canvas(this.teeth);
    cranes.forEach((crane, number) => {
      if (!crane.pose || crane.facts.is_axis) return;
      const lacks = this.lacks(crane);
      if (lacks) {
        for (const view of [above, side]) {
          view.context.fillStyle = colour("faint");
          this.write(view, (number ? "second log: " : "") + lacks, number ? (this.lacks(cranes[0]) ? 46 : 30) : 14);
        }
        return;
      }
      const shape = this.shape(crane, factor);
      this.drawAbove(above, crane, shape, number);
      this.drawSide(side, crane, shape, number);
    });
    if (cranes.length && cranes[0].pose) this.drawTeeth(teeth, cranes[0]);
    if (cranes.some((crane) => crane.pose && this.lacks(crane) === "")) for (const view of [above, side]) {
      view.context.fillStyle = colour("faint");
      view.context.fillText(`deflection × ${factor}`, 6, 14);
    }
  }

  // Words from a height on, in as many lines as the picture's width takes.
  write({context, width}, words, top) {
    let line = "";
    for (const word of words.split(" ")) {
      const longer = line ? `${line} ${word}` : word;
      if (line && context.measureText(longer).width > width - 12) {
        context.fillText(line, 6, top);
        top += 14;
        line = word;
      } else line = longer;
    }
    context.fillText(line, 6, top);
  }

  // What a picture of the crane needs and the log does not tell.
  lacks(crane) {
    if (!crane.facts.geometry) return "the crane's shape is not in this log";
    return crane.pose.angle === null ? "the slew angle is not in this log at this time" : "";
  }

  // Points of boom, rope and load in metres: x to the right, y ahead, z up. The boom points ahead at angle 0 and turns to the
  // right where the angle rises, as the lever goes.
  shape(crane, factor) {
    const pose = crane.pose, angle = pose.angle ?? 0;
    if (!crane.facts.geometry) return {reach: 1, boom: [[0, 0, 0], [Math.sin(angle), Math.cos(angle), 0]], load: [], angle};
    const geometry = {...crane.facts.geometry};  // of the file; a crane that luffs or hoists says where it stands
    for (const name of ["boom_angle", "rope_length"]) geometry[name] = pose.motion?.[name] ?? geometry[name];
    const level = geometry.boom_length * Math.cos(geometry.boom_angle), up = geometry.boom_length * Math.sin(geometry.boom_angle);
    const place = (radius, lateral, height) => [radius * Math.sin(angle) + lateral * Math.cos(angle), radius * Math.cos(angle) - lateral * Math.sin(angle), height];
    const deflection = (pose.deflection ?? 0) * factor, boom = [];
    for (let i = 0; i <= 12; ++i) {
      const s = i / 12;  // a cantilever under a force at its tip: what of the shape the tip's displacement alone tells
      boom.push(place(geometry.pivot_radius + level * s, deflection * s * s * (3 - s) / 2, up * s));
    }
    const radius = geometry.pivot_radius + level, load = [boom[12]];
    const rope = geometry.rope_length * Math.sin(pose.rope ?? 0), rod = geometry.rod_length * Math.sin(pose.rod ?? 0);
    if (geometry.rope_length > 0) load.push(place(radius, deflection + rope, up - geometry.rope_length));
    if (geometry.rod_length > 0) load.push(place(radius, deflection + rope + rod, up - geometry.rope_length - geometry.rod_length));
    return {reach: radius, up, low: Math.min(0, up - geometry.rope_length - geometry.rod_length), boom, rigid: [place(geometry.pivot_radius, 0, 0), place(radius, 0, up)], load, angle};
  }

  stroke(context, points, style, width, dash) {
    context.strokeStyle = style; context.lineWidth = width; context.setLineDash(dash ?? []);
    context.beginPath();
    points.forEach(([x, y], i) => i ? context.lineTo(x, y) : context.moveTo(x, y));
    context.stroke();
    context.setLineDash([]);
  }

  drawAbove({context, width, height}, crane, shape, number) {
    const scale = 0.46 * Math.min(width, height) / shape.reach;
    const at = ([x, y]) => [width / 2 + x * scale, height / 2 - y * scale];
    const ink = colour(number ? "grey" : "text");
    if (!number) {
      context.strokeStyle = colour("grid"); context.lineWidth = 1;
      context.beginPath(); context.arc(width / 2, height / 2, shape.reach * scale, 0, 2 * Math.PI); context.stroke();
    }
    if (shape.rigid) this.stroke(context, shape.rigid.map(at), colour("grey"), 1, [4, 4]);
    this.stroke(context, [at([0, 0]), ...shape.boom.map(at)], ink, number ? 1.5 : 3);
    if (shape.load.length > 1) {
      this.stroke(context, shape.load.map(at), colour(number ? "grey" : 1), 1.5);
      const [x, y] = at(shape.load[shape.load.length - 1]);
      context.fillStyle = colour(number ? "grey" : 1); context.beginPath(); context.arc(x, y, number ? 3 : 5, 0, 2 * Math.PI); context.fill();
    }
    context.fillStyle = ink; context.beginPath(); context.arc(width / 2, height / 2, number ? 3 : 7, 0, 2 * Math.PI); context.fill();
  }

  drawSide({context, width, height}, crane, shape, number) {
    const up = shape.up ?? 0, low = shape.low ?? 0, reach = shape.reach;
    const scale = Math.min(0.9 * width / (2 * reach), 0.76 * height / Math.max(up - low, 0.1 * reach));
    const ground = 16 + up * scale + 0.09 * height;
    const along = this.viewpoint.value === "along", c = Math.cos(shape.angle), s = Math.sin(shape.angle);
    const at = ([x, y, z]) => [width / 2 + (along ? x * c - y * s : x) * scale, ground - z * scale];
    const ink = colour(number ? "grey" : "text");
    if (!number) this.stroke(context, [[8, ground], [width - 8, ground]], colour("grid"), 1);
    this.stroke(context, [at([0, 0, 0]), ...shape.boom.map(at)], ink, number ? 1.5 : 3);
    if (shape.load.length > 1) {
      this.stroke(context, shape.load.map(at), colour(number ? "grey" : 1), 1.5);
      const [x, y] = at(shape.load[shape.load.length - 1]);
      context.fillStyle = colour(number ? "grey" : 1); context.fillRect(x - 4, y - 4, 8, 8);
    }
    context.fillStyle = ink; context.fillRect(width / 2 - (number ? 4 : 9), ground - 8, number ? 8 : 18, 8);
  }

  // Of every gearbox the motor's tooth between two teeth of the house: the space is the backlash, what goes beyond is the
  // gears' twist, on the same scale.
  drawTeeth({context, width, height}, crane) {
    const gears = crane.pose.gears, half = crane.facts.half_play;
    if (!gears.length || !(half > 0)) {
      context.fillStyle = colour("faint");
      context.fillText(!gears.length ? "the gears are not in this log" : half === undefined ? "the backlash is not in this log" : "no backlash in this machine", 8, 20);
      return;
    }
    const gear = crane.facts.gear;
    const row = (height - 4) / gears.length, middle = width / 2, space = Math.min(70, 0.16 * width), tooth = 30, text = 15;
    const most = (middle - tooth / 2 - 30) / space;  // that leaves room for the tooth and the one that it pushes
    gears.forEach((deflection, group) => {
      if (deflection === null) return;
      const top = 2 + group * row + text, size = Math.max(4, Math.min(row - text - 4, 34));
      const place = Math.max(-most, Math.min(most, deflection / half)) * space;
      const touching = Math.abs(deflection) >= half;
      context.fillStyle = colour("line");
      const push = touching ? place - Math.sign(place) * space : 0;
      for (const sideways of [-1, 1]) context.fillRect(middle + sideways * (space + tooth / 2 + 14) - 14 + (Math.sign(place) === sideways ? push : 0), top, 28, size);
      context.fillStyle = touching ? colour(group) : colour("grey");
      context.fillRect(middle + place - tooth / 2, top, tooth, size);
      context.fillStyle = colour("text");
      const torque = crane.pose.gear_torques[group];
      context.fillText(`${group + 1}: ${touching ? (deflection > 0 ? "+" : "−") + " flank" : "free"}`, 6, top - 4);
      if (torque !== null && torque !== undefined) {
        context.textAlign = "right";
        context.fillText(`${(torque * gear.scale).toFixed(3)} ${gear.unit}`, width - 6, top - 4);
        context.textAlign = "left";
      }
    });
  }
}
