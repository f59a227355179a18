// Plays the episodes in the element #scenes, side by side and in step, on one canvas each.

/** @typedef {{shape: number[], quantum: number, data: string}} Packed */

const ACTIVE = 0,
  ARRIVED = 1;
const BEYOND = 1e6; // [m] a place farther out is that of an absent obstacle
const TRAIL = 6; // [s] length of the trail behind an agent
const POINTS = 40000; // of whole trails, at most
const NUMBERED = 12; // agents have their numbers at any size if there are no more than these
const FLASH = 0.6; // [s] that a contact stays marked after its end
const CROWD = 200; // with more agents, trails are short, goals are dots, and headings are not drawn

const colours = getComputedStyle(document.documentElement);
const colour = (name) => colours.getPropertyValue(`--${name}`).trim();

/** @param {Packed} packed @return {Promise<Float32Array>} values, time is the last axis */
async function unpack(packed) {
  const bytes = Uint8Array.from(atob(packed.data), (c) => c.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  const planes = new Uint8Array(await new Response(stream).arrayBuffer());
  const size = planes.length / 4;
  const times = packed.shape[0];
  const out = new Float32Array(size);
  let sum = 0;
  for (let i = 0; i < size; i++) {
    const z =
      (planes[i] |
        (planes[i + size] << 8) |
        (planes[i + 2 * size] << 16) |
        (planes[i + 3 * size] << 24)) >>>
      0;
    const step = z & 1 ? -(z >>> 1) - 1 : z >>> 1;
    sum = i % times === 0 ? step : sum + step;
    out[i] = sum * packed.quantum;
  }
  return out;
}

/** @param {object} object @return {Promise<object>} the same with arrays for packed values */
async function unpackAll(object) {
  const entries = Object.entries(object).map(async ([key, value]) => {
    const isPacked = value && typeof value === "object" && "data" in value && "quantum" in value;
    if (isPacked) return [key, Object.assign(await unpack(value), { shape: value.shape })];
    const nested = value && typeof value === "object" && !Array.isArray(value);
    return [key, nested ? await unpackAll(value) : value];
  });
  return Object.fromEntries(await Promise.all(entries));
}

/** @return {HTMLElement} an element with attributes and children; text is never read as HTML */
function element(tag, attributes = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith("on")) made.addEventListener(name.slice(2), value);
    else made.setAttribute(name, value);
  }
  made.append(...children);
  return made;
}

/** A number with digits after the point, without the sign of a zero. */
function withDigits(value, digits) {
  return (Math.abs(value) < 0.5 * 10 ** -digits ? 0 : value).toFixed(digits);
}

/** The area of loops, as a path that is filled by the even-odd rule. */
function outline(shape, bounds, margin) {
  const path = new Path2D();
  if (shape.disc) {
    path.arc(shape.disc[0], shape.disc[1], shape.disc[2], 0, 2 * Math.PI);
    return path;
  }
  let area = 0;
  for (const loop of shape.loops) {
    for (let i = 0; i < loop.length; i += 2) {
      const j = (i + 2) % loop.length;
      area += loop[i] * loop[j + 1] - loop[j] * loop[i + 1];
      if (i === 0) path.moveTo(loop[0], loop[1]);
      else path.lineTo(loop[i], loop[i + 1]);
    }
    path.closePath();
  }
  // A negative area is the outside of a walled arena: fill it up to a frame.
  if (area < 0)
    path.rect(
      bounds[0] - margin,
      bounds[1] - margin,
      bounds[2] - bounds[0] + 2 * margin,
      bounds[3] - bounds[1] + 2 * margin,
    );
  return path;
}

/** One episode: its data, its canvas, and how to draw it at a time. */
class View {
  constructor(scene, replay) {
    this.scene = scene;
    this.replay = replay;
    this.times = scene.position.shape[0];
    this.count = scene.position.shape[1];
    this.canvas = element("canvas", {
      tabindex: "0",
      "aria-label": `Top view: ${scene.navigator} in ${scene.scenario}`,
    });
    this.context = this.canvas.getContext("2d");
    this.caption = element("div", { class: "caption" });
    this.node = element("div", { class: "view" }, this.canvas, this.caption);
    const [x0, y0, x1, y1] = scene.bounds;
    this.margin = 0.015 * Math.max(x1 - x0, y1 - y0);
    this.solids = scene.solids.map((s) => [s.kind, outline(s, scene.bounds, this.margin)]);
    this.bodies = scene.bodies.map((s) => [s.kind, outline(s, scene.bounds, this.margin)]);
    this.map = scene.map?.map((s) => outline(s, scene.bounds, this.margin));
    this.own = new Map(); // agent and number of the change → path of its own map
    this.laws = this.motionPaths();
    this.reset();
    this.listen();
  }

  get duration() {
    return (this.times - 1) * this.scene.dt;
  }

  motionPaths() {
    return this.scene.bodies.map((_, m) => {
      const path = new Path2D();
      for (let k = 0, drawn = 0; k < this.times; k++) {
        if (this.absent(m, k)) continue;
        const [x, y] = this.bodyAt(m, k);
        if (drawn++ === 0) path.moveTo(x, y);
        else path.lineTo(x, y);
      }
      return path;
    });
  }

  reset() {
    this.zoom = 1;
    this.shift = [0, 0];
  }

  /** Value of a series (…, row, time) between two states. */
  value(array, row, k) {
    const low = Math.min(Math.floor(k), this.times - 1),
      high = Math.min(low + 1, this.times - 1);
    const at = row * this.times;
    return array[at + low] + (array[at + high] - array[at + low]) * (k - low);
  }
  at(a, k) {
    return [
      this.value(this.scene.position, 2 * a, k),
      this.value(this.scene.position, 2 * a + 1, k),
    ];
  }
  bodyAt(m, k) {
    const places = this.scene.body_position,
      low = Math.floor(k + 1e-6);
    if (this.absent(m, low) || this.absent(m, low + 1)) k = low;
    return [this.value(places, 2 * m, k), this.value(places, 2 * m + 1, k)];
  }
  /** Whether a moving obstacle is absent, which is written as a place far outside the arena. */
  absent(m, k) {
    const places = this.scene.body_position;
    return [2 * m, 2 * m + 1].some((row) => Math.abs(this.exact(places, row, k)) > BEYOND);
  }
  /** The exact value at the last state, for what must not be interpolated. */
  exact(array, row, k) {
    return array[row * this.times + Math.min(Math.floor(k + 1e-6), this.times - 1)];
  }
  status(a, k) {
    return this.exact(this.scene.status, a, k);
  }
  entered(a, k) {
    return k + 1e-6 >= this.scene.agents.enters[a];
  }
  present(a, k) {
    return this.entered(a, k) && k < this.scene.agents.leaves[a];
  }

  /** Scale [pixels per metre] and origin of the picture. */
  frame() {
    const [x0, y0, x1, y1] = this.scene.bounds,
      m = 2 * this.margin;
    const wide = this.canvas.clientWidth,
      high = this.canvas.clientHeight;
    const scale = this.zoom * Math.min(wide / (x1 - x0 + 2 * m), (high - 30) / (y1 - y0 + 2 * m));
    const x = wide / 2 - scale * (0.5 * (x0 + x1) - this.shift[0]);
    const y = (high + 26) / 2 + scale * (0.5 * (y0 + y1) - this.shift[1]);
    return { scale, x, y };
  }
  toWorld(event) {
    const { scale, x, y } = this.frame();
    return [(event.offsetX - x) / scale, (y - event.offsetY) / scale];
  }

  listen() {
    const pointers = new Map();
    let moved = 0;
    this.canvas.addEventListener(
      "wheel",
      (event) => {
        event.preventDefault();
        this.zoomAt(event, Math.exp(-event.deltaY * 0.0015));
      },
      { passive: false },
    );
    this.canvas.addEventListener("pointerdown", (event) => {
      this.canvas.setPointerCapture(event.pointerId);
      pointers.set(event.pointerId, event);
      moved = 0;
    });
    this.canvas.addEventListener("pointermove", (event) => {
      const before = pointers.get(event.pointerId);
      if (!before) return;
      const others = [...pointers.values()].filter((p) => p.pointerId !== event.pointerId);
      if (others.length) {
        const gap = (p) => Math.hypot(p.offsetX - others[0].offsetX, p.offsetY - others[0].offsetY);
        this.zoomAt(event, gap(event) / Math.max(1, gap(before)));
      } else {
        const { scale } = this.frame();
        this.shift[0] += (event.offsetX - before.offsetX) / scale;
        this.shift[1] -= (event.offsetY - before.offsetY) / scale;
      }
      moved += Math.abs(event.offsetX - before.offsetX) + Math.abs(event.offsetY - before.offsetY);
      pointers.set(event.pointerId, event);
      this.replay.draw();
    });
    const release = (event) => {
      if (pointers.delete(event.pointerId) && event.type === "pointerup" && moved < 6)
        this.click(event);
    };
    this.canvas.addEventListener("pointerup", release);
    this.canvas.addEventListener("pointercancel", release);
  }

  zoomAt(event, factor) {
    const before = this.toWorld(event);
    this.zoom = Math.min(80, Math.max(0.5, this.zoom * factor));
    const after = this.toWorld(event);
    this.shift[0] += after[0] - before[0];
    this.shift[1] += after[1] - before[1];
    this.replay.draw();
  }

  click(event) {
    const [x, y] = this.toWorld(event),
      k = this.replay.time / this.scene.dt;
    let found = -1,
      least = Infinity;
    for (let a = 0; a < this.count; a++) {
      if (!this.entered(a, k)) continue;
      const [ax, ay] = this.at(a, k);
      const gap = Math.hypot(ax - x, ay - y);
      if (gap < least && gap < this.scene.agents.radius[a] + 10 / this.frame().scale)
        [found, least] = [a, gap];
    }
    this.replay.select(this, found);
  }

  draw(time) {
    const k = Math.min(time / this.scene.dt, this.times - 1);
    const ratio = window.devicePixelRatio || 1,
      c = this.context;
    const wide = Math.round(this.canvas.clientWidth * ratio),
      high = Math.round(this.canvas.clientHeight * ratio);
    if (this.canvas.width !== wide || this.canvas.height !== high)
      [this.canvas.width, this.canvas.height] = [wide, high];
    const { scale, x, y } = this.frame();
    c.setTransform(1, 0, 0, 1, 0, 0);
    c.clearRect(0, 0, wide, high);
    c.setTransform(ratio * scale, 0, 0, -ratio * scale, ratio * x, ratio * y);
    const pixel = 1 / scale,
      show = this.replay.show;
    this.drawSolids(c, pixel, k);
    if (show.map && this.map) this.drawMap(c, pixel);
    if (show.own) this.drawOwnMap(c, pixel, k);
    if (show.trails || show.whole) this.drawTrails(c, pixel, k);
    if (show.goals) this.drawGoals(c, pixel, k);
    if (show.senses) this.drawSenses(c, pixel, k);
    this.drawAgents(c, pixel, k);
    this.drawContacts(c, pixel, time);
    if (show.numbers) this.drawNumbers(c, ratio, k);
    this.describe(k);
  }

  drawSolids(c, pixel, k) {
    for (const [kind, path] of this.solids) {
      c.fillStyle = c.strokeStyle = colour(kind === "wall" ? "wall" : "static");
      c.lineWidth = 1.2 * pixel;
      c.fill(path, "evenodd");
      c.stroke(path); // a thin wall has no area
    }
    c.lineWidth = pixel;
    c.strokeStyle = colour("mover");
    c.setLineDash([3 * pixel, 4 * pixel]);
    c.globalAlpha = 0.6;
    for (const path of this.laws) c.stroke(path);
    c.globalAlpha = 1;
    c.setLineDash([]);
    this.bodies.forEach(([kind, path], m) => {
      if (this.absent(m, k)) return;
      const [x, y] =
        kind === "static"
          ? [
              this.exact(this.scene.body_position, 2 * m, k),
              this.exact(this.scene.body_position, 2 * m + 1, k),
            ]
          : this.bodyAt(m, k);
      c.save();
      c.translate(x, y);
      c.fillStyle = colour(kind === "static" ? "static" : "mover");
      c.fill(path, "evenodd");
      c.restore();
    });
  }

  drawMap(c, pixel) {
    c.strokeStyle = "#e6c300";
    c.lineWidth = 2.5 * pixel;
    for (const path of this.map) c.stroke(path);
  }

  /** The map that the chosen agent had made by now. */
  drawOwnMap(c, pixel, k) {
    const chosen = this.replay.selected,
      own = this.scene.own_map;
    if (!own || own.reason || !chosen || chosen.view !== this) return;
    const n = own.agents.indexOf(chosen.agent);
    if (n < 0) return;
    const last = own.changes[n].findLastIndex(([state]) => state <= k + 1e-6),
      key = `${n} ${last}`;
    if (!this.own.has(key)) this.own.set(key, this.ownPath(own, n, last));
    c.strokeStyle = colour("own");
    c.globalAlpha = 0.6;
    c.lineWidth = 7 * pixel; // wider than the edges that are sensed now
    c.stroke(this.own.get(key));
    c.globalAlpha = 1;
  }

  ownPath({ capsules, changes }, n, last) {
    const held = new Set();
    for (const [, added, removed] of changes[n].slice(0, last + 1)) {
      for (const row of removed) held.delete(row);
      for (const row of added) held.add(row);
    }
    const path = new Path2D();
    for (const row of held) {
      const [x0, y0, x1, y1, radius] = capsules[row];
      path.moveTo(x0 + radius, y0);
      if (radius > 0) path.arc(x0, y0, radius, 0, 2 * Math.PI);
      path.moveTo(x0, y0);
      path.lineTo(x1, y1);
    }
    return path;
  }

  /** One path for each colour: a crowd of a thousand stays fast. Trails end with the attempts. */
  drawTrails(c, pixel, k) {
    const isCrowd = this.count > CROWD,
      whole = this.replay.show.whole;
    const length = whole ? Infinity : (isCrowd ? 1 : TRAIL) / this.scene.dt;
    const stride = whole ? Math.ceil((this.count * this.times) / POINTS) : isCrowd ? 2 : 1;
    this.byColour((colour, members) => {
      c.beginPath();
      for (const a of members) {
        if (isCrowd && !whole && !this.present(a, k)) continue;
        const end = Math.min(k, this.scene.agents.last[a]),
          first = Math.max(0, Math.floor(end - length));
        c.moveTo(...this.at(a, first));
        for (let j = first + stride; j < end; j += stride) {
          const row = 2 * a * this.times + j;
          c.lineTo(this.scene.position[row], this.scene.position[row + this.times]);
        }
        c.lineTo(...this.at(a, end));
      }
      c.strokeStyle = colour;
      c.globalAlpha = 0.5;
      c.lineWidth = (isCrowd ? 1 : 2) * pixel;
      c.stroke();
      c.globalAlpha = 1;
    });
  }

  drawGoals(c, pixel, k) {
    const { goal, radius } = this.scene.agents,
      isCrowd = this.count > CROWD;
    this.byColour((colour, members) => {
      c.fillStyle = c.strokeStyle = colour;
      c.beginPath();
      for (const a of members) {
        const r = Math.max(radius[a], 4 * pixel),
          [x, y] = goal[a];
        if (isCrowd && this.status(a, k) === ACTIVE)
          c.rect(x - pixel, y - pixel, 2 * pixel, 2 * pixel);
        if (isCrowd || !this.entered(a, k)) continue;
        c.moveTo(x + r, y);
        c.arc(x, y, r, 0, 2 * Math.PI);
      }
      if (isCrowd) return c.fill(); // a thousand rings are slow
      c.lineWidth = 1.3 * pixel;
      c.setLineDash([4 * pixel, 3 * pixel]);
      c.stroke();
      c.setLineDash([]);
    });
    if (this.hasChosen()) this.drawChosenGoal(c, pixel);
  }

  /** A filled ring: the goal of the chosen agent. */
  drawChosenGoal(c, pixel) {
    const { goal, radius, colour } = this.scene.agents,
      a = this.replay.selected.agent;
    c.beginPath();
    c.arc(...goal[a], Math.max(radius[a], 4 * pixel), 0, 2 * Math.PI);
    c.fillStyle = this.scene.colours[colour[a]];
    c.globalAlpha = 0.35;
    c.fill();
    c.globalAlpha = 1;
    this.ring(c, pixel, goal[a], radius[a]);
  }

  /** The mark of the chosen agent and of its goal. */
  ring(c, pixel, [x, y], radius) {
    c.beginPath();
    c.arc(x, y, radius + 4 * pixel, 0, 2 * Math.PI);
    c.strokeStyle = colour("ink");
    c.lineWidth = 2 * pixel;
    c.stroke();
  }

  hasChosen() {
    const chosen = this.replay.selected;
    return chosen && chosen.agent < this.count && this.replay.sameWorld(chosen.view, this);
  }

  drawAgents(c, pixel, k) {
    const { radius, outline } = this.scene.agents,
      ink = colour("ink");
    this.byColour((colour, members) => {
      const discs = new Path2D(),
        headings = new Path2D(),
        still = new Path2D();
      for (const a of members) {
        if (!this.present(a, k)) continue;
        const [x, y] = this.at(a, k),
          r = radius[a];
        const over = this.status(a, k) !== ACTIVE;
        const path = over ? still : discs;
        const shape = outline?.[a],
          heading = this.value(this.scene.heading, a, k);
        if (shape) this.addOutline(path, shape, x, y, heading);
        else {
          path.moveTo(x + r, y);
          path.arc(x, y, r, 0, 2 * Math.PI);
        }
        if (this.count > CROWD) continue;
        const ahead = shape ? 1.2 * shape[0] : 1.6 * r;
        headings.moveTo(x, y);
        headings.lineTo(x + ahead * Math.cos(heading), y + ahead * Math.sin(heading));
      }
      c.fillStyle = c.strokeStyle = colour;
      c.fill(discs);
      c.lineWidth = 1.5 * pixel;
      c.stroke(still);
      c.strokeStyle = ink;
      c.stroke(headings);
    });
    this.drawLost(c, pixel, k);
    const a = this.replay.selected?.agent;
    if (this.hasChosen() && this.present(a, k)) {
      this.ring(c, pixel, this.at(a, k), radius[a]);
    }
  }

  /** The outline of a body that is not a disc: x, y of its corners, turned by its heading. */
  addOutline(path, shape, x, y, heading) {
    const cos = Math.cos(heading),
      sin = Math.sin(heading);
    for (let n = 0; n < shape.length; n += 2) {
      const px = x + cos * shape[n] - sin * shape[n + 1],
        py = y + sin * shape[n] + cos * shape[n + 1];
      if (n === 0) path.moveTo(px, py);
      else path.lineTo(px, py);
    }
    path.closePath();
  }

  /** A cross where an agent vanished without arrival. */
  drawLost(c, pixel, k) {
    if (this.count > CROWD) return;
    const { radius, last } = this.scene.agents;
    this.byColour((colour, members) => {
      c.beginPath();
      for (const a of members) {
        if (!this.entered(a, k) || this.present(a, k) || this.status(a, k) === ARRIVED) continue;
        const [x, y] = this.at(a, last[a]),
          r = Math.max(0.6 * radius[a], 4 * pixel);
        c.moveTo(x - r, y - r);
        c.lineTo(x + r, y + r);
        c.moveTo(x - r, y + r);
        c.lineTo(x + r, y - r);
      }
      c.strokeStyle = colour;
      c.lineWidth = 3 * pixel;
      c.stroke();
    });
  }

  /** Numbers beside agents and on moving obstacles, if they have room. */
  drawNumbers(c, ratio, k) {
    const { scale, x, y } = this.frame(),
      { radius } = this.scene.agents;
    c.setTransform(ratio, 0, 0, ratio, 0, 0);
    c.font = "600 11px system-ui, sans-serif";
    c.textBaseline = "middle";
    c.lineJoin = "round";
    c.lineWidth = 3;
    const write = (text, [wx, wy], away, align) => {
      const px = x + scale * wx + away,
        py = y - scale * wy - away;
      if (px < 0 || py < 0 || px > this.canvas.clientWidth || py > this.canvas.clientHeight) return;
      c.textAlign = align;
      c.strokeStyle = colour("paper");
      c.strokeText(text, px, py);
      c.fillStyle = colour("ink");
      c.fillText(text, px, py);
    };
    for (let m = 0; m < this.bodies.length && scale > 8; m++) {
      const radius = this.scene.bodies[m].disc?.[2] ?? Infinity;
      if (scale * radius >= 8)
        write(String(m + 1), this.bodyAt(m, Math.floor(k + 1e-6)), 0, "center");
    }
    for (let a = 0; a < this.count; a++) {
      const size = scale * radius[a];
      if (this.count > NUMBERED && size < 10) continue;
      if (!this.entered(a, k)) continue;
      if (!this.present(a, k) && this.status(a, k) === ARRIVED) continue;
      write(String(a), this.at(a, k), 0.75 * size + 3, "left");
    }
  }

  drawSenses(c, pixel, k) {
    const chosen = this.replay.selected,
      senses = this.scene.senses;
    if (!senses || !chosen || chosen.view !== this) return;
    const agents = this.scene.charts.agents,
      n = agents.indexOf(chosen.agent);
    if (n < 0 || this.status(chosen.agent, k) !== ACTIVE) return;
    const [x, y] = this.at(chosen.agent, Math.floor(k));
    if (senses.distance) {
      const rays = senses.angle.length,
        heading = this.exact(this.scene.heading, chosen.agent, k);
      c.lineWidth = pixel;
      for (let r = 0; r < rays; r++) {
        const length = this.exact(senses.distance, n * rays + r, k),
          angle = heading + senses.angle[r];
        const hit = this.exact(senses.hit, n * rays + r, k) > 0;
        const ex = x + length * Math.cos(angle),
          ey = y + length * Math.sin(angle);
        c.strokeStyle = colour("soft");
        c.beginPath();
        c.moveTo(x, y);
        c.lineTo(ex, ey);
        c.stroke();
        if (!hit) continue;
        c.fillStyle = colour("hit");
        c.beginPath();
        c.arc(ex, ey, 3 * pixel, 0, 2 * Math.PI);
        c.fill();
      }
    }
    if (senses.edges) {
      const slots = senses.edges.shape[2];
      c.strokeStyle = colour("accent");
      c.lineWidth = 3 * pixel;
      c.beginPath();
      for (let e = 0; e < slots; e++) {
        const row = this.exact(senses.edges, n * slots + e, k);
        if (row < 0) continue;
        const [ax, ay, bx, by] = senses.edge_table[row];
        c.moveTo(ax, ay);
        c.lineTo(bx, by);
      }
      c.stroke();
    }
    if (senses.neighbours) {
      const slots = senses.neighbours.shape[2];
      c.strokeStyle = colour("accent");
      c.lineWidth = 1.5 * pixel;
      c.setLineDash([2 * pixel, 3 * pixel]);
      c.beginPath();
      for (let s = 0; s < slots; s++) {
        const seen = this.exact(senses.neighbours, n * slots + s, k);
        if (seen < 0) continue;
        const [nx, ny] = this.neighbourAt(seen, n * slots + s, k);
        c.moveTo(x, y);
        c.lineTo(nx, ny);
      }
      c.stroke();
      c.setLineDash([]);
    }
  }

  /** Where a neighbour was perceived: with noise, beside its place, or where there is none. */
  neighbourAt(seen, slot, k) {
    const places = this.scene.senses.places;
    if (places) return [0, 1].map((axis) => this.exact(places, 2 * slot + axis, k));
    return seen < this.count
      ? this.at(seen, Math.floor(k))
      : this.bodyAt(seen - this.count, Math.floor(k));
  }

  drawContacts(c, pixel, time) {
    for (const event of this.scene.events) {
      if (event.kind !== "contact" || time < event.time || time > event.end + FLASH) continue;
      const fade = Math.max(0, 1 - Math.max(0, time - event.end) / FLASH),
        k = time / this.scene.dt;
      const [x, y] = this.at(event.agent, k);
      c.globalAlpha = 0.25 + 0.75 * fade;
      c.strokeStyle = colour("hit");
      c.lineWidth = 3 * pixel;
      c.beginPath();
      c.arc(x, y, this.scene.agents.radius[event.agent] + 6 * pixel, 0, 2 * Math.PI);
      if (event.with === "agent" || event.partner < 0) {
        const [px, py] =
          event.with === "agent" ? this.at(event.partner, k) : this.bodyAt(-1 - event.partner, k);
        c.moveTo(x, y);
        c.lineTo(px, py);
      }
      c.stroke();
      c.globalAlpha = 1;
    }
  }

  describe(k) {
    const { evaluated } = this.scene.agents;
    const last = this.times - 1;
    let total = 0,
      arrived = 0,
      final = 0;
    for (let a = 0; a < this.count; a++) {
      if (!evaluated[a]) continue;
      total++;
      if (this.status(a, k) === ARRIVED) arrived++;
      if (this.status(a, last) === ARRIVED) final++;
    }
    const { navigator, scenario, condition, seed } = this.scene;
    const text =
      k >= last
        ? `${final} of ${total} arrived`
        : `${arrived} of ${total} arrived now, ${final} at the end`;
    if (this.caption.dataset.text === text) return;
    this.caption.dataset.text = text;
    const where =
      this.replay.views.length > 1 &&
      this.replay.views[0] !== this &&
      this.replay.sameWorld(this.replay.views[0], this) &&
      this.replay.views[0].scene.condition === condition
        ? ` · ${text}`
        : ` · ${text} · ${scenario} · ${condition} · seed ${seed}`;
    this.caption.replaceChildren(element("b", {}, navigator), element("span", {}, where));
  }

  byColour(action) {
    if (!this.members) {
      this.members = new Map();
      this.scene.agents.colour.forEach((number, a) => {
        const colour = this.scene.colours[number];
        if (!this.members.has(colour)) this.members.set(colour, []);
        this.members.get(colour).push(a);
      });
    }
    for (const [colour, members] of this.members) action(colour, members);
  }
}

/** The page: views, time, controls, events and charts. */
class Replay {
  constructor(scenes, root) {
    this.time = 0;
    this.speed = 1;
    this.playing = false;
    this.selected = null;
    this.show = {
      trails: true,
      whole: false,
      goals: true,
      numbers: true,
      senses: true,
      map: false,
      own: true,
    };
    this.views = scenes.map((scene) => new View(scene, this));
    this.duration = Math.max(...this.views.map((view) => view.duration));
    this.dt = this.views[0].scene.dt;
    this.build(root);
    const first = this.views[0].scene.charts.agents[0];
    this.select(this.views[0], first === undefined ? -1 : first);
    this.readAddress();
    new ResizeObserver(() => this.draw()).observe(this.grid);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.draw());
    document.addEventListener("keydown", (event) => this.key(event));
    this.draw();
  }

  /** The part of the address after #, such as t=4.2&agent=3: where to begin. */
  readAddress() {
    const words = new URLSearchParams(location.hash.slice(1));
    const agent = Number.parseInt(words.get("agent"), 10),
      time = Number.parseFloat(words.get("t"));
    if (agent >= 0 && agent < this.views[0].count) this.select(this.views[0], agent);
    if (Number.isFinite(time)) this.seek(time);
  }

  sameWorld(one, other) {
    return (
      one === other ||
      (one.scene.scenario === other.scene.scenario && one.scene.seed === other.scene.seed)
    );
  }

  build(root) {
    const columns = Math.ceil(Math.sqrt(this.views.length));
    this.grid = element("div", { class: "views", style: `--columns: ${columns}` });
    this.grid.append(...this.views.map((view) => view.node));
    this.side = element("aside", { class: "side" });
    root.append(this.grid, this.side, this.bar(root.dataset.back));
    this.panel = element("div", { class: "panel" });
    this.side.append(this.panel, this.toggles(), ...this.legend(), ...this.eventList());
  }

  bar(back) {
    this.playButton = element(
      "button",
      { class: "play", title: "Space", onclick: () => this.toggle() },
      "Play",
    );
    this.slider = element("input", {
      type: "range",
      min: "0",
      max: String(this.duration),
      step: String(this.dt / 4),
      value: "0",
      "aria-label": "Time",
      oninput: () => {
        this.pause();
        this.seek(Number(this.slider.value));
      },
    });
    this.clock = element("span", { class: "clock" });
    const speeds = element(
      "select",
      {
        "aria-label": "Speed",
        onchange: (e) => {
          this.speed = Number(e.target.value);
        },
      },
      ...[0.25, 0.5, 1, 2, 4, 8].map((s) =>
        element("option", s === 1 ? { value: s, selected: "" } : { value: s }, `${s} ×`),
      ),
    );
    const button = (text, title, action) => element("button", { title, onclick: action }, text);
    return element(
      "div",
      { class: "bar" },
      ...(back ? [element("a", { class: "back", href: back }, "← Report")] : []),
      this.playButton,
      button("−1", "Step back (left arrow)", () => this.step(-1)),
      button("+1", "Step (right arrow)", () => this.step(1)),
      button("Previous", "Previous event (p)", () => this.jump(-1)),
      button("Next", "Next contact, arrival or timeout (n)", () => this.jump(1)),
      speeds,
      element("div", { class: "track" }, this.slider, this.marks()),
      this.clock,
      button("Whole arena", "Reset the view (0)", () => this.resetViews()),
    );
  }

  marks() {
    const marks = this.events()
      .slice(0, 400)
      .map(({ event }) =>
        element("i", {
          class: event.kind,
          style: `left: ${(100 * event.time) / Math.max(this.duration, 1e-9)}%`,
        }),
      );
    return element("div", { class: "marks" }, ...marks);
  }

  toggles() {
    const names = {
      trails: `trails of ${TRAIL} s`,
      whole: "whole trails",
      goals: "goals",
      numbers: "numbers",
      senses: "sensor readings",
      map: "granted map",
      own: "own map",
    };
    const boxes = Object.entries(names).map(([key, text]) => {
      const box = element("input", {
        type: "checkbox",
        onchange: () => {
          this.show[key] = box.checked;
          this.draw();
        },
      });
      box.checked = this.show[key];
      const has = {
        map: (view) => view.map,
        own: (view) => view.scene.own_map && !view.scene.own_map.reason,
      };
      if (has[key]) box.disabled = !this.views.some(has[key]);
      return element("label", {}, box, ` ${text}`);
    });
    return element("div", { class: "toggles" }, ...boxes);
  }

  /** What the lines of the sensor readings mean, for the sensors that there are. */
  legend() {
    const has = (name) => this.views.some((view) => view.scene.senses?.[name]);
    const lines = [
      [
        "distance",
        "ray",
        "ray; it is as wide as the agent, so it ends where the agent would touch",
      ],
      ["distance", "dot", "hit of a ray"],
      ["neighbours", "neighbour", "sensed neighbour"],
      ["edges", "edge", "sensed edge"],
    ].filter(([name]) => has(name));
    if (!lines.length) return [];
    const items = lines.map(([, kind, text]) =>
      element("li", {}, element("i", { class: kind }), element("span", {}, text)),
    );
    const noisy = this.views.filter((view) => view.scene.perception !== "exact");
    const known = noisy.every((view) => view.scene.senses?.noisy);
    const text = `${known ? "With" : "Without"} the noise that the navigator met.`;
    const note = noisy.length ? [element("p", {}, text)] : [];
    const list = element("ul", { class: "legend" }, ...items);
    return [element("h2", {}, "Sensor readings"), ...note, list];
  }

  events() {
    if (!this.sorted) {
      this.sorted = this.views.flatMap((view) =>
        view.scene.events.map((event) => ({ view, event })),
      );
      this.sorted.sort((one, other) => one.event.time - other.event.time);
    }
    return this.sorted;
  }

  eventList() {
    const MOST = 300,
      all = this.events();
    const items = all.slice(0, MOST).map(({ view, event }) =>
      element(
        "li",
        {},
        element(
          "button",
          {
            onclick: () => {
              this.pause();
              this.seek(event.time);
              this.select(view, event.agent ?? event.agents[0]);
            },
          },
          element("time", {}, `${event.time.toFixed(1)} s`),
          element("span", {}, this.sentence(view, event)),
        ),
      ),
    );
    const title = element("h2", {}, "Events");
    const parts = [title, element("ol", {}, ...items)];
    if (all.length > MOST)
      parts.push(element("p", {}, `${all.length - MOST} more events are not listed.`));
    if (!all.length) parts.push(element("p", {}, "No contact, arrival or timeout."));
    for (const view of this.views)
      if (view.scene.failure)
        parts.push(element("p", {}, `${view.scene.navigator} failed: ${view.scene.failure}`));
    return parts;
  }

  sentence(view, event) {
    const name = this.views.length > 1 ? `${view.scene.navigator}: ` : "";
    if (event.kind === "arrival") return `${name}agent ${event.agent} arrives`;
    if (event.kind === "failure") return `${name}the navigator of agent ${event.agent} fails`;
    if (event.kind === "timeout")
      return `${name}time is over for ${event.agents.length === 1 ? "agent" : "agents"} ${event.agents.slice(0, 6).join(", ")}${event.agents.length > 6 ? ", …" : ""}`;
    return `${name}agent ${event.agent} hits ${event.text}${event.charged ? "" : " (not charged)"}`;
  }

  select(view, agent) {
    this.selected = agent === undefined || agent < 0 ? null : { view, agent };
    this.panel.replaceChildren();
    this.charts = [];
    if (!this.selected) {
      this.panel.append(
        element("h2", {}, "No agent chosen"),
        element("p", {}, "Click an agent to see its sensor readings and charts."),
      );
    } else this.describeAgent(view, agent);
    this.draw();
  }

  describeAgent(view, agent) {
    const { agents, charts, senses } = view.scene,
      n = charts.agents.indexOf(agent);
    const result = agents.evaluated[agent]
      ? agents.success[agent]
        ? "Success"
        : "No success"
      : "Not scored";
    const name = this.views.length > 1 ? ` of ${view.scene.navigator}` : "";
    this.panel.append(
      element("h2", {}, `Agent ${agent}${name}`),
      element("p", { class: "result" }, `${result}: ${agents.end[agent]}.`),
      element("p", {}, `Team ${agents.teams[agents.team[agent]]}.`),
    );
    if (n < 0) {
      this.panel.append(
        element(
          "p",
          {},
          `This file holds charts and sensor readings of ${charts.agents.length === 1 ? "agent" : "agents"} ${charts.agents.join(", ")}.`,
        ),
      );
      return;
    }
    const add = (title, unit, array, digits, end) => {
      const output = element("output"),
        canvas = element("canvas");
      const times = view.times;
      const values = array.subarray(n * times, n * times + end + 1);
      const number = (value) => withDigits(value, digits);
      const range = values.reduce(
        ([low, top], v) => [Math.min(low, v), Math.max(top, v)],
        [Infinity, -Infinity],
      );
      this.panel.append(
        element(
          "div",
          { class: "chart" },
          element(
            "div",
            {},
            element("span", {}, `${title}, ${number(range[0])} to ${number(range[1])} ${unit}`),
            output,
          ),
          canvas,
        ),
      );
      this.charts.push({ view, values, range, unit, number, output, canvas });
    };
    // Values after the end of the attempt mean nothing; speeds are those of the next step.
    const end = agents.last[agent],
      before = Math.max(0, end - 1);
    add("speed", "m/s", charts.speed, 2, before);
    add("turn rate", "rad/s", charts.turn, 2, before);
    add("clearance", "m", charts.clearance, 2, end);
    if (senses?.probability) add("collision probability", "", senses.probability, 2, end);
    if (view.scene.own_map?.reason)
      this.panel.append(
        element(
          "p",
          {},
          `The map that the navigator made is not shown: ${view.scene.own_map.reason}.`,
        ),
      );
    if (!senses)
      this.panel.append(
        element(
          "p",
          {},
          "This episode cannot be simulated again, so its sensor readings are unknown.",
        ),
      );
  }

  drawChart(chart) {
    const { view, values, range, canvas, output, unit, number } = chart,
      times = view.times,
      end = values.length - 1;
    const ratio = window.devicePixelRatio || 1,
      wide = canvas.clientWidth,
      high = canvas.clientHeight;
    if (!wide) return;
    canvas.width = wide * ratio;
    canvas.height = high * ratio;
    const c = canvas.getContext("2d"),
      low = Math.min(0, range[0]),
      top = Math.max(range[1], low + 0.1),
      x = (k) => (k / Math.max(1, times - 1)) * (wide - 2) + 1;
    const y = (v) => high - 4 - ((v - low) / (top - low)) * (high - 10);
    c.setTransform(ratio, 0, 0, ratio, 0, 0);
    c.clearRect(0, 0, wide, high);
    c.strokeStyle = colour("line");
    c.beginPath();
    c.moveTo(0, y(0));
    c.lineTo(wide, y(0));
    c.stroke();
    c.strokeStyle = colour("accent");
    c.lineWidth = 1.4;
    c.beginPath();
    for (let k = 0; k <= end; k++)
      if (k === 0) c.moveTo(x(0), y(values[0]));
      else c.lineTo(x(k), y(values[k]));
    c.stroke();
    const k = Math.min(this.time / view.scene.dt, times - 1);
    c.strokeStyle = colour("ink");
    c.beginPath();
    c.moveTo(x(k), 0);
    c.lineTo(x(k), high);
    c.stroke();
    const state = Math.floor(k + 1e-6);
    output.textContent = state > end ? "ended" : `${number(values[state])} ${unit}`;
  }

  toggle() {
    if (this.playing) this.pause();
    else this.play();
  }
  play() {
    if (this.time >= this.duration - 1e-9) this.time = 0;
    this.playing = true;
    this.playButton.textContent = "Pause";
    this.last = null;
    requestAnimationFrame((now) => this.tick(now));
  }
  pause() {
    this.playing = false;
    this.playButton.textContent = "Play";
  }
  tick(now) {
    if (!this.playing) return;
    if (this.last !== null)
      this.time = Math.min(this.duration, this.time + (this.speed * (now - this.last)) / 1000);
    this.last = now;
    if (this.time >= this.duration) this.pause();
    this.draw();
    requestAnimationFrame((next) => this.tick(next));
  }
  seek(time) {
    this.time = Math.min(this.duration, Math.max(0, time));
    this.draw();
  }
  step(by) {
    this.pause();
    this.seek((Math.round(this.time / this.dt) + by) * this.dt);
  }
  jump(way) {
    this.pause();
    const ordered = way > 0 ? this.events() : [...this.events()].reverse();
    const next = ordered.find(({ event }) => way * (event.time - this.time) > 1e-6);
    if (!next) return;
    this.time = next.event.time;
    this.select(next.view, next.event.agent ?? next.event.agents[0]);
  }
  resetViews() {
    for (const view of this.views) view.reset();
    this.draw();
  }

  key(event) {
    if (event.target.matches("input, select, button") && event.key === " ") return;
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const actions = {
      " ": () => this.toggle(),
      ArrowLeft: () => this.step(-1),
      ArrowRight: () => this.step(1),
      n: () => this.jump(1),
      p: () => this.jump(-1),
      0: () => this.resetViews(),
    };
    if (event.target.matches("input[type=range]") && event.key.startsWith("Arrow")) return;
    if (!actions[event.key]) return;
    event.preventDefault();
    actions[event.key]();
  }

  draw() {
    if (!this.charts) return;
    for (const view of this.views) view.draw(this.time);
    for (const chart of this.charts) this.drawChart(chart);
    this.slider.value = String(this.time);
    this.clock.textContent = `${this.time.toFixed(1)} / ${this.duration.toFixed(1)} s`;
  }
}

async function start() {
  const root = document.getElementById("replay");
  if (typeof DecompressionStream === "undefined") {
    root.textContent =
      "This browser is too old to read the replay. Use a browser from 2023 or later.";
    return;
  }
  const scenes = JSON.parse(document.getElementById("scenes").textContent);
  window.replay = new Replay(await Promise.all(scenes.map(unpackAll)), root);
  document.documentElement.dataset.ready = "true";
}
start();
