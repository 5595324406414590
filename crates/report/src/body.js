"use strict";
// The body to look into: the object in #data (body.rs) drawn on a canvas. Numbers first, then the picture, then hands.

/** The bytes of a base64 text. */
function bytes(text) {
  return Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0)).buffer;
}

/** The body of the embedded object: an array of numbers a field, corners of triangles and ends of lines as indices. */
function decoded(data) {
  const numbers = ({ scale, base64 }, shift) => Float64Array.from(new Float32Array(bytes(base64)), (v) => shift + v * scale);
  const body = { x: numbers(data.x, data.origin[0]), y: numbers(data.y, data.origin[1]), magnification: data.magnification };
  for (const name of ["ux", "uy", "xx", "yy", "xy", "mises"]) body[name] = numbers(data[name], 0);
  body.walls = data.walls.map((w) => [numbers(w.x, data.origin[0]), numbers(w.y, data.origin[1]), numbers(w.gx, 0), numbers(w.gy, 0)]);
  for (const name of ["triangles", "outline"]) body[name] = new Uint16Array(bytes(data[name]));
  return body;
}

/** Both principal stresses, the larger one first. */
function principal(xx, yy, xy) {
  const mean = (xx + yy) / 2, radius = Math.hypot((xx - yy) / 2, xy);
  return [mean + radius, mean - radius];
}

/** The fields to choose from: name, value at point i. */
const FIELDS = [
  ["von Mises stress", (b, i) => b.mises[i]],
  ["stress xx", (b, i) => b.xx[i]],
  ["stress yy", (b, i) => b.yy[i]],
  ["stress xy", (b, i) => b.xy[i]],
  ["larger principal stress", (b, i) => principal(b.xx[i], b.yy[i], b.xy[i])[0]],
  ["smaller principal stress", (b, i) => principal(b.xx[i], b.yy[i], b.xy[i])[1]],
  ["displacement", (b, i) => Math.hypot(b.ux[i], b.uy[i])],
  ["displacement along x", (b, i) => b.ux[i]],
  ["displacement along y", (b, i) => b.uy[i]],
];

/** Points moved by their displacements times a factor. */
function moved(body, factor) {
  return [body.x.map((x, i) => x + factor * body.ux[i]), body.y.map((y, i) => y + factor * body.uy[i])];
}

/** Barycentric weights of the point (qx, qy) in a triangle of points (x, y). */
function weights(x, y, [a, b, c], qx, qy) {
  const area = (x[b] - x[a]) * (y[c] - y[a]) - (x[c] - x[a]) * (y[b] - y[a]);
  const second = ((qx - x[a]) * (y[c] - y[a]) - (x[c] - x[a]) * (qy - y[a])) / area;
  const third = ((x[b] - x[a]) * (qy - y[a]) - (qx - x[a]) * (y[b] - y[a])) / area;
  return [1 - second - third, second, third];
}

/** The triangle around a point, the last one that is drawn there, with its weights; null outside of the body. */
function find(triangles, x, y, qx, qy) {
  for (let k = triangles.length - 3; k >= 0; k -= 3) {
    const corners = triangles.subarray(k, k + 3), w = weights(x, y, corners, qx, qy);
    if (w.every((part) => part >= -1e-9)) return { corners, w };
  }
  return null;
}

/** The linear interpolant of values at the corners. */
function interpolated(values, { corners, w }) {
  return corners.reduce((sum, corner, k) => sum + w[k] * values[corner], 0);
}

/** The area of the triangles around each of some points. */
function areas({ x, y, triangles }) {
  const all = new Float64Array(x.length);
  for (let t = 0; t < triangles.length; t += 3) {
    const [a, b, c] = triangles.subarray(t, t + 3);
    const area = Math.abs((x[b] - x[a]) * (y[c] - y[a]) - (y[b] - y[a]) * (x[c] - x[a]));
    for (const point of [a, b, c]) all[point] += area;
  }
  return all;
}

/**
 * The interval of the colours: that of all finite values, from 0 where they are positive and vary much. Where those of 2 % of the
 * weight are far beyond all others, as at the tip of a crack, it goes half of the others' spread beyond them.
 */
function interval(values, weights = values.map(() => 1)) {
  const sorted = Array.from(values.keys()).filter((i) => Number.isFinite(values[i])).sort((i, j) => values[i] - values[j]);
  if (sorted.length === 0) return [0, 1];
  const whole = sorted.reduce((sum, i) => sum + weights[i], 0);
  const at = (part) => {
    let sum = 0;
    return values[sorted.find((i) => (sum += weights[i]) >= part * whole) ?? sorted[sorted.length - 1]];
  };
  let [low, high] = [values[sorted[0]], values[sorted[sorted.length - 1]]];
  const spread = at(0.99) - at(0.01);
  if (high - low > 4 * spread && spread > 0) {
    low = Math.max(low, at(0.01) - spread / 2);
    high = Math.min(high, at(0.99) + spread / 2);
  }
  if (low >= 0 && low < 0.5 * high) low = 0;
  return high > low ? [low, high] : [low - 0.5 * (Math.abs(low) || 1), low + 0.5 * (Math.abs(low) || 1)];
}

/** Viridis, whose lightness rises. */
const STOPS = ["440154", "472d7b", "3b528b", "2c728e", "21918c", "28ae80", "5ec962", "addc30", "fde725"];

/** 256 colours as the four bytes of a pixel. */
function palette() {
  const channel = (stop, c) => parseInt(STOPS[stop].slice(2 * c, 2 * c + 2), 16);
  return Uint32Array.from({ length: 256 }, (_, k) => {
    const at = (k / 255) * (STOPS.length - 1), stop = Math.min(Math.floor(at), STOPS.length - 2), part = at - stop;
    const [r, g, b] = [0, 1, 2].map((c) => Math.round((1 - part) * channel(stop, c) + part * channel(stop + 1, c)));
    return (255 << 24) | (b << 16) | (g << 8) | r;
  });
}

/** Fills the triangles of points (x, y), in pixels, with the colours of their values; one with a NaN stays as it is. */
function paint(pixels, width, height, triangles, x, y, values, [low, high], colours) {
  for (let k = 0; k < triangles.length; k += 3) {
    const corners = triangles.subarray(k, k + 3), [a, b, c] = corners;
    if (Number.isNaN(values[a] + values[b] + values[c])) continue;
    const first = Math.max(0, Math.ceil(Math.min(y[a], y[b], y[c]) - 0.5));
    const last = Math.min(height - 1, Math.floor(Math.max(y[a], y[b], y[c]) - 0.5));
    for (let row = first; row <= last; row++) {
      // the row's middle meets two or three sides between left and right
      let left = Infinity, right = -Infinity;
      for (const [p, q] of [[a, b], [b, c], [c, a]]) {
        const s = (row + 0.5 - y[p]) / (y[q] - y[p]);
        if (!(s >= 0 && s <= 1)) continue;
        left = Math.min(left, x[p] + s * (x[q] - x[p]));
        right = Math.max(right, x[p] + s * (x[q] - x[p]));
      }
      const begin = Math.max(0, Math.ceil(left - 0.5)), end = Math.min(width - 1, Math.floor(right - 0.5));
      if (begin > end) continue;
      const at = (column) => {
        const w = weights(x, y, corners, column + 0.5, row + 0.5);
        return (255.99 * (w[0] * values[a] + w[1] * values[b] + w[2] * values[c] - low)) / (high - low);
      };
      const start = at(begin), slope = begin < end ? (at(end) - start) / (end - begin) : 0;
      for (let column = begin; column <= end; column++) {
        pixels[row * width + column] = colours[Math.max(0, Math.min(255, start + slope * (column - begin))) | 0];
      }
    }
  }
}

/** A number with five digits. */
function told(value) {
  return Number.isFinite(value) ? String(Number(value.toPrecision(5))).replace("-", "−") : "infinite";
}

/** What is told of a point of the body. */
function words(body, place) {
  const at = (name) => interpolated(body[name], place);
  const [ux, uy, xx, yy, xy] = ["ux", "uy", "xx", "yy", "xy"].map(at), [larger, smaller] = principal(xx, yy, xy);
  return [
    `point of the undeformed body: x = ${told(at("x"))}, y = ${told(at("y"))}`,
    `displacement: along x ${told(ux)}, along y ${told(uy)}, in all ${told(Math.hypot(ux, uy))}`,
    `stress: xx ${told(xx)}, yy ${told(yy)}, xy ${told(xy)}`,
    `principal stresses: ${told(larger)}, ${told(smaller)}`,
    `von Mises stress: ${told(at("mises"))}`,
  ].join("\n");
}

/** Smallest and largest of some numbers. */
function ends(all) {
  return [all.reduce((a, b) => Math.min(a, b)), all.reduce((a, b) => Math.max(a, b))];
}

const get = (id) => document.getElementById(id);

/** The picture on the canvas: a body, what is drawn of it and from where. */
class Picture {
  constructor(body, canvas) {
    this.body = body;
    this.canvas = canvas;
    this.context = canvas.getContext("2d");
    this.colours = palette();
    this.weights = areas(body);
    /** The colours as pixels, null where they have to be painted again. */
    this.painted = null;
    /** The point that is looked at. */
    this.place = null;
    this.waiting = false;
  }

  /** Pixels of the canvas for each pixel of the page. */
  get density() {
    return this.canvas.width / this.canvas.clientWidth;
  }
  get middle() {
    return [this.canvas.width / 2, this.canvas.height / 2];
  }
  across(v) {
    return this.canvas.width / 2 + (v - this.view.x) * this.view.scale;
  }
  down(v) {
    return this.canvas.height / 2 - (v - this.view.y) * this.view.scale;
  }

  /** Shows all of the body. View: the point in the middle, pixels for each unit of length. */
  whole() {
    const { canvas } = this, [[left, right], [bottom, top]] = [ends(this.x), ends(this.y)];
    const scale = 0.92 * Math.min(canvas.width / (right - left), canvas.height / (top - bottom));
    this.view = { x: (left + right) / 2, y: (bottom + top) / 2, scale, least: scale / 4, most: scale * 1e5 };
    this.redraw();
  }
  resize() {
    const { canvas } = this, ratio = Math.min(window.devicePixelRatio || 1, 2), before = canvas.width;
    [canvas.width, canvas.height] = [canvas.clientWidth, canvas.clientHeight].map((n) => Math.max(1, Math.round(n * ratio)));
    if (this.view) for (const name of ["scale", "least", "most"]) this.view[name] *= canvas.width / before;
    else this.whole();
    this.redraw();
  }
  pan(dx, dy) {
    this.view.x -= dx / this.view.scale;
    this.view.y += dy / this.view.scale;
    this.redraw();
  }
  /** Brings what is at a pixel closer, or farther away. */
  zoom(by, [px, py] = this.middle) {
    const { view } = this, scale = Math.min(view.most, Math.max(view.least, view.scale * by));
    const [dx, dy] = [px - this.canvas.width / 2, py - this.canvas.height / 2];
    view.x += dx / view.scale - dx / scale;
    view.y -= dy / view.scale - dy / scale;
    view.scale = scale;
    this.redraw();
  }

  /** Displacements are drawn so many times as large. */
  deform(factor) {
    this.factor = factor;
    [this.x, this.y] = moved(this.body, factor);
    get("factor").textContent = `drawn ${told(factor)} times as large`;
    this.redraw();
  }
  /** The colours are those of a field. */
  choose([name, value]) {
    this.values = this.body.x.map((_, i) => value(this.body, i));
    this.range = interval(this.values, this.weights);
    const [low, high] = this.range, [least, most] = ends([low, high, ...this.values.filter(Number.isFinite)]);
    get("name").textContent = name;
    get("low").textContent = told(low) + (least < low ? ` (to ${told(least)})` : "");
    get("high").textContent = told(high) + (most > high ? ` (to ${told(most)})` : "");
    this.redraw();
  }
  /** Tells of the point at a pixel. */
  look([px, py]) {
    const { view } = this, [dx, dy] = [px - this.canvas.width / 2, py - this.canvas.height / 2];
    this.place = find(this.body.triangles, this.x, this.y, view.x + dx / view.scale, view.y - dy / view.scale);
    get("told").textContent = this.place ? words(this.body, this.place) : "outside of the body";
    this.redraw(false);
  }

  /** Draws soon; the colours are painted again unless nothing but the point that is looked at has changed. */
  redraw(again = true) {
    if (again) this.painted = null;
    if (!this.waiting) requestAnimationFrame(() => this.draw());
    this.waiting = true;
  }
  draw() {
    this.waiting = false;
    const { body, context, canvas: { width, height } } = this;
    if (!this.painted) {
      this.painted = context.createImageData(width, height);
      const pixels = new Uint32Array(this.painted.data.buffer), [x, y] = [this.x.map((v) => this.across(v)), this.y.map((v) => this.down(v))];
      paint(pixels, width, height, body.triangles, x, y, this.values, this.range, this.colours);
    }
    context.putImageData(this.painted, 0, 0);
    const style = getComputedStyle(document.body), [quiet, text] = ["--quiet", "--text"].map((name) => style.getPropertyValue(name));
    this.outline(body.x, body.y, quiet, [5, 4]);
    this.outline(this.x, this.y, text, []);
    for (const [x, y, gx, gy] of body.walls) {
      context.beginPath();
      x.forEach((v, i) => context.lineTo(this.across(v + this.factor * gx[i]), this.down(y[i] + this.factor * gy[i])));
      this.stroke(quiet, 3, []);
    }
    if (!this.place) return;
    for (const [colour, size] of [["#000", 7], ["#fff", 5]]) {
      context.beginPath();
      context.arc(this.across(interpolated(this.x, this.place)), this.down(interpolated(this.y, this.place)), size * this.density, 0, 2 * Math.PI);
      this.stroke(colour, 2, []);
    }
  }
  outline(x, y, colour, dash) {
    const { context, body } = this;
    context.beginPath();
    for (let k = 0; k < body.outline.length; k += 2) {
      const [a, b] = body.outline.subarray(k, k + 2);
      context.moveTo(this.across(x[a]), this.down(y[a]));
      context.lineTo(this.across(x[b]), this.down(y[b]));
    }
    this.stroke(colour, 1, dash);
  }
  stroke(colour, width, dash) {
    const { context, density } = this;
    context.setLineDash(dash.map((length) => length * density));
    context.strokeStyle = colour;
    context.lineWidth = width * density;
    context.stroke();
  }
}

/** Pointers: one drags, two bring closer, one that hovers or taps looks. */
function pointers(picture) {
  const { canvas } = picture, held = new Map();
  let travelled = 0;
  const pixel = (event) => {
    const box = canvas.getBoundingClientRect();
    return [event.clientX - box.left - canvas.clientLeft, event.clientY - box.top - canvas.clientTop].map((v) => v * picture.density);
  };
  const two = () => {
    const [[a, b], [c, d]] = held.values();
    return { apart: Math.hypot(a - c, b - d), between: [(a + c) / 2, (b + d) / 2] };
  };
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    if (held.size === 0) travelled = 0;
    held.set(event.pointerId, pixel(event));
  });
  canvas.addEventListener("pointermove", (event) => {
    const to = pixel(event), from = held.get(event.pointerId);
    if (!from) return picture.look(to);
    const before = held.size === 2 ? two().apart : 0;
    held.set(event.pointerId, to);
    const [dx, dy] = [to[0] - from[0], to[1] - from[1]];
    travelled += Math.hypot(dx, dy);
    picture.pan(dx / held.size, dy / held.size);
    if (before > 0) picture.zoom(two().apart / before, two().between);
  });
  for (const name of ["pointerup", "pointercancel"]) {
    canvas.addEventListener(name, (event) => {
      if (name === "pointerup" && held.size === 1 && travelled < 6 * picture.density) picture.look(pixel(event));
      held.delete(event.pointerId);
    });
  }
  const wheel = (event) => {
    event.preventDefault();
    picture.zoom(Math.exp(-0.0015 * event.deltaY * (event.deltaMode === 1 ? 20 : 1)), pixel(event));
  };
  canvas.addEventListener("wheel", wheel, { passive: false });
}

/** Keys of the canvas; the numbers that are told are those in its middle. */
function keyboard(picture) {
  const step = () => 40 * picture.density;
  const keys = {
    ArrowLeft: () => picture.pan(step(), 0),
    ArrowRight: () => picture.pan(-step(), 0),
    ArrowUp: () => picture.pan(0, step()),
    ArrowDown: () => picture.pan(0, -step()),
    "+": () => picture.zoom(1.25),
    "=": () => picture.zoom(1.25),
    "-": () => picture.zoom(0.8),
    0: () => picture.whole(),
  };
  picture.canvas.addEventListener("keydown", (event) => {
    if (!keys[event.key] || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    keys[event.key]();
    picture.look(picture.middle);
  });
}

function start() {
  const picture = new Picture(decoded(JSON.parse(get("data").textContent)), get("canvas"));
  const choose = () => picture.choose(FIELDS[get("field").value]);
  const deform = () => picture.deform((picture.body.magnification * get("magnification").value) / 100);
  get("closer").addEventListener("click", () => picture.zoom(1.5));
  get("farther").addEventListener("click", () => picture.zoom(1 / 1.5));
  get("whole").addEventListener("click", () => picture.whole());
  get("field").addEventListener("change", choose);
  get("magnification").addEventListener("input", deform);
  window.addEventListener("resize", () => picture.resize());
  window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => picture.redraw(false));
  pointers(picture);
  keyboard(picture);

  get("field").append(...FIELDS.map(([name], k) => new Option(name, k)));
  get("colours").style.background = `linear-gradient(to right, ${STOPS.map((stop) => "#" + stop).join(", ")})`;
  get("told").textContent = "point at the body, or tap it";
  get("interactive").hidden = false;
  if (get("static")) get("static").hidden = true;
  deform();
  choose();
  picture.resize();
}

if (typeof document !== "undefined") start();
