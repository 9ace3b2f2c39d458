"use strict";
// The viewer: image, filled triangles, their edges, and the places of warnings, each on a layer; drag, wheel, pinch and keys move it.
//
// Lengths are pixels of the image, y down, as the arrays come. Few triangles are drawn anew with every movement; for many, the
// last drawing is moved along, and a new one is made, a part at a time, as soon as the movement pauses. What is smaller than a pixel of
// the screen becomes a dot.

const $ = id => document.getElementById(id);
const view = JSON.parse($("view").textContent);

function array(id, Type) {
  const text = atob($(id).textContent), bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; i++) bytes[i] = text.charCodeAt(i);
  $(id).remove();
  return new Type(bytes.buffer);
}

const xy = array("vertices", Float32Array), corners = array("triangles", Uint32Array), borders = array("borders", Uint32Array);
const values = { quality: array("quality", Uint8Array), angle: array("angle", Uint8Array), region: array("regions", Uint32Array) };
const count = corners.length / 3;
const RAMP = view.ramp.map(hex => [0, 2, 4].map(i => parseInt(hex.slice(i, i + 2), 16)));
const INK = "#15191e", RED = "#e3120b";  // over colours, and over the bare image as in the figures of the paper
const LEVELS = 32;
const ramp = t => {
  const p = t * (RAMP.length - 1), i = Math.min(Math.floor(p), RAMP.length - 2), f = p - i;
  return RAMP[i].map((a, k) => Math.round(a + f * (RAMP[i + 1][k] - a)));
};
const LEVEL_COLOURS = Array.from({ length: LEVELS }, (_, i) => ramp(i / (LEVELS - 1)));
const REGION_COLOURS = view.regions.map(region => [1, 3, 5].map(i => parseInt(region.colour.slice(i, i + 2), 16)));
const FILLS = { none: "None", region: "Region", quality: "Quality", angle: "Smallest angle" };
const LAYERS = { image: "Image", edges: "Edges", outline: "Outline" };
const LIGHT = 20000;   // triangles drawn at once, without a pause
const PART = 20000;    // triangles drawn between two pauses
const FINE = 2.2;      // px of the screen; what is smaller is a dot
const state = { fill: "region", image: view.image, edges: true, outline: true, x: 0, y: 0, zoom: 1, hover: -1 };

// ---- where the triangles are: cells of a grid, each with its triangles in one stretch of `order` ----

const grid = (() => {
  const [w, h] = view.size, side = Math.max(Math.sqrt(w * h / Math.max(count / 48, 1)), 1e-9);
  const nx = Math.max(1, Math.ceil(w / side)), ny = Math.max(1, Math.ceil(h / side));
  const cell = new Uint32Array(count), starts = new Uint32Array(nx * ny + 1), order = new Uint32Array(count);
  let reach = 0;
  for (let t = 0; t < count; t++) {
    const a = 2 * corners[3 * t], b = 2 * corners[3 * t + 1], c = 2 * corners[3 * t + 2];
    const x = (xy[a] + xy[b] + xy[c]) / 3, y = (xy[a + 1] + xy[b + 1] + xy[c + 1]) / 3;
    for (const v of [a, b, c]) reach = Math.max(reach, Math.abs(xy[v] - x), Math.abs(xy[v + 1] - y));
    cell[t] = Math.min(ny - 1, Math.max(0, Math.floor(y / side))) * nx + Math.min(nx - 1, Math.max(0, Math.floor(x / side)));
    starts[cell[t] + 1]++;
  }
  for (let i = 0; i < nx * ny; i++) starts[i + 1] += starts[i];
  const next = starts.slice();
  for (let t = 0; t < count; t++) order[next[cell[t]]++] = t;
  return { nx, ny, side, starts, order, reach };
})();

/** Triangles that may be seen between two corners, as stretches [from, to) of grid.order. */
function stretches(x0, y0, x1, y1) {
  const { nx, ny, side, starts, reach } = grid, at = (v, n) => Math.min(n - 1, Math.max(0, Math.floor(v / side)));
  const i0 = at(x0 - reach, nx), i1 = at(x1 + reach, nx), found = [];
  for (let j = at(y0 - reach, ny); j <= at(y1 + reach, ny); j++)
    if (starts[j * nx + i1 + 1] > starts[j * nx + i0]) found.push([starts[j * nx + i0], starts[j * nx + i1 + 1]]);
  return found;
}

function triangleAt(x, y) {
  for (const [from, to] of stretches(x, y, x, y))
    for (let k = from; k < to; k++) {
      const t = grid.order[k], p = [0, 1, 2].map(i => 2 * corners[3 * t + i]);
      const turn = i => {
        const a = p[i], b = p[(i + 1) % 3];
        return (xy[b] - xy[a]) * (y - xy[a + 1]) - (xy[b + 1] - xy[a + 1]) * (x - xy[a]);
      };
      const s = [turn(0), turn(1), turn(2)];
      if (s.every(v => v >= 0) || s.every(v => v <= 0)) return t;
    }
  return -1;
}

// ---- drawing ----

const canvas = $("canvas"), screen = canvas.getContext("2d");
const layer = () => document.createElement("canvas").getContext("2d");
let done = { fill: layer(), lines: layer(), at: null }, work = { fill: layer(), lines: layer(), at: null };
let job = 0, waiting = 0, due = null, picture = null;
let ink = {};
const dpr = () => Math.min(window.devicePixelRatio || 1, 2);

/** Do something before the screen shows the next picture, once, however often it is asked for; to render is to frame too. */
function soon(action) {
  if (!due) requestAnimationFrame(() => { const now = due; due = null; now(); });
  if (!due || action === render) due = action;
}

function viewOf(w, h) { return { x: state.x, y: state.y, s: state.zoom * dpr(), w, h }; }

/** Colour of each triangle as a number, and the colours. */
function colouring() {
  if (state.fill === "region") return [t => values.region[t], REGION_COLOURS];
  const of = values[state.fill];
  return [t => of[t] >> 3, LEVEL_COLOURS];
}

/** Draw everything into the layers `work`; then they become those shown. */
function render() {
  const mine = ++job, w = canvas.width, h = canvas.height, at = viewOf(w, h);
  for (const context of [work.fill, work.lines]) {
    context.canvas.width = w; context.canvas.height = h;
    context.lineJoin = context.lineCap = "round";
  }
  work.at = at;
  const px = x => (x - at.x) * at.s + w / 2, py = y => (y - at.y) * at.s + h / 2;
  const parts = stretches(at.x - w / 2 / at.s, at.y - h / 2 / at.s, at.x + w / 2 / at.s, at.y + h / 2 / at.s);
  const total = parts.reduce((sum, [from, to]) => sum + to - from, 0);
  const seen = new Uint32Array(total);
  let n = 0;
  for (const [from, to] of parts) { seen.set(grid.order.subarray(from, to), n); n += to - from; }
  const size = t => {
    const a = 2 * corners[3 * t], b = 2 * corners[3 * t + 1], c = 2 * corners[3 * t + 2];
    return at.s * Math.max(Math.abs(xy[a] - xy[b]), Math.abs(xy[b] - xy[c]), Math.abs(xy[c] - xy[a]),
      Math.abs(xy[a + 1] - xy[b + 1]), Math.abs(xy[b + 1] - xy[c + 1]), Math.abs(xy[c + 1] - xy[a + 1]));
  };
  if (state.fill !== "none") dots(work.fill, seen, size, px, py);
  const finish = () => {
    if (state.outline) outline(work.lines, px, py);
    [done, work] = [work, done];
    canvas.dataset.drawn = total;
    frame();
  };
  const step = from => {
    if (mine !== job) return;
    const to = Math.min(from + PART, total), part = seen.subarray(from, to);
    if (state.fill !== "none") fill(work.fill, part, size, px, py);
    if (state.edges) edges(work.lines, part, size, px, py);
    if (to < total) setTimeout(step, 0, to); else finish();
  };
  step(0);
}

/** Triangles too small to be drawn as such: two by two dots of their colour. */
function dots(context, seen, size, px, py) {
  const { width: w, height: h } = context.canvas, [colour, colours] = colouring();
  const codes = new Uint32Array(colours.map(([r, g, b]) => (255 << 24 | b << 16 | g << 8 | r) >>> 0));
  let any = false, data = null, dot = null;
  for (const t of seen) {
    if (size(t) >= FINE) continue;
    if (!any) { any = true; data = context.createImageData(w, h); dot = new Uint32Array(data.data.buffer); }
    const a = 2 * corners[3 * t], b = 2 * corners[3 * t + 1], c = 2 * corners[3 * t + 2];
    const x = Math.floor(px((xy[a] + xy[b] + xy[c]) / 3)), y = Math.floor(py((xy[a + 1] + xy[b + 1] + xy[c + 1]) / 3));
    if (x < 0 || y < 0 || x >= w - 1 || y >= h - 1) continue;
    dot[y * w + x] = dot[y * w + x + 1] = dot[y * w + w + x] = dot[y * w + w + x + 1] = codes[colour(t)];
  }
  if (any) context.putImageData(data, 0, 0);
}

/** Fill triangles, colour by colour; a thin line of the same colour closes the gap that smoothing leaves between them. */
function fill(context, part, size, px, py) {
  const [colour, colours] = colouring(), starts = new Uint32Array(colours.length + 1), sorted = new Uint32Array(part.length);
  for (const t of part) starts[colour(t) + 1]++;
  for (let i = 0; i < colours.length; i++) starts[i + 1] += starts[i];
  const next = starts.slice();
  for (const t of part) sorted[next[colour(t)]++] = t;
  context.lineWidth = 0.8;
  for (let i = 0; i < colours.length; i++) {
    context.fillStyle = context.strokeStyle = `rgb(${colours[i]})`;
    // Long paths take long: a few hundred triangles in each.
    for (let from = starts[i]; from < starts[i + 1]; from += 400) {
      context.beginPath();
      for (let k = from; k < Math.min(from + 400, starts[i + 1]); k++) {
        const t = sorted[k];
        if (size(t) < FINE) continue;
        const a = 2 * corners[3 * t], b = 2 * corners[3 * t + 1], c = 2 * corners[3 * t + 2];
        context.moveTo(px(xy[a]), py(xy[a + 1])); context.lineTo(px(xy[b]), py(xy[b + 1])); context.lineTo(px(xy[c]), py(xy[c + 1]));
        context.closePath();
      }
      context.fill(); context.stroke();
    }
  }
}

/** Edges, fainter where triangles are small, none where they would only darken the picture. */
function edges(context, part, size, px, py) {
  const d = dpr(), classes = [[4, 7, 0.22, 0.5], [7, 13, 0.36, 0.7], [13, Infinity, 0.55, 0.9]];
  context.strokeStyle = state.fill === "none" ? RED : INK;
  for (const [least, most, alpha, width] of classes) {
    context.globalAlpha = alpha; context.lineWidth = width * d;
    context.beginPath();
    let n = 0;
    for (const t of part) {
      const s = size(t) / d;
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

function outline(context, px, py) {
  context.strokeStyle = state.fill === "none" ? RED : INK; context.lineWidth = 1.5 * dpr(); context.globalAlpha = 0.9;
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

/** Put the layers together as they are seen from here. */
function frame() {
  const w = canvas.width, h = canvas.height, d = dpr(), at = viewOf(w, h);
  screen.setTransform(1, 0, 0, 1, 0, 0);
  screen.clearRect(0, 0, w, h);
  const x0 = (0 - at.x) * at.s + w / 2, y0 = (0 - at.y) * at.s + h / 2;
  if (state.image && picture) {
    screen.imageSmoothingEnabled = at.s < 1.2;  // from there on pixels are to be seen
    screen.drawImage(picture, x0, y0, view.size[0] * at.s, view.size[1] * at.s);
  }
  screen.strokeStyle = ink.quiet; screen.globalAlpha = 0.35; screen.lineWidth = d;
  screen.strokeRect(x0, y0, view.size[0] * at.s, view.size[1] * at.s);
  screen.globalAlpha = 1; screen.imageSmoothingEnabled = true;
  if (done.at) {
    const k = at.s / done.at.s, dx = (done.at.x - at.x) * at.s + (w - done.at.w * k) / 2, dy = (done.at.y - at.y) * at.s + (h - done.at.h * k) / 2;
    screen.globalAlpha = state.image && state.fill === "region" ? 0.72 : 1;  // colours that are read by a scale stay as they are
    screen.drawImage(done.fill.canvas, dx, dy, done.at.w * k, done.at.h * k);
    screen.globalAlpha = 1;
    screen.drawImage(done.lines.canvas, dx, dy, done.at.w * k, done.at.h * k);
  }
  const px = x => (x - at.x) * at.s + w / 2, py = y => (y - at.y) * at.s + h / 2;
  if (state.hover >= 0) {
    const p = [0, 1, 2].map(i => 2 * corners[3 * state.hover + i]);
    screen.beginPath();
    for (const v of p) screen.lineTo(px(xy[v]), py(xy[v + 1]));
    screen.closePath();
    screen.strokeStyle = ink.accent; screen.lineWidth = 2.2 * d; screen.stroke();
  }
  marks(px, py, d);
  bar();
}

/** Rings around the places of warnings, with the number of the warning. */
function marks(px, py, d) {
  for (const place of [...view.places].sort((a, b) => a.first - b.first)) {
    const x = px(place.x), y = py(place.y), chosen = place === state.place;
    if (!place.number && !chosen) continue;
    const r = (chosen ? 15 : place.first ? 11 : 5) * d;
    screen.beginPath(); screen.arc(x, y, r, 0, 7);
    screen.lineWidth = 5 * d; screen.strokeStyle = ink.card; screen.globalAlpha = 0.8; screen.stroke(); screen.globalAlpha = 1;
    screen.lineWidth = 2.4 * d; screen.strokeStyle = place.number ? ink.bad : ink.accent; screen.stroke();
    if (!place.first) continue;
    screen.beginPath(); screen.arc(x + r, y - r, 8.5 * d, 0, 7); screen.fillStyle = ink.bad; screen.fill();
    screen.fillStyle = ink.card; screen.font = `600 ${11 * d}px system-ui, sans-serif`; screen.textAlign = "center"; screen.textBaseline = "middle";
    screen.fillText(place.number, x + r, y - r + 0.5 * d);
  }
}

/** The bar that shows a round length. */
function bar() {
  const most = 140 / state.zoom * view.pixel, power = 10 ** Math.floor(Math.log10(most)), step = [5, 2, 1].find(k => k * power <= most) * power;
  $("bar").lastElementChild.style.width = `${step / view.pixel * state.zoom}px`;
  $("bar").firstElementChild.textContent = `${+step.toPrecision(3)} ${view.unit}`.trim();
}

// ---- moving ----

function changed() {
  const w = canvas.width, h = canvas.height, s = state.zoom * dpr();
  const seen = stretches(state.x - w / 2 / s, state.y - h / 2 / s, state.x + w / 2 / s, state.y + h / 2 / s).reduce((sum, [from, to]) => sum + to - from, 0);
  clearTimeout(waiting);
  if (seen <= LIGHT) { soon(render); return; }
  job++;
  soon(frame);
  waiting = setTimeout(render, done.at ? 120 : 0);
}

function fit() {
  // All of the mesh, in the room between the tools above and what is below.
  const w = canvas.clientWidth, h = canvas.clientHeight, [x0, y0, x1, y1] = view.box;
  const top = $("tools").offsetTop + $("tools").offsetHeight + 16, foot = 60;
  state.zoom = Math.min((w - 40) / (x1 - x0), Math.max(h - top - foot, 100) / (y1 - y0));
  state.x = (x0 + x1) / 2; state.y = (y0 + y1) / 2 + (foot - top) / 2 / state.zoom;
}

const least = () => Math.min(canvas.clientWidth / view.size[0], canvas.clientHeight / view.size[1]) / 4;
function zoom(factor, sx = canvas.clientWidth / 2, sy = canvas.clientHeight / 2) {
  const dx = (sx - canvas.clientWidth / 2) / state.zoom, dy = (sy - canvas.clientHeight / 2) / state.zoom;
  const next = Math.min(Math.max(state.zoom * factor, least()), 4000), f = 1 - state.zoom / next;
  state.x += dx * f; state.y += dy * f; state.zoom = next;
  changed();
}

function show(place) {
  state.place = place; state.x = place.x; state.y = place.y;
  state.zoom = Math.max(Math.min(canvas.clientWidth, canvas.clientHeight) / (14 * view.edge), least());
  $("viewer").scrollIntoView({ block: "nearest" });
  changed();
}

const world = (x, y) => [view.corner[0] + x * view.pixel, view.corner[1] + (view.upward ? view.size[1] - y : y) * view.pixel];
function inside(event) {
  const box = canvas.getBoundingClientRect(), sx = event.clientX - box.left, sy = event.clientY - box.top;
  return [sx, sy, state.x + (sx - box.width / 2) / state.zoom, state.y + (sy - box.height / 2) / state.zoom];
}

function read(x, y) {
  const t = triangleAt(x, y), [wx, wy] = world(x, y), digits = Math.max(0, Math.ceil(-Math.log10(view.pixel / state.zoom)));
  if (t !== state.hover) { state.hover = t; soon(frame); }
  let text = `${wx.toFixed(digits)}, ${wy.toFixed(digits)}`;
  if (t >= 0) {
    const p = [0, 1, 2].map(i => [xy[2 * corners[3 * t + i]], xy[2 * corners[3 * t + i] + 1]]);
    const angles = p.map((o, i) => {
      const [a, b] = [p[(i + 1) % 3], p[(i + 2) % 3]].map(v => [v[0] - o[0], v[1] - o[1]]);
      return Math.atan2(Math.abs(a[0] * b[1] - a[1] * b[0]), a[0] * b[0] + a[1] * b[1]);
    });
    const q = 8 * angles.reduce((product, angle) => product * Math.sin(angle / 2), 1), degrees = Math.min(...angles) * 180 / Math.PI;
    const region = view.regions[values.region[t]];
    text += ` · ${view.regions.length > 1 ? region.name + " · " : ""}triangle ${t} · q ${q.toFixed(3)} · ${degrees.toFixed(1)}°`;
  }
  $("readout").textContent = text;
}

const pointers = new Map();
canvas.addEventListener("pointerdown", event => { canvas.setPointerCapture(event.pointerId); pointers.set(event.pointerId, event); canvas.classList.add("moving"); });
canvas.addEventListener("pointermove", event => {
  const before = pointers.get(event.pointerId);
  if (!before) { const [, , x, y] = inside(event); read(x, y); return; }
  const other = [...pointers.values()].find(p => p.pointerId !== event.pointerId);
  pointers.set(event.pointerId, event);
  const share = other ? 0.5 : 1;
  state.x -= share * (event.clientX - before.clientX) / state.zoom; state.y -= share * (event.clientY - before.clientY) / state.zoom;
  if (other) {
    const far = p => Math.hypot(p.clientX - other.clientX, p.clientY - other.clientY), box = canvas.getBoundingClientRect();
    zoom(far(event) / Math.max(far(before), 1), (event.clientX + other.clientX) / 2 - box.left, (event.clientY + other.clientY) / 2 - box.top);
  }
  changed();
});
for (const name of ["pointerup", "pointercancel"]) canvas.addEventListener(name, event => { pointers.delete(event.pointerId); canvas.classList.remove("moving"); });
canvas.addEventListener("pointerleave", () => { state.hover = -1; soon(frame); });
canvas.addEventListener("wheel", event => {
  event.preventDefault();
  const [sx, sy] = inside(event);
  zoom(Math.exp(-event.deltaY * (event.deltaMode ? 0.05 : 0.0016)), sx, sy);
}, { passive: false });
canvas.addEventListener("dblclick", event => { const [sx, sy] = inside(event); zoom(2, sx, sy); });
canvas.addEventListener("keydown", event => {
  const far = 60 / state.zoom, move = { ArrowLeft: [-far, 0], ArrowRight: [far, 0], ArrowUp: [0, -far], ArrowDown: [0, far] }[event.key];
  if (move) { state.x += move[0]; state.y += move[1]; changed(); }
  else if (event.key === "+" || event.key === "=") zoom(1.4);
  else if (event.key === "-") zoom(1 / 1.4);
  else if (event.key === "0") { fit(); changed(); }
  else return;
  event.preventDefault();
});

// ---- around it ----

function button(parent, label, role, on) {
  const made = document.createElement("button");
  made.type = "button"; made.textContent = label; made.addEventListener("click", on);
  if (role) made.setAttribute("role", role);
  $(parent).append(made);
  return made;
}

/** Colours of the style sheet, as light or dark has them: only an element that uses one says what it is. */
function inked() {
  const probe = document.body.appendChild(document.createElement("i")), colour = name => { probe.style.color = `var(--${name})`; return getComputedStyle(probe).color; };
  ink = Object.fromEntries(["quiet", "bad", "card", "accent"].map(name => [name, colour(name)]));
  probe.remove();
}

function redrawn() {
  inked();
  for (const [name, made] of Object.entries(buttons))
    if (name in FILLS) made.setAttribute("aria-checked", state.fill === name); else made.setAttribute("aria-pressed", state[name]);
  const scaled = state.fill === "quality" || state.fill === "angle";
  $("scale").hidden = !scaled;
  if (scaled) [$("least").textContent, $("most").textContent] = state.fill === "quality" ? ["q 0", "1"] : ["0°", "60°"];
  clearTimeout(waiting); render();
}

const buttons = {};
for (const [name, label] of Object.entries(FILLS))
  buttons[name] = button("fill", label, "radio", () => { state.fill = name; redrawn(); });
for (const [name, label] of Object.entries(LAYERS))
  if (name !== "image" || view.image) buttons[name] = button("layers", label, "", () => { state[name] = !state[name]; redrawn(); });
for (const made of document.querySelectorAll("[data-zoom]"))
  made.addEventListener("click", () => { if (+made.dataset.zoom) zoom(+made.dataset.zoom); else { state.place = null; fit(); changed(); } });
for (const made of document.querySelectorAll("[data-place]")) made.addEventListener("click", () => show(view.places[+made.dataset.place]));
$("theme").addEventListener("click", () => {
  const root = document.documentElement, dark = getComputedStyle(root).colorScheme === "dark" || (getComputedStyle(root).colorScheme !== "light" && matchMedia("(prefers-color-scheme: dark)").matches);
  root.dataset.theme = dark ? "light" : "dark"; redrawn();
});
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", redrawn);
$("copy").addEventListener("click", async () => {
  try { await navigator.clipboard.writeText($("command").textContent); $("copy").textContent = "copied"; }
  catch { getSelection().selectAllChildren($("command")); }
});

/** What the address may say after its #: place=1, fill=angle, theme=dark, image=0. */
function addressed() {
  const said = new URLSearchParams(location.hash.slice(1));
  if (said.get("theme")) document.documentElement.dataset.theme = said.get("theme");
  if (buttons[said.get("fill")]) state.fill = said.get("fill");
  for (const name of Object.keys(LAYERS)) if (said.has(name)) state[name] = said.get(name) !== "0" && (name !== "image" || view.image);
  fit();
  if (view.places[said.get("place")]) show(view.places[said.get("place")]);
  redrawn();
}

function resized() {
  canvas.width = Math.round(canvas.clientWidth * dpr()); canvas.height = Math.round(canvas.clientHeight * dpr());
}
new ResizeObserver(() => {
  const first = !done.at && !job;
  resized();
  if (first) addressed(); else { frame(); changed(); }  // at once, as the new size has emptied the canvas
}).observe(canvas);
addEventListener("hashchange", addressed);
if (view.image) {
  picture = new Image();
  picture.addEventListener("load", () => soon(frame));
  picture.src = "data:image/png;base64," + $("picture").textContent;
}
