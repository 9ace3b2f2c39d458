"use strict";
// What the knobs show: the histogram with the mask, a row for each region, the values of the options, and what follows from them.
//
// Read from `options` (what differs from the defaults), `known` (the image's facts), `names` and `lengths` by label, and regions that are `off`.

const TRIANGLE = Math.sqrt(3) / 4;  // area of an equilateral triangle of side 1

class KnobPanel {
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

  // ---- options ----

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
}
