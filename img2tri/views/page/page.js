"use strict";
// Around the viewer: certificate, histograms, regions and commands, and what a click on them shows. `root` as in viewer.js.

const MANY = 12;  // regions; more can be searched

class Page {
  constructor(root) {
    this.root = root;
    this.$ = id => root.getElementById(id);
    this.viewer = new Viewer(root);
    root.addEventListener("click", event => this.click(event.target));
    root.addEventListener("keydown", event => this.key(event));
    this.$("find").addEventListener("input", () => this.found());
    const themed = root.host || document.documentElement;
    this.$("theme").addEventListener("click", () => {
      const said = getComputedStyle(themed).colorScheme, dark = said === "dark" || (said !== "light" && matchMedia("(prefers-color-scheme: dark)").matches);
      themed.dataset.theme = dark ? "light" : "dark";
      this.viewer.inked();
    });
  }

  /** Put pieces of HTML in their places: id -> text. */
  put(pieces) {
    for (const [id, text] of Object.entries(pieces)) if (this.$(id)) this.$(id).innerHTML = text;
    this.$("find").hidden = this.root.querySelectorAll("#regions [data-region]").length <= MANY;
    for (const chart of this.root.querySelectorAll(".chart")) chart.querySelector(".hit")?.setAttribute("tabindex", "0");
    this.found();
  }

  click(target) {
    const { viewer } = this, on = target.closest("[data-place], [data-bin], [data-region], [data-sort], [data-copy]");
    if (!on) return;
    const { place, bin, region, sort, copy } = on.dataset;
    if (copy) this.copy(on);
    else if (sort) this.sort(+sort, on);
    else if (!viewer.mesh) return;
    else if (place) { const spot = viewer.mesh.view.places[+place]; viewer.go(spot.x, spot.y, spot); }
    else if (bin) this.pick(on, ...bin.split(":"));
    else if (region && !target.closest("input, label")) this.region(+region);
  }

  /** Arrows go from bar to bar of a histogram; Enter and the space bar choose one. */
  key(event) {
    const bar = event.target.closest?.("[data-bin]"), step = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
    if (!bar) return;
    if (event.key === "Enter" || event.key === " ") this.click(bar);
    else if (step) {
      const all = [...bar.parentNode.querySelectorAll("[data-bin]")], next = all[all.indexOf(bar) + step];
      if (next) { bar.setAttribute("tabindex", "-1"); next.setAttribute("tabindex", "0"); next.focus(); }
    } else return;
    event.preventDefault();
  }

  /** Outline the triangles of a bar, or, if they were, none. */
  pick(bar, of, bin) {
    const was = bar.getAttribute("aria-pressed") === "true", { viewer } = this, found = [];
    for (const one of this.root.querySelectorAll("[data-bin][aria-pressed]")) one.removeAttribute("aria-pressed");
    if (was) { viewer.select(null); return; }
    bar.setAttribute("aria-pressed", "true");
    viewer.mesh[of].forEach((value, t) => { if (value === +bin) found.push(t); });
    viewer.select(found);
    this.$("readout").textContent = `${found.length.toLocaleString("en")} triangle${found.length === 1 ? "" : "s"} chosen`;
    this.$("viewer").scrollIntoView({ block: "nearest" });
  }

  /** Zoom to a region, and mark its row. */
  region(index, zoom = true) {
    const found = [];
    for (const row of this.root.querySelectorAll("#regions tr[data-region]")) {
      row.setAttribute("aria-selected", +row.dataset.region === index);
      if (+row.dataset.region === index) row.scrollIntoView({ block: "nearest" });
    }
    if (!zoom) return;
    this.viewer.mesh.regions.forEach((value, t) => { if (value === index) found.push(t); });
    this.viewer.select(found.length > 20000 ? null : found, found.length > 0);
  }

  /** Show only the rows whose name has what is searched for. */
  found() {
    const wanted = this.$("find").value.toLowerCase();
    for (const row of this.root.querySelectorAll("#regions tr[data-region]")) row.hidden = !row.textContent.toLowerCase().includes(wanted) && !row.querySelector("input")?.value.toLowerCase().includes(wanted);
  }

  /** Order rows by a column, and the other way round at the second click. */
  sort(column, button) {
    const body = button.closest("table").tBodies[0], down = button.dataset.order !== "down", said = row => row.cells[column].dataset.value ?? row.cells[column].textContent;
    button.dataset.order = down ? "down" : "up";
    const rows = [...body.rows].sort((a, b) => (Number.isNaN(+said(a)) || Number.isNaN(+said(b)) ? said(a).localeCompare(said(b), "en", { numeric: true }) : +said(b) - +said(a)) * (down ? 1 : -1));
    body.append(...rows);
  }

  async copy(button) {
    const text = this.$(button.dataset.copy);
    try { await navigator.clipboard.writeText(text.textContent); button.textContent = "copied"; setTimeout(() => { button.textContent = "copy"; }, 1500); }
    catch { getSelection().selectAllChildren(text); }
  }
}
