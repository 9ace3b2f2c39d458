"use strict";
// The knobs: what is turned becomes options, options become a wish, and the mesh that comes is shown. The same in the app and in a notebook:
// `ask(kind, { json, bytes, name })` brings the answer, from whomever.
//
// While a hand moves, one wish is under way and the last one waits; when it lets go, the wish is sent at once, and ends the one before.

const REST = 250;     // ms after a mesh until its certificate is asked for
const PAUSE = 150;    // ms a threshold rests until it is meshed; until then the mask is tinted
const SLOW = 0.3;     // s; of images that take longer, only what is seen is meshed while a hand moves

class Knobs extends KnobPanel {
  constructor(page, ask, addressed = false) {
    super();
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

  // ---- regions ----

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
