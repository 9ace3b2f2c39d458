"use strict";
// What part of the plane is seen: its middle (x, y), and how many pixels of the screen a unit is, `zoom`. Lengths are pixels of the image, y down.
//
// The viewer is such a camera; it has the `canvas`, the `view` (where the image lies), the layers with meshes, and draws when it has `changed`.

class Camera {
  get mesh() { return this.layers[0].mesh; }
  get dpr() { return Math.min(window.devicePixelRatio || 1, 2); }

  /** All of the mesh or image, or a box, in the room between the tools above and what is below. */
  fit(box = null) {
    const w = this.canvas.clientWidth, h = this.canvas.clientHeight, [x0, y0, x1, y1] = box || this.mesh?.view.box || this.view.box || [0, 0, ...this.view.size];
    const top = this.$("tools").offsetTop + this.$("tools").offsetHeight + 16, foot = 60;
    this.fitted = !box;
    this.zoom = Math.min(Math.max(w - 40, 40) / Math.max(x1 - x0, 1e-9), Math.max(h - top - foot, 100) / Math.max(y1 - y0, 1e-9), this.most());
    this.x = (x0 + x1) / 2; this.y = (y0 + y1) / 2 + (foot - top) / 2 / this.zoom;
  }

  least() { return Math.min(this.canvas.clientWidth / this.view.size[0], this.canvas.clientHeight / this.view.size[1]) / 4; }
  most() { return 4000; }

  closer(factor, sx = this.canvas.clientWidth / 2, sy = this.canvas.clientHeight / 2) {
    if (!factor) { this.spot = null; this.fit(); this.changed(); return; }
    const next = Math.min(Math.max(this.zoom * factor, this.least()), this.most()), f = (1 / this.zoom - 1 / next);
    this.x += (sx - this.canvas.clientWidth / 2) * f; this.y += (sy - this.canvas.clientHeight / 2) * f;
    this.zoom = next; this.fitted = false;
    this.changed();
  }

  moved(dx, dy) { this.x -= dx / this.zoom; this.y -= dy / this.zoom; this.fitted = false; this.changed(); }

  /** What is seen, in pixels of the image: left, top, right, bottom. */
  window() {
    const w = this.canvas.clientWidth / 2 / this.zoom, h = this.canvas.clientHeight / 2 / this.zoom;
    return [this.x - w, this.y - h, this.x + w, this.y + h];
  }

  world(x, y) { const { corner, pixel, upward, size } = this.view; return [corner[0] + x * pixel, corner[1] + (upward ? size[1] - y : y) * pixel]; }

  inside(event) {
    const box = this.canvas.getBoundingClientRect(), sx = event.clientX - box.left, sy = event.clientY - box.top;
    return [sx, sy, this.x + (sx - box.width / 2) / this.zoom, this.y + (sy - box.height / 2) / this.zoom];
  }
}
