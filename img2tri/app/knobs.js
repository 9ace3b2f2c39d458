"use strict";
// The knobs: what is turned becomes options, options become a wish, and the mesh that comes is shown. The same in the app and in a notebook:
// `ask(kind, { json, bytes, name })` brings the answer, from whomever.
//
// While a hand moves, one wish is under way and the last one waits; when it lets go, the wish is sent at once, and ends the one before.

const REST = 250;     // ms after a mesh until its certificate is asked for
const PAUSE = 150;    // ms a threshold rests until it is meshed; until then the mask is tinted
const SLOW = 0.3;     // s; of images that take longer, only what is seen is meshed while a hand moves
const TRIANGLE = Math.sqrt(3) / 4;  // area of an equilateral triangle of side 1

class Knobs {
  constructor(page, ask, addressed = false) {
    Object.assign(this, { page, viewer: page.viewer, $: page.$, ask, addressed, options: {}, number: 0, flying: 0, pending: null, off: new Set(), names: {}, lengths: {}, pinned: null, seconds: 0 });
    this.told = () => {};
    this.viewer.clicked = (x, y, t) => this.clicked(x, y, t);
    this.listen();
  }

  async begin() {
    const { data } = await this.ask("facts");
    if (this.addressed) {
      try { Object.assign(this.options, JSON.parse(new URLSearchParams(location.hash.slice(1)).get("options") || "{}")); } catch { /* not ours */ }
      const fill = new URLSearchParams(location.hash.slice(1)).get("fill");
      if (fill in FILLS) this.viewer.set({ fill });
    }
    await this.image(data, true);
  }

  // ---- the image ----

  async image(buffer, keep = false) {
    const facts = unpack(buffer), { image } = facts;
    this.complain("");
    if (!keep) Object.assign(this, { options: {}, names: {}, lengths: {} });
    this.facts = facts;
    this.others();
    if (!image) return;
    this.pin(false);
    Object.assign(this, { known: image, gray: facts.gray, codes: facts.labels });
    if (keep) this.options = { ...facts.base, ...this.options };
    if (this.options.labels === undefined && image.kind === "labels") this.options.labels = true;
    this.names = { ...this.options.names };
    if (this.options.edge_length && typeof this.options.edge_length === "object") { this.lengths = this.options.edge_length; delete this.options.edge_length; }
    this.$("title").textContent = image.name.split("/").pop();
    this.$("facts").textContent = `${image.name} · ${image.pixels[0]} × ${image.pixels[1]} · ${image.type}` + (image.view.pixel === 1 ? "" : ` · pixel ${round(image.view.pixel)} ${image.view.unit}`);
    for (const id of ["kind", "edges-of", "specks", "more", "compare", "saving"]) this.$(id).hidden = false;
    this.$("kind").querySelector("[value=labels]").disabled = !image.labels;
    this.histogram();
    this.part_list();
    this.show_options();
    this.number = Math.max(this.number, Date.now());
    await this.viewer.place(image.view, URL.createObjectURL(new Blob([facts.picture], { type: "image/png" })));
    await this.send(false);
  }

  get labelled() { return this.options.labels !== undefined && this.options.labels !== null && this.options.labels !== false; }

  /** Counts of gray values as a shape; their roots, so that few are seen beside many. */
  histogram() {
    const { counts, least, most, level_step: step, whole } = this.known, top = Math.max(...counts.map(Math.sqrt));
    this.$("histogram").querySelector("path").setAttribute("d", "M0 60" + counts.map((count, i) => `V${(60 - 58 * Math.sqrt(count) / top).toFixed(1)}H${i + 1}`).join("") + "V60Z");
    const last = counts.findLastIndex(count => count > 0);
    this.$("histogram").setAttribute("viewBox", `0 0 ${last + 1} 60`);
    Object.assign(this.$("levels"), { min: least, max: most, step: whole ? Math.max(1, Math.floor(step)) : step / 4 });
  }

  /** The value the threshold has: typed, or what the library chooses. */
  get level() { const said = parseFloat(this.options.threshold); return Number.isFinite(said) ? said : this.known.otsu ?? this.known.least; }

  /** Tint what is brighter than the threshold, by a table of the codes: no image is sent. */
  mask() {
    const start = performance.now(), { gray, known: image, level } = this, [w, h] = image.pixels.map(n => Math.ceil(n / image.step)), table = new Uint32Array(256);
    for (let i = 0; i < 256; i++) table[i] = (image.least + i * image.level_step > level) !== Boolean(this.options.invert) ? 0xb0e0a040 : 0;  // of the bytes a, b, g, r
    this.canvas ||= document.createElement("canvas");
    if (this.canvas.width !== w || this.canvas.height !== h) { this.canvas.width = w; this.canvas.height = h; this.tint = this.canvas.getContext("2d").createImageData(w, h); }
    const pixels = new Uint32Array(this.tint.data.buffer);
    for (let i = 0; i < pixels.length; i++) pixels[i] = table[gray[i]];
    this.canvas.getContext("2d").putImageData(this.tint, 0, 0);
    this.viewer.mask = this.canvas;
    this.viewer.frame();
    this.$("canvas").dataset.mask = (performance.now() - start).toFixed(1);
  }

  // ---- regions ----

  /** One row for each region: on or off, its name, its own edge length. */
  part_list() {
    const list = this.$("part-list"), parts = this.labelled ? this.known.labels : [[1, 0]];
    this.$("level").hidden = this.labelled; this.$("parts").hidden = !this.labelled;
    this.$("find-part").hidden = parts.length <= MANY;
    const said = this.options.labels, zero = this.options.background === null;
    this.off = new Set(parts.map(([label]) => label).filter(label => Array.isArray(said) ? !said.includes(label) : label === 0 && !zero));
    list.replaceChildren(...(this.labelled ? parts : []).map(([label, count]) => {
      const row = document.createElement("div");
      row.dataset.label = label;
      row.innerHTML = `<input type="checkbox" data-on="${label}" aria-label="mesh region ${label}"><i class="swatch"></i><input data-name="${label}" placeholder="region ${label}" aria-label="name of region ${label}"><input data-length="${label}" placeholder="length" aria-label="edge length in region ${label}">`;
      row.title = `value ${label}, ${count.toLocaleString("en")} pixels`;
      row.querySelector("[data-on]").checked = !this.off.has(label);
      row.querySelector("[data-name]").value = this.names[label] || "";
      row.querySelector("[data-length]").value = this.lengths[label] ?? "";
      return row;
    }));
  }

  parts_changed() {
    const all = this.known.labels.map(([label]) => label), on = all.filter(label => !this.off.has(label)), zero = on.includes(0);
    delete this.options.background;
    if (zero) this.options.background = null;
    this.options.labels = on.length === all.filter(label => zero || label !== 0).length ? true : on;
    this.options.names = Object.fromEntries(Object.entries(this.names).filter(([label, name]) => name && on.includes(+label)));
    if (!Object.keys(this.options.names).length) delete this.options.names;
    this.want(false);
  }

  /** What is sent: lengths by label, where a region has one of its own, with that of the others. */
  wished() {
    const own = Object.entries(this.lengths).filter(([label, length]) => length !== "" && !this.off.has(+label)), options = { ...this.options };
    if (own.length && this.labelled) {
      const others = this.options.edge_length || this.known.edge_length || 8;
      const on = this.known.labels.map(([label]) => label).filter(label => !this.off.has(label));
      options.edge_length = { ...Object.fromEntries(on.map(label => [label, others])), ...Object.fromEntries(own) };
    }
    return options;
  }

  clicked(x, y, t) {
    const { known: image, codes } = this;
    if (this.labelled && codes) {
      const [w, h] = image.pixels.map(n => Math.ceil(n / image.step)), column = Math.floor(x / image.view.size[0] * w), row = Math.floor(y / image.view.size[1] * h);
      if (column < 0 || row < 0 || column >= w || row >= h) return;
      const label = image.labels[codes[row * w + column]][0];
      for (const one of this.$("part-list").children) {
        one.setAttribute("aria-selected", +one.dataset.label === label);
        if (+one.dataset.label === label) { one.scrollIntoView({ block: "nearest" }); this.$("parts").open = true; }
      }
    }
    if (t >= 0) this.page.region(this.viewer.mesh.regions[t], false);
  }

  // ---- wishes ----

  set(name, value, live = false) {
    if (value === "" || value === undefined) delete this.options[name]; else this.options[name] = value;
    this.show_options(name);
    if (name === "threshold" || name === "invert") {
      this.mask();
      clearTimeout(this.resting);
      this.resting = setTimeout(() => this.want(false), PAUSE);
    } else this.want(live);
  }

  want(live) { if (live && this.flying) this.pending = { live }; else this.send(live); }

  async send(live) {
    if (!this.known) return;
    const number = this.number = this.number + 1, start = performance.now();
    this.pending = null; this.flying++;
    clearTimeout(this.waiting);
    this.page.put({ verdict: '<span class="chip">checking</span>' });
    if (this.addressed) history.replaceState(null, "", "#" + new URLSearchParams({ options: JSON.stringify(this.wished()), fill: this.viewer.look.fill }));
    try {
      const window = live && this.seconds > SLOW ? this.seen() : null;
      const { data } = await this.ask("wish", { json: { options: this.wished(), number, window } });
      if (!data.byteLength) return;  // overtaken by a newer one
      const packed = unpack(data);
      if (packed.number < this.shown) return;
      this.shown = packed.number;
      await this.came(packed);
      this.$("canvas").dataset.shown = number; this.$("canvas").dataset.took = (performance.now() - start).toFixed(1);
    } catch (problem) {
      if (number === this.number) { this.complain(problem.message); this.page.put({ verdict: "" }); this.viewer.mask = null; this.viewer.frame(); }
    } finally {
      this.flying--;
      if (this.pending && !this.flying) this.send(this.pending.live);
    }
  }

  /** What is seen, as a box in the world. */
  seen() {
    const [x0, y0, x1, y1] = this.viewer.window(), [a, b] = [this.viewer.world(x0, y0), this.viewer.world(x1, y1)];
    return [Math.min(a[0], b[0]), Math.min(a[1], b[1]), Math.max(a[0], b[0]), Math.max(a[1], b[1])];
  }

  async came(packed) {
    this.complain("");
    this.viewer.mask = null;
    await this.viewer.show(new Mesh(packed));
    this.$("preview").hidden = !packed.preview;
    if (packed.preview) return;
    this.seconds = packed.seconds; this.present = packed;
    if (typeof packed.edge_length === "number") this.known.edge_length = packed.edge_length;
    this.page.put({ tiles: packed.tiles });
    this.$("command").textContent = packed.command; this.$("python").textContent = packed.python;
    const gone = packed.removed || {}, words = Object.entries(gone).filter(([, n]) => typeof n === "number" && n > 0).map(([what, n]) => `${n.toLocaleString("en")} ${what.replaceAll("_", " ")}`);
    this.$("removed").textContent = words.length ? `removed: ${words.join(", ")}` : "nothing was removed";
    for (const row of this.$("part-list").children) row.querySelector(".swatch").style.background = packed.view.regions.find(region => region.label === +row.dataset.label)?.colour || "var(--faint)";
    this.$("notes").replaceChildren(...packed.notes.map(note => Object.assign(document.createElement("li"), { textContent: note })));
    this.show_options();
    this.both();
    this.told(packed);
    const number = packed.number;
    this.waiting = setTimeout(() => this.certify(number), REST);
  }

  async certify(number) {
    try {
      const { data } = await this.ask("certificate");
      if (!data.byteLength) return;  // overtaken by a wish
      const { pieces, places } = JSON.parse(new TextDecoder().decode(data));
      if (number !== this.shown || this.flying) return;
      this.viewer.mesh.view.places = places;
      this.page.put(pieces);
      this.viewer.frame();
      this.$("canvas").dataset.certified = number;
    } catch (problem) { if (number === this.shown) this.complain(problem.message); }
  }

  complain(words) { this.$("complaint").textContent = words; this.$("complaint").hidden = !words; }

  // ---- what the knobs say ----

  /** Triangles of the wanted length that fill what is meshed. */
  get area() {
    const { known: image } = this;
    if (this.labelled) return image.labels.reduce((sum, [label, count]) => sum + (this.off.has(label) ? 0 : count), 0) * image.area;
    const on = (_, i) => (image.least + i * image.level_step > this.level) !== Boolean(this.options.invert);
    return image.counts.filter(on).reduce((sum, count) => sum + count, 0) * image.area;
  }

  /** A length as typed, in world units. */
  length(text) {
    const { view } = this.known, number = parseFloat(text);
    return number * (/px\s*$/.test(text) ? view.pixel : /%\s*$/.test(text) ? Math.hypot(...view.size) * view.pixel / 100 : 1);
  }

  show_options(but = "") {
    const { $, options, known: image } = this;
    for (const knob of this.page.root.querySelectorAll("#knobs [data-knob]")) {
      const name = knob.dataset.knob, value = options[name];
      if (knob.type === "checkbox") knob.checked = value ?? knob.dataset.default === "true";
      else if (!(name === but && knob.matches(":focus"))) knob.value = Array.isArray(value) ? value.join(",") : value ?? "";
    }
    for (const one of $("kind").querySelectorAll("input")) one.checked = (one.value === "labels") === this.labelled;
    const said = this.page.root.querySelector("[data-knob=edge_length]"), length = this.length(options.edge_length || image.edge_length || "8px") || 1;
    said.placeholder = image.edge_length ? round(image.edge_length) : "default";
    this.page.root.querySelector("[data-knob=threshold]").placeholder = image.otsu === null ? "" : `${round(image.otsu, 5)}`;
    this.page.root.querySelector("[data-knob=gradation]").placeholder = "0.17";
    this.page.root.querySelector("[data-knob=boundary_edge_length]").placeholder = "as inside";
    this.page.root.querySelector("[data-knob=min_area]").placeholder = "20px2";
    if (but !== "length") $("length").value = this.slide(length);
    $("length").setAttribute("aria-valuetext", round(length));
    if (but !== "count") $("count").value = Math.round(this.area / (TRIANGLE * length * length)).toLocaleString("en").replaceAll(",", " ");
    $("gradation").value = options.gradation ?? 0.17;
    $("levels").value = this.level;
    const last = +$("histogram").getAttribute("viewBox").split(" ")[2], at = (this.level - image.least) / (image.most - image.least || 1) * last;
    for (const end of ["x1", "x2"]) $("histogram").querySelector("line").setAttribute(end, at);
  }

  /** A length in world units -> where its slider stands, 0 to 1, and back: steps are factors. */
  slide(length) { const [least, most] = this.reach(); return Math.log(length / least) / Math.log(most / least); }
  unslide(share) { const [least, most] = this.reach(); return least * (most / least) ** share; }
  reach() { const { view } = this.known; return [1.5 * view.pixel, Math.max(24, Math.max(...view.size) / 6) * view.pixel]; }

  /** Knobs for the options that have none of their own, from the list that comes with the image. */
  others() {
    const parent = this.$("others");
    let heading = "";
    parent.replaceChildren();
    for (const knob of this.facts.knobs) {
      if (knob.heading !== heading) parent.append(Object.assign(document.createElement("h3"), { textContent: heading = knob.heading }));
      const label = Object.assign(document.createElement("label"), { textContent: knob.name.replaceAll("_", " "), title: knob.words }), input = document.createElement(knob.choices.length ? "select" : "input");
      input.dataset.knob = knob.name;
      if (knob.flag) { input.type = "checkbox"; input.dataset.default = knob.default; }
      else if (knob.choices.length) input.append(new Option(`default${knob.default ? `: ${knob.default}` : ""}`, ""), ...knob.choices.filter(choice => choice !== knob.default).map(choice => new Option(choice, choice)));
      else input.placeholder = knob.default || knob.none || "none";
      label.append(input);
      parent.append(label);
    }
    this.$("format").replaceChildren(...this.facts.formats.map(kind => new Option(kind, kind)));
    this.$("format").value = ".stl";
  }

  // ---- comparing and saving ----

  pin(on) {
    this.pinned = on && this.present ? { packed: this.present, options: structuredClone(this.options), lengths: { ...this.lengths }, names: { ...this.names } } : null;
    this.viewer.show(this.pinned ? new Mesh(this.pinned.packed) : null, 1);
    this.$("pin").setAttribute("aria-pressed", Boolean(this.pinned));
    this.$("pin").textContent = this.pinned ? "unpin" : "pin this one";
    this.$("swipe").hidden = this.$("back").hidden = !this.pinned;
    this.both();
  }

  /** A table of the pinned mesh, left of the line, and the present one, right of it. */
  both() {
    this.$("both").hidden = !this.pinned;
    if (!this.pinned) return;
    const sides = [this.pinned.packed.summary, this.present.summary], row = cells => `<tr>${cells.map((cell, i) => i ? `<td class="number">${cell}</td>` : `<td>${cell}</td>`).join("")}</tr>`;
    this.$("both").innerHTML = row(["", "pinned", "now"]) + sides[0].map(([name, value], i) => row([name, value, sides[1][i][1]])).join("");
  }

  async save() {
    const kind = this.$("format").value, height = this.$("height").value.trim();
    try {
      const { data, name } = await this.ask("download", { json: { kind, height: height && this.facts.solid.includes(kind) ? +height : null } });
      const link = Object.assign(document.createElement("a"), { href: URL.createObjectURL(new Blob([data])), download: name });
      link.click();
      setTimeout(() => URL.revokeObjectURL(link.href), 60000);
    } catch (problem) { this.complain(problem.message); }
  }

  async choose(file) {
    this.complain("");
    try { await this.image((await this.ask("image", { bytes: await file.arrayBuffer(), name: file.name })).data); }
    catch (problem) { this.complain(`${file.name}: ${problem.message}`); }
  }

  listen() {
    const { $ } = this, { root } = this.page;
    root.addEventListener("input", event => {
      const { knob, length, name } = event.target.dataset, { id } = event.target;
      if (id === "levels") this.set("threshold", event.target.value, true);
      else if (id === "length") { this.options.edge_length = round(this.unslide(+event.target.value)); this.set("edge_length", this.options.edge_length, true); }
      else if (id === "gradation") this.set("gradation", event.target.value, true);
      else if (id === "find-part") for (const row of $("part-list").children) row.hidden = !`${row.dataset.label} ${this.names[row.dataset.label] || ""}`.includes(event.target.value);
      else if (name !== undefined) this.names[name] = event.target.value;
      else if (length !== undefined) this.lengths[length] = event.target.value;
      else if (knob === "threshold") this.set("threshold", event.target.value, true);
    });
    root.addEventListener("change", event => {
      const { target } = event, { knob, on, name, length } = target.dataset;
      if (target.id === "file") { if (target.files.length) this.choose(target.files[0]); target.value = ""; }
      else if (target.name === "kind") { if (target.value === "labels") this.options.labels = true; else for (const option of ["labels", "background", "names"]) delete this.options[option]; delete this.options.threshold; delete this.options.invert; this.part_list(); this.show_options(); this.want(false); }
      else if (target.id === "length" || target.id === "gradation") this.want(false);
      else if (target.id === "count") { const count = parseFloat(target.value.replaceAll(/[\s,]/g, "")); if (count > 0) this.set("edge_length", round(Math.sqrt(this.area / (TRIANGLE * count)), 4)); }
      else if (on !== undefined) { if (target.checked) this.off.delete(+on); else this.off.add(+on); this.parts_changed(); }
      else if (name !== undefined || length !== undefined) this.parts_changed();
      else if (knob) this.set(knob, target.type !== "checkbox" ? target.value : target.checked === (target.dataset.default === "true") ? "" : target.checked);
    });
    $("otsu").addEventListener("click", () => this.set("threshold", ""));
    for (const [id, on] of [["parts-all", true], ["parts-none", false]]) $(id).addEventListener("click", () => {
      this.off = new Set(on ? [] : this.known.labels.map(([label]) => label));
      for (const box of root.querySelectorAll("[data-on]")) box.checked = on;
      this.parts_changed();
    });
    $("pin").addEventListener("click", () => this.pin(!this.pinned));
    $("back").addEventListener("click", () => { Object.assign(this, { options: structuredClone(this.pinned.options), lengths: { ...this.pinned.lengths }, names: { ...this.pinned.names } }); this.part_list(); this.show_options(); this.want(false); });
    $("save").addEventListener("click", () => this.save());
    const drop = $("knobs").parentNode;
    for (const name of ["dragover", "dragleave", "drop"]) drop.addEventListener(name, event => {
      event.preventDefault();
      $("drop").classList.toggle("over", name === "dragover");
      if (name === "drop" && event.dataTransfer.files.length) this.choose(event.dataTransfer.files[0]);
    });
  }
}
