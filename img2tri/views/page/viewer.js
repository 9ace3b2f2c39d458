"use strict";
// The viewer: image, mask, one mesh or two beside each other, and marks, on one canvas; drag, wheel, pinch and keys move the camera.
//
// While one moves, the last bitmap of a mesh is moved along, whatever its size; a new one is made when
// the movement pauses. `root` is the document, or the shadow root the viewer stands in.

const QUICK = 6;  // ms; a mesh that is drawn in less is drawn anew with every movement
const FILLS = { none: "None", region: "Region", quality: "Quality", angle: "Smallest angle" };
const LAYERS = { image: "Image", edges: "Edges", outline: "Outline" };
const round = (value, digits = 3) => `${+value.toPrecision(digits)}`;

class Viewer extends Camera {
  constructor(root) {
    super();
    const $ = this.$ = id => root.getElementById(id);
    this.canvas = $("canvas"); this.screen = this.canvas.getContext("2d");
    this.look = { fill: "region", image: true, edges: true, outline: true, opacity: 0.72, selected: null };
    this.layers = [{ mesh: null }, { mesh: null }];  // what is looked at, and what it is compared with
    Object.assign(this, { x: 0, y: 0, zoom: 1, hover: -1, swipe: 0.5, job: 0, cost: 0, fitted: true, spot: null, mask: null, pictures: [], ink: {} });
    this.clicked = () => {};
    for (const [name, label] of Object.entries(FILLS)) this.choice(name, label);
    for (const [name, label] of Object.entries(LAYERS)) this.button($("layers"), label, () => this.set({ [name]: !this.look[name] })).dataset.layer = name;
    for (const made of $("zoom").querySelectorAll("[data-zoom]")) made.addEventListener("click", () => this.closer(+made.dataset.zoom));
    this.listen();
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.inked());
    addEventListener("beforeprint", () => this.inked());
    addEventListener("afterprint", () => this.inked());
    new ResizeObserver(() => this.resized()).observe(this.canvas);
    this.set({});
  }

  // ---- what is shown ----

  /** Show where an image lies, and the image; `source` is the address of a PNG, or null. */
  async place(view, source) {
    this.view = view;
    this.pictures = [];
    for (const layer of this.layers) Object.assign(layer, { mesh: null, bitmap: null });
    this.$("layers").querySelector("[data-layer=image]").hidden = !source;
    this.fit();
    if (source) {
      const picture = Object.assign(new Image(), { src: source });
      await picture.decode();
      // The browser makes an image small well, but slowly: halves of halves are at hand for every scale.
      this.pictures = [picture];
      for (let w = picture.width, h = picture.height, last = picture; Math.max(w, h) > 1024; ) {
        [w, h] = [Math.ceil(w / 2), Math.ceil(h / 2)];
        const half = Object.assign(document.createElement("canvas"), { width: w, height: h });
        half.getContext("2d").drawImage(last, 0, 0, w, h);
        this.pictures.push(last = half);
      }
    }
    this.changed();
  }

  /** Show a mesh, or take it away; its bitmap replaces the one before when it is drawn. Layer 1 is what it is compared with. */
  show(mesh, layer = 0) {
    this.layers[layer].mesh = mesh;
    if (!mesh) this.layers[layer].bitmap = null;
    if (!layer) { this.hover = -1; this.spot = null; this.look.selected = null; this.worst = -1; }
    return this.render();
  }

  set(look) {
    Object.assign(this.look, look);
    for (const made of this.$("fill").querySelectorAll("input")) made.checked = made.value === this.look.fill;
    for (const made of this.$("layers").children) made.setAttribute("aria-pressed", this.look[made.dataset.layer]);
    const scaled = this.look.fill === "quality" || this.look.fill === "angle";
    this.$("scale").hidden = !scaled;
    if (scaled) [this.$("least").textContent, this.$("most").textContent] = this.look.fill === "quality" ? ["q 0", "1"] : ["0°", "60°"];
    this.inked();
  }

  /** Go to a place, near enough to see the triangle there, which is outlined. */
  go(x, y, spot = null, t = this.mesh ? this.mesh.at(x, y, true) : -1) {
    this.spot = spot; this.hover = t; this.x = x; this.y = y; this.fitted = false;
    let side = this.view.edge || 8;
    if (t >= 0) { const p = this.mesh.corners(t); side = Math.max(...p.map(([ax, ay], i) => Math.hypot(p[(i + 1) % 3][0] - ax, p[(i + 1) % 3][1] - ay))); }
    this.zoom = Math.min(Math.max(Math.min(this.canvas.clientWidth, this.canvas.clientHeight) / (5 * side), this.least()), this.most());
    this.$("viewer").scrollIntoView({ block: "nearest" });
    if (t >= 0) this.say(x, y, t);
    this.changed();
  }

  /** The next or the last of the worst triangles. */
  next(step) {
    const order = this.mesh?.view.worst;
    if (!order?.length) return;
    this.worst = ((this.worst ?? -1) + step + order.length) % order.length;
    const t = order[this.worst], p = this.mesh.corners(t);
    this.go((p[0][0] + p[1][0] + p[2][0]) / 3, (p[0][1] + p[1][1] + p[2][1]) / 3, null, t);
    this.$("readout").textContent = `${this.worst + 1} of the ${order.length} worst · ${this.$("readout").textContent}`;
  }

  /** Outline triangles; zoom to all of them if they are a region. */
  select(triangles, zoom = false) {
    this.look.selected = triangles;
    if (zoom && triangles?.length) {
      let [x0, y0, x1, y1] = [Infinity, Infinity, -Infinity, -Infinity];
      for (const t of triangles) for (const [x, y] of this.mesh.corners(t)) { x0 = Math.min(x0, x); x1 = Math.max(x1, x); y0 = Math.min(y0, y); y1 = Math.max(y1, y); }
      this.fit([x0, y0, x1, y1]);
    }
    return this.render();
  }

  // ---- drawing ----

  async render() {
    clearTimeout(this.waiting); this.waiting = null;
    const mine = ++this.job, w = this.canvas.width, h = this.canvas.height, start = performance.now();
    if (!w || !h || !this.view) return;  // hidden; drawn when it is shown
    const at = { x: this.x, y: this.y, s: this.zoom * this.dpr, w, h };
    const layers = this.layers.filter(layer => layer.mesh), look = { ...this.look, dpr: this.dpr, image: this.look.image && this.pictures.length > 0, accent: this.ink.accent };
    const drawings = layers.map(layer => new Drawing(layer.mesh, at, layer === this.layers[0] ? look : { ...look, selected: null }));
    const bitmaps = [];
    for (const drawing of drawings) bitmaps.push(await drawing.drawn(() => mine !== this.job));
    if (mine !== this.job) return;
    this.cost = performance.now() - start;
    layers.forEach((layer, i) => Object.assign(layer, { bitmap: bitmaps[i], at }));
    if (drawings.length) this.canvas.dataset.drawn = drawings[0].seen.length;
    this.frame();
  }

  /** After a movement: the picture of before, moved; and a new one, now or in a pause. */
  changed() {
    if (!this.due) requestAnimationFrame(() => { this.due = false; if (this.cost < QUICK) this.render(); else this.frame(); });
    this.due = true;
    if (this.cost < QUICK) return;
    this.job++;
    clearTimeout(this.waiting);
    this.waiting = setTimeout(() => this.render(), this.cost < 60 ? 90 : 150);
  }

  /** Put together what is seen from here. */
  frame() {
    const { screen, canvas, dpr: d, look, view } = this, w = canvas.width, h = canvas.height, s = this.zoom * d;
    if (!w || !h || !view) return;
    const px = x => (x - this.x) * s + w / 2, py = y => (y - this.y) * s + h / 2, [x0, y0] = [px(0), py(0)], size = [view.size[0] * s, view.size[1] * s];
    screen.setTransform(1, 0, 0, 1, 0, 0);
    screen.clearRect(0, 0, w, h);
    if (look.image && this.pictures.length) {
      const fine = this.pictures.findLast(one => one.width >= size[0]) || this.pictures[0];
      screen.imageSmoothingEnabled = s < 1.2 * (fine.width / view.size[0] || 1);  // from there on pixels are to be seen
      screen.drawImage(fine, x0, y0, ...size);
    }
    screen.strokeStyle = this.ink.quiet; screen.globalAlpha = 0.35; screen.lineWidth = d;
    screen.strokeRect(x0, y0, ...size);
    screen.globalAlpha = 1;
    if (this.mask) { screen.imageSmoothingEnabled = false; screen.drawImage(this.mask, x0, y0, ...size); }
    else this.bitmaps(w, h, s);
    if (this.hover >= 0 && this.mesh) {
      screen.beginPath();
      for (const [x, y] of this.mesh.corners(this.hover)) screen.lineTo(px(x), py(y));
      screen.closePath();
      screen.strokeStyle = this.ink.accent; screen.lineWidth = 2.4 * d; screen.stroke();
    }
    if (this.mesh && !this.mask) this.marks(px, py, d);
    this.bar();
  }

  bitmaps(w, h, s) {
    const { screen } = this, split = Math.round(this.swipe * w);
    this.layers.forEach(({ bitmap, at }, i) => {
      if (!bitmap) return;
      const k = s / at.s, dx = (at.x - this.x) * s + (w - at.w * k) / 2, dy = (at.y - this.y) * s + (h - at.h * k) / 2;
      screen.save();
      if (this.layers[1].mesh) { screen.beginPath(); screen.rect(i ? 0 : split, 0, i ? split : w - split, h); screen.clip(); }
      screen.imageSmoothingEnabled = k !== 1;
      screen.drawImage(bitmap, ...(k === 1 ? [Math.round(dx), Math.round(dy)] : [dx, dy, at.w * k, at.h * k]));
      screen.restore();
    });
  }

  /** Rings around the places of warnings, with the number of the warning. */
  marks(px, py, d) {
    const { screen, ink } = this;
    for (const place of [...this.mesh.view.places].sort((a, b) => a.first - b.first)) {
      const x = px(place.x), y = py(place.y), chosen = place === this.spot, r = (chosen ? 15 : place.first ? 11 : 5) * d;
      if (!place.number && !chosen) continue;
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
  bar() {
    const most = 140 / this.zoom * this.view.pixel, power = 10 ** Math.floor(Math.log10(most)), step = [5, 2, 1].find(k => k * power <= most) * power;
    this.$("bar").lastElementChild.style.width = `${step / this.view.pixel * this.zoom}px`;
    this.$("bar").firstElementChild.textContent = `${round(step)} ${this.view.unit}`.trim();
  }

  /** Colours of the style sheet, as light or dark has them: only an element that uses one says what it is. */
  inked() {
    const probe = this.$("viewer").appendChild(document.createElement("i")), colour = name => { probe.style.color = `var(--${name})`; return getComputedStyle(probe).color; };
    this.ink = Object.fromEntries(["quiet", "bad", "card", "accent"].map(name => [name, colour(name)]));
    probe.remove();
    this.render();
  }

  // ---- moving ----

  resized() {
    const w = Math.round(this.canvas.clientWidth * this.dpr), h = Math.round(this.canvas.clientHeight * this.dpr);
    if (!w || !h) return;  // hidden: what there is stays
    this.canvas.width = w; this.canvas.height = h;
    if (this.fitted && this.view) this.fit();
    this.frame();  // at once, as the new size has emptied the canvas
    this.render();
  }

  say(x, y, t) {
    const digits = Math.max(0, Math.ceil(-Math.log10(this.view.pixel / this.zoom))), [wx, wy] = this.world(x, y), { mesh } = this;
    let text = `${wx.toFixed(digits)}, ${wy.toFixed(digits)} ${this.view.unit}`.trim();
    if (t >= 0) {
      const { q, angle } = mesh.measure(t), several = mesh.view.regions.length > 1 ? `${mesh.view.regions[mesh.regions[t]].name} · ` : "";
      text += ` · ${several}triangle ${t} · q ${q.toFixed(3)} · ${angle.toFixed(angle < 1 ? 2 : 1)}°`;
    }
    this.$("readout").textContent = text;
  }

  listen() {
    const { canvas } = this, pointers = new Map();
    let far = 0;  // how far a pointer came; a click is one that stayed
    canvas.addEventListener("pointerdown", event => {
      canvas.setPointerCapture(event.pointerId); pointers.set(event.pointerId, event); canvas.classList.add("moving"); far = 0;
      this.swiping = this.layers[1].mesh && Math.abs(this.inside(event)[0] - this.swipe * canvas.clientWidth) < 12;
    });
    canvas.addEventListener("pointermove", event => {
      if (!this.view) return;
      const [sx, , x, y] = this.inside(event), before = pointers.get(event.pointerId);
      if (!before) {
        const t = this.mesh && !this.mask ? this.mesh.at(x, y) : -1;
        if (t !== this.hover) { this.hover = t; this.changed(); }
        this.say(x, y, t);
        return;
      }
      const other = [...pointers.values()].find(p => p.pointerId !== event.pointerId), dx = event.clientX - before.clientX, dy = event.clientY - before.clientY;
      pointers.set(event.pointerId, event);
      far += Math.abs(dx) + Math.abs(dy);
      if (this.swiping) { this.split(sx / canvas.clientWidth); return; }
      this.moved(other ? dx / 2 : dx, other ? dy / 2 : dy);
      if (other) {
        const apart = p => Math.hypot(p.clientX - other.clientX, p.clientY - other.clientY), box = canvas.getBoundingClientRect();
        this.closer(apart(event) / Math.max(apart(before), 1), (event.clientX + other.clientX) / 2 - box.left, (event.clientY + other.clientY) / 2 - box.top);
      }
    });
    canvas.addEventListener("pointerup", event => { if (far < 4 && this.view) { const [, , x, y] = this.inside(event); this.clicked(x, y, this.mesh ? this.mesh.at(x, y) : -1); } });
    for (const name of ["pointerup", "pointercancel"]) canvas.addEventListener(name, event => { pointers.delete(event.pointerId); canvas.classList.remove("moving"); });
    canvas.addEventListener("pointerleave", () => { if (this.hover >= 0) { this.hover = -1; this.changed(); } });
    // One finger scrolls the page (touch-action: pan-y), two move and zoom the mesh.
    for (const name of ["touchstart", "touchmove"]) canvas.addEventListener(name, event => { if (event.touches.length > 1 && event.cancelable) event.preventDefault(); }, { passive: false });
    canvas.addEventListener("wheel", event => {
      event.preventDefault();
      const [sx, sy] = this.inside(event);
      this.closer(Math.exp(-event.deltaY * (event.deltaMode ? 0.05 : 0.0016)), sx, sy);
    }, { passive: false });
    canvas.addEventListener("dblclick", event => { const [sx, sy] = this.inside(event); this.closer(2, sx, sy); });
    canvas.addEventListener("keydown", event => {
      const move = { ArrowLeft: [60, 0], ArrowRight: [-60, 0], ArrowUp: [0, 60], ArrowDown: [0, -60] }[event.key];
      const does = { "+": () => this.closer(1.4), "=": () => this.closer(1.4), "-": () => this.closer(1 / 1.4), 0: () => this.closer(0), n: () => this.next(1), p: () => this.next(-1),
        "[": () => this.split(this.swipe - 0.05), "]": () => this.split(this.swipe + 0.05) }[event.key];
      if (event.ctrlKey || event.metaKey || event.altKey || !(move || does)) return;
      if (move) this.moved(...move); else does();
      event.preventDefault();
    });
  }

  /** Move the line between the two meshes that are compared: 0 at the left, 1 at the right. */
  split(share) { this.swipe = Math.min(Math.max(share, 0.02), 0.98); this.$("swipe").style.left = `${100 * this.swipe}%`; this.changed(); }

  button(parent, label, on) {
    const made = Object.assign(document.createElement("button"), { type: "button", textContent: label });
    made.addEventListener("click", on);
    parent.append(made);
    return made;
  }

  choice(name, label) {
    const made = Object.assign(document.createElement("label"), { innerHTML: `<input type="radio" name="fill" value="${name}">${label}` });
    made.firstChild.addEventListener("change", () => this.set({ fill: name }));
    this.$("fill").append(made);
  }
}
