"use strict";
// A mesh as arrays, and its bitmap: image pixels, y down -> colours of triangles, their edges and outlines, as seen from one place.
//
// A bitmap is drawn a part at a time, so that the page answers meanwhile. What is smaller than a pixel of the screen becomes a dot.

const PART = 20000;    // triangles drawn between two pauses
const FINE = 2.2;      // px of the screen; what is smaller is a dot
const INK = "#15191e", RED = "#e3120b";  // over colours, and over the bare image as in the figures of the paper

/** Read what `packing.pack` wrote: the length of a JSON text, the text, and arrays, each beginning at a multiple of 8. */
function unpack(buffer) {
  const size = new DataView(buffer).getUint32(0, true), head = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, size)));
  const types = { f4: Float32Array, u4: Uint32Array, u2: Uint16Array, u1: Uint8Array }, arrays = {};
  let at = Math.ceil((4 + size) / 8) * 8;
  for (const [name, kind, length] of head.arrays) {
    arrays[name] = new types[kind](buffer, at, length);
    at = Math.ceil((at + arrays[name].byteLength) / 8) * 8;
  }
  return { ...head, ...arrays };
}

/** Bytes of base64, deflated -> an ArrayBuffer. */
function inflate(text) {
  const deflated = Uint8Array.from(atob(text), letter => letter.charCodeAt(0));
  return new Response(new Blob([deflated]).stream().pipeThrough(new DecompressionStream("deflate"))).arrayBuffer();
}

const rgb = hex => [1, 3, 5].map(i => parseInt(hex.slice(i, i + 2), 16));

/** A mesh as `packing` hands it over, with a grid that says which triangles are where. */
class Mesh {
  constructor(packed) {
    Object.assign(this, packed);
    this.count = this.triangles.length / 3;
    this.colours = { region: this.view.regions.map(region => rgb(region.colour)), quality: this.view.ramp.map(rgb), angle: this.view.ramp.map(rgb) };
    this.grid = this.sorted();
  }

  /** Cells of a grid, each with its triangles in one stretch of `order`. */
  sorted() {
    const { vertices: xy, triangles: corners, count } = this, [x0, y0, x1, y1] = this.view.box, w = x1 - x0, h = y1 - y0;
    const side = Math.max(Math.sqrt(w * h / Math.max(count / 48, 1)), Math.max(w, h) / 2000, 1e-9);
    const nx = Math.max(1, Math.ceil(w / side)), ny = Math.max(1, Math.ceil(h / side));
    const cell = new Uint32Array(count), starts = new Uint32Array(nx * ny + 1), order = new Uint32Array(count);
    let reach = 0;
    for (let t = 0; t < count; t++) {
      const a = 2 * corners[3 * t], b = 2 * corners[3 * t + 1], c = 2 * corners[3 * t + 2];
      const x = (xy[a] + xy[b] + xy[c]) / 3, y = (xy[a + 1] + xy[b + 1] + xy[c + 1]) / 3;
      reach = Math.max(reach, Math.abs(xy[a] - x), Math.abs(xy[b] - x), Math.abs(xy[c] - x), Math.abs(xy[a + 1] - y), Math.abs(xy[b + 1] - y), Math.abs(xy[c + 1] - y));
      cell[t] = Math.min(ny - 1, Math.max(0, Math.floor((y - y0) / side))) * nx + Math.min(nx - 1, Math.max(0, Math.floor((x - x0) / side)));
      starts[cell[t] + 1]++;
    }
    for (let i = 0; i < nx * ny; i++) starts[i + 1] += starts[i];
    const next = starts.slice();
    for (let t = 0; t < count; t++) order[next[cell[t]]++] = t;
    return { nx, ny, side, starts, order, reach, x0, y0 };
  }

  /** Triangles that may be seen between two corners. */
  within(left, top, right, bottom) {
    const { nx, ny, side, starts, reach, order, x0, y0 } = this.grid, at = (v, n) => Math.min(n - 1, Math.max(0, Math.floor(v / side)));
    const i0 = at(left - x0 - reach, nx), i1 = at(right - x0 + reach, nx), stretches = [];
    let total = 0;
    for (let j = at(top - y0 - reach, ny); j <= at(bottom - y0 + reach, ny); j++) {
      stretches.push([starts[j * nx + i0], starts[j * nx + i1 + 1]]);
      total += starts[j * nx + i1 + 1] - starts[j * nx + i0];
    }
    const seen = new Uint32Array(total);
    let n = 0;
    for (const [from, to] of stretches) { seen.set(order.subarray(from, to), n); n += to - from; }
    return seen;
  }

  corners(t) { return [0, 1, 2].map(i => { const v = 2 * this.triangles[3 * t + i]; return [this.vertices[v], this.vertices[v + 1]]; }); }

  /** The triangle at a place; or, with `near`, the one whose middle is nearest to it. */
  at(x, y, near = false) {
    let best = -1, least = Infinity;
    for (const t of this.within(x, y, x, y)) {
      const p = this.corners(t), turns = p.map(([ax, ay], i) => { const [bx, by] = p[(i + 1) % 3]; return (bx - ax) * (y - ay) - (by - ay) * (x - ax); });
      if (turns.every(v => v >= 0) || turns.every(v => v <= 0)) return t;
      const far = Math.hypot((p[0][0] + p[1][0] + p[2][0]) / 3 - x, (p[0][1] + p[1][1] + p[2][1]) / 3 - y);
      if (near && far < least) { best = t; least = far; }
    }
    return best;
  }

  /** q = 2 r / R and the smallest angle in degrees of a triangle. */
  measure(t) {
    const p = this.corners(t), angles = p.map(([x, y], i) => {
      const [[ax, ay], [bx, by]] = [p[(i + 1) % 3], p[(i + 2) % 3]].map(v => [v[0] - x, v[1] - y]);
      return Math.atan2(Math.abs(ax * by - ay * bx), ax * bx + ay * by);
    });
    return { q: 8 * angles.reduce((product, angle) => product * Math.sin(angle / 2), 1), angle: Math.min(...angles) * 180 / Math.PI };
  }
}

/** Draws a mesh as it is seen from `at` = { x, y, s, w, h }, a part at a time; the bitmap, or null if `ended()` came true before. */
class Drawing {
  constructor(mesh, at, look) {
    Object.assign(this, { mesh, at, look });
    this.px = x => (x - at.x) * at.s + at.w / 2;
    this.py = y => (y - at.y) * at.s + at.h / 2;
    this.seen = mesh.within(at.x - at.w / 2 / at.s, at.y - at.h / 2 / at.s, at.x + at.w / 2 / at.s, at.y + at.h / 2 / at.s);
    [this.fillings, this.lines] = [0, 1].map(() => Object.assign(document.createElement("canvas"), { width: at.w, height: at.h }).getContext("2d"));
    this.fillings.lineJoin = this.lines.lineJoin = this.lines.lineCap = "round";
    this.fill = look.fill === "none" ? null : mesh[{ region: "regions", quality: "quality", angle: "angle" }[look.fill]];
    this.colours = mesh.colours[look.fill];
  }

  async drawn(ended) {
    if (this.fill) this.dots();
    for (let from = 0; from < this.seen.length; from += PART) {
      if (from) await new Promise(resume => setTimeout(resume));
      if (ended()) return null;
      const part = this.seen.subarray(from, from + PART);
      if (this.fill) this.triangles(part);
      if (this.look.edges) this.edges(part);
    }
    if (this.look.outline) this.outline();
    if (this.look.selected) this.selection();
    // Colours that are read by a scale stay as they are; those of regions let the image through.
    const both = Object.assign(document.createElement("canvas"), { width: this.at.w, height: this.at.h }), context = both.getContext("2d");
    context.globalAlpha = this.look.image && this.look.fill === "region" ? this.look.opacity : 1;
    context.drawImage(this.fillings.canvas, 0, 0);
    context.globalAlpha = 1;
    context.drawImage(this.lines.canvas, 0, 0);
    return both;
  }

  size(t) {
    const { vertices: xy, triangles: corners } = this.mesh, a = 2 * corners[3 * t], b = 2 * corners[3 * t + 1], c = 2 * corners[3 * t + 2];
    return this.at.s * Math.max(Math.abs(xy[a] - xy[b]), Math.abs(xy[b] - xy[c]), Math.abs(xy[c] - xy[a]),
      Math.abs(xy[a + 1] - xy[b + 1]), Math.abs(xy[b + 1] - xy[c + 1]), Math.abs(xy[c + 1] - xy[a + 1]));
  }

  /** Triangles too small to be drawn as such: two by two dots of their colour. */
  dots() {
    const { vertices: xy, triangles: corners } = this.mesh, { w, h } = this.at, { px, py, fill } = this;
    const codes = new Uint32Array(this.colours.map(([r, g, b]) => (255 << 24 | b << 16 | g << 8 | r) >>> 0));
    let data = null, dot = null;
    for (const t of this.seen) {
      if (this.size(t) >= FINE) continue;
      if (!data) { data = this.fillings.createImageData(w, h); dot = new Uint32Array(data.data.buffer); }
      const a = 2 * corners[3 * t], b = 2 * corners[3 * t + 1], c = 2 * corners[3 * t + 2];
      const x = Math.floor(px((xy[a] + xy[b] + xy[c]) / 3)), y = Math.floor(py((xy[a + 1] + xy[b + 1] + xy[c + 1]) / 3));
      if (x < 0 || y < 0 || x >= w - 1 || y >= h - 1) continue;
      dot[y * w + x] = dot[y * w + x + 1] = dot[y * w + w + x] = dot[y * w + w + x + 1] = codes[fill[t]];
    }
    if (data) this.fillings.putImageData(data, 0, 0);
  }

  /** Fill triangles, colour by colour; a thin line of the same colour closes the gap that smoothing leaves between them. */
  triangles(part) {
    const { vertices: xy, triangles: corners } = this.mesh, { px, py, fill, colours, fillings: context } = this;
    const starts = new Uint32Array(colours.length + 1), sorted = new Uint32Array(part.length);
    for (const t of part) starts[fill[t] + 1]++;
    for (let i = 0; i < colours.length; i++) starts[i + 1] += starts[i];
    const next = starts.slice();
    for (const t of part) sorted[next[fill[t]]++] = t;
    context.lineWidth = 0.8;
    for (let i = 0; i < colours.length; i++) {
      context.fillStyle = context.strokeStyle = `rgb(${colours[i]})`;
      // Long paths take long: a few hundred triangles in each.
      for (let from = starts[i]; from < starts[i + 1]; from += 400) {
        context.beginPath();
        for (let k = from; k < Math.min(from + 400, starts[i + 1]); k++) {
          const t = sorted[k];
          if (this.size(t) < FINE) continue;
          const a = 2 * corners[3 * t], b = 2 * corners[3 * t + 1], c = 2 * corners[3 * t + 2];
          context.moveTo(px(xy[a]), py(xy[a + 1])); context.lineTo(px(xy[b]), py(xy[b + 1])); context.lineTo(px(xy[c]), py(xy[c + 1]));
          context.closePath();
        }
        context.fill(); context.stroke();
      }
    }
  }

  /** Edges, fainter where triangles are small, none where they would only darken the picture. */
  edges(part) {
    const { vertices: xy, triangles: corners } = this.mesh, { px, py, lines: context } = this, d = this.look.dpr;
    context.strokeStyle = this.fill ? INK : RED;
    for (const [least, most, alpha, width] of [[4, 7, 0.22, 0.5], [7, 13, 0.36, 0.7], [13, Infinity, 0.55, 0.9]]) {
      context.globalAlpha = alpha; context.lineWidth = width * d;
      context.beginPath();
      let n = 0;
      for (const t of part) {
        const s = this.size(t) / d;
        if (s < least || s >= most) continue;
        for (let i = 0; i < 3; i++) {
          // Each edge is there in both directions; those on the boundary are drawn with the outline.
          const a = corners[3 * t + i], b = corners[3 * t + (i + 1) % 3];
          if (a > b) continue;
          context.moveTo(px(xy[2 * a]), py(xy[2 * a + 1])); context.lineTo(px(xy[2 * b]), py(xy[2 * b + 1]));
        }
        if (++n % 1000 === 0) { context.stroke(); context.beginPath(); }
      }
      context.stroke();
    }
    context.globalAlpha = 1;
  }

  outline() {
    const { vertices: xy, borders } = this.mesh, { px, py, lines: context } = this;
    context.strokeStyle = this.fill ? INK : RED; context.lineWidth = 1.5 * this.look.dpr; context.globalAlpha = 0.9;
    for (let from = 0; from < borders.length; from += 2000) {
      context.beginPath();
      for (let k = from; k < Math.min(from + 2000, borders.length); k += 2) {
        const a = 2 * borders[k], b = 2 * borders[k + 1];
        context.moveTo(px(xy[a]), py(xy[a + 1])); context.lineTo(px(xy[b]), py(xy[b + 1]));
      }
      context.stroke();
    }
    context.globalAlpha = 1;
  }

  selection() {
    const { lines: context, px, py, mesh, look } = this;
    context.strokeStyle = look.accent; context.lineWidth = 2 * look.dpr;
    look.selected.forEach((t, i) => {
      if (i % 1000 === 0) { context.stroke(); context.beginPath(); }
      const p = mesh.corners(t);
      context.moveTo(px(p[2][0]), py(p[2][1]));
      for (const [x, y] of p) context.lineTo(px(x), py(y));
    });
    context.stroke();
  }
}
