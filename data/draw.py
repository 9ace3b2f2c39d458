"""Draw the images of this folder with ``python data/draw.py``.

All shapes are closed curves, filled by the even-odd rule at many points per pixel and averaged, so a gray value is the part of
the pixel the shape covers, without any bias; black and white images are cut at one half. x points right and y down, in pixels;
pixel (row r, column c) covers [c, c + 1] x [r, r + 1].

===================  =========  =============================================================================================
femur.png            280 x 900  right femur from the front, white on black
femur_gray.png       280 x 900  the same with cortical bone 230, trabecular bone 150 and marrow 70, edges by area covered
blobs.png            400 x 300  three irregular white shapes
blob_with_holes.png  300 x 300  an irregular white shape with round holes
plate.png            320 x 180  a plate with a round hole, 200 on 20, edges by area covered, none on a side of pixels
polycrystal.png      320 x 320  a label map of 40 grains, 1 to 40
gear.png             320 x 320  a gear with square teeth, a bore with keyway and bolt holes
===================  =========  =============================================================================================
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

Curve = NDArray[np.float64]
Image = NDArray[np.uint8]

FINE = 8  # sample points per pixel and direction

# Femur: millimetres, x towards the middle of the body, y up from the knee.
PIXELS_PER_MM = 1.9
FEMUR_SIZE = (900, 280)
FEMUR_ORIGIN = (160.0, 880.0)  # where (0, 0) lies, in pixels
HEAD = (9.0, 431.0, 24.0)  # centre and radius
LATERAL = [  # from the knee up along the outer side to the top of the neck
    (0.0, 10.5), (-4.5, 8.0), (-9.5, 3.5), (-20.0, 0.0), (-31.0, 3.5), (-38.0, 13.0), (-40.3, 25.0), (-39.5, 37.0), (-36.5, 50.0),
    (-33.0, 66.0), (-31.0, 84.0), (-30.4, 110.0), (-31.5, 145.0), (-34.0, 185.0), (-37.4, 225.0), (-41.5, 265.0), (-46.2, 305.0),
    (-51.2, 340.0), (-55.5, 360.0), (-61.0, 373.0), (-66.5, 384.5), (-69.0, 397.0), (-67.8, 410.0), (-63.5, 420.0), (-57.5, 425.0),
    (-51.5, 423.0), (-46.5, 418.0), (-40.0, 415.0), (-32.0, 416.0), (-25.0, 420.5), (-19.0, 427.5),
]  # fmt: skip
MEDIAL = [  # from the bottom of the neck down along the inner side to the knee
    (-0.5, 400.0), (-7.0, 392.0), (-11.5, 383.5), (-13.0, 376.5), (-11.0, 370.0), (-8.6, 364.0), (-9.3, 357.0), (-13.4, 347.5),
    (-16.8, 335.0), (-17.2, 305.0), (-13.6, 265.0), (-9.2, 225.0), (-4.2, 185.0), (1.4, 145.0), (7.6, 110.0), (13.8, 86.0), (21.5, 67.0),
    (30.0, 54.0), (37.0, 43.5), (40.3, 31.0), (39.8, 17.0), (34.5, 5.0), (23.5, -1.5), (13.0, 1.0), (5.5, 7.5),
]  # fmt: skip


def coverage(curves: list[Curve], size: tuple[int, int], fine: int = FINE) -> NDArray[np.float64]:
    """Return the part of each pixel, 0 to 1, that lies inside an odd number of `curves`."""
    return average(inside(curves, size, fine), fine)


def inside(curves: list[Curve], size: tuple[int, int], fine: int = FINE) -> NDArray[np.bool_]:
    """Tell for each sample point whether it lies inside an odd number of `curves`.

    Every side of a curve toggles the samples to its right, in each row of samples it crosses::

        ....|--->        ....|#####|....
        ....|------>     one toggle, then the other
    """
    rows, columns = size[0] * fine, size[1] * fine
    toggles = np.zeros((rows, columns + 1), np.int32)
    for curve in curves:
        here = curve * fine - 0.5
        there = np.roll(here, -1, axis=0)
        low, high = np.minimum(here[:, 1], there[:, 1]), np.maximum(here[:, 1], there[:, 1])
        first = np.clip(np.ceil(low), 0, rows).astype(int)
        count = np.clip(np.ceil(high), 0, rows).astype(int) - first
        side = np.repeat(np.arange(len(curve)), count)
        row = first[side] + np.arange(len(side)) - np.repeat(np.cumsum(count) - count, count)
        part = (row - here[side, 1]) / (there[side, 1] - here[side, 1])
        column = np.ceil(here[side, 0] + part * (there[side, 0] - here[side, 0]))
        np.add.at(toggles, (row, np.clip(column, 0, columns).astype(int)), 1)
    return np.asarray(np.cumsum(toggles[:, :-1], axis=1) % 2 == 1)


def average(samples: NDArray[np.bool_] | NDArray[np.float64], fine: int = FINE) -> NDArray[np.float64]:
    """Return the mean of the samples of each pixel."""
    h, w = samples.shape
    return np.asarray(samples.reshape(h // fine, fine, w // fine, fine).mean(axis=(1, 3), dtype=np.float64))


def white(part: NDArray[np.float64]) -> Image:
    """Return 255 where at least half of a pixel is covered."""
    return np.where(part >= 0.5, 255, 0).astype(np.uint8)


def smooth(points: Curve, steps: int = 24) -> Curve:
    """Return the closed Catmull-Rom curve through `points`, its speed following the distances (centripetal)."""
    before, after, beyond = (np.roll(points, shift, axis=0) for shift in (1, -1, -2))
    time = np.sqrt(np.hypot(*(after - points).T))[:, None]
    time_before, time_after = np.roll(time, 1, axis=0), np.roll(time, -1, axis=0)
    tangent = (points - before) / time_before - (after - before) / (time_before + time) + (after - points) / time
    tangent_after = (after - points) / time - (beyond - points) / (time + time_after) + (beyond - after) / time_after
    t = np.linspace(0, 1, steps, endpoint=False)[None, :, None]
    start, stop = points[:, None], after[:, None]
    leave, arrive = (time * tangent)[:, None], (time * tangent_after)[:, None]
    bend = (2 * t**3 - 3 * t**2 + 1) * start + (t**3 - 2 * t**2 + t) * leave + (3 * t**2 - 2 * t**3) * stop + (t**3 - t**2) * arrive
    return np.asarray(bend.reshape(-1, 2))


def circle(x: float, y: float, radius: float) -> Curve:
    """Return a circle as a polygon of 720 corners with its area."""
    angle = np.linspace(0, 2 * np.pi, 720, endpoint=False)
    radius *= np.sqrt(2 * np.pi / 720 / np.sin(2 * np.pi / 720))
    return np.stack([x + radius * np.cos(angle), y + radius * np.sin(angle)], axis=1)


def wavy(x: float, y: float, radius: float, seed: int) -> Curve:
    """Return an irregular closed curve: a circle with waves of random height and place."""
    rng = np.random.default_rng(seed)
    angle = np.linspace(0, 2 * np.pi, 1440, endpoint=False)
    r = np.ones_like(angle)
    for waves in range(2, 8):
        r += 0.32 / waves * rng.uniform(0.4, 1) * np.cos(waves * angle + rng.uniform(0, 2 * np.pi))
    return np.stack([x + radius * r * np.cos(angle), y + radius * r * np.sin(angle)], axis=1)


def femur_curve() -> Curve:
    """Return the outline of the femur, in millimetres, y up: outer side, head, inner side."""
    x, y, radius = HEAD
    angle = np.radians(np.linspace(161, -86, 15))  # from the top of the neck over the head to its bottom
    head = np.stack([x + radius * np.cos(angle), y + radius * np.sin(angle)], axis=1)
    return smooth(np.vstack([LATERAL, head, MEDIAL]))


def femur() -> Image:
    """Draw the silhouette of a right femur from the front."""
    return white(coverage([femur_curve() * (PIXELS_PER_MM, -PIXELS_PER_MM) + FEMUR_ORIGIN], FEMUR_SIZE))


def femur_gray() -> Image:
    """Draw the femur with a cortical shell, thick along the shaft, around trabecular bone and the marrow of the shaft."""
    bone = inside([femur_curve() * (PIXELS_PER_MM, -PIXELS_PER_MM) + FEMUR_ORIGIN], FEMUR_SIZE)
    depth = cv2.distanceTransform(bone.astype(np.uint8), cv2.DIST_L2, cv2.DIST_MASK_PRECISE) / (FINE * PIXELS_PER_MM)
    y, x = np.indices(bone.shape, np.float32)
    x, y = (x / FINE - FEMUR_ORIGIN[0]) / PIXELS_PER_MM, (FEMUR_ORIGIN[1] - y / FINE) / PIXELS_PER_MM
    axis = 0.6 - 0.107 * y
    # The cortex is 1.5 mm thin at both ends, 6.5 mm in the middle of the shaft, and thicker again under the neck (calcar).
    cortex = 1.5 + 5.0 / (1 + np.abs((y - 225) / 118) ** 5) + 2.0 * np.exp(-(((x + 12) / 9) ** 2) - ((y - 384) / 15) ** 2)
    marrow = np.abs((y - 224) / 140) ** 2.5 + np.abs((x - axis) / 12.5) ** 2.5 < 1
    level = np.where(depth < cortex, 230.0, np.where(marrow, 70.0, 150.0))
    return np.rint(average(np.where(bone, level, 0))).astype(np.uint8)


def blobs() -> Image:
    """Draw three irregular white shapes."""
    return white(coverage([wavy(135, 160, 98, seed=5), wavy(310, 94, 60, seed=8), wavy(318, 228, 44, seed=3)], (300, 400)))


def blob_with_holes() -> Image:
    """Draw an irregular white shape with round holes of different sizes."""
    holes = [circle(115.3, 120.7, 24.2), circle(188.6, 111.4, 15.5), circle(164.2, 186.9, 31.0), circle(96.8, 188.1, 7.3)]
    return white(coverage([wavy(150, 150, 112, seed=12), *holes], (300, 300)))


def plate() -> Image:
    """Draw a plate with a round hole, no edge on a side of pixels."""
    left, top, right, bottom = 20.3, 24.7, 299.6, 155.2
    rim = np.array([(left, top), (right, top), (right, bottom), (left, bottom)])
    # 16 samples hit such an edge to within 1/32 of a pixel.
    part = coverage([rim, circle(159.95, 89.95, 30.4)], (180, 320), fine=16)
    return np.rint(20 + 180 * part).astype(np.uint8)


def polycrystal(grains: int = 40, size: int = 320) -> Image:
    """Draw a label map of grains: the cells of random seeds, evened out by moving each seed half way to the middle of its cell."""
    rng = np.random.default_rng(7)
    seeds = rng.random((grains, 2)) * size
    centres = np.indices((size, size)).reshape(2, -1).T + 0.5
    for step in range(4):
        nearest = ((centres[:, None] - seeds) ** 2).sum(axis=2).argmin(axis=1)
        if step < 3:
            count = np.bincount(nearest, minlength=grains)
            middle = np.stack([np.bincount(nearest, centres[:, i], minlength=grains) / count for i in (0, 1)], axis=1)
            seeds = (seeds + middle) / 2
    return np.asarray(nearest.reshape(size, size) + 1, np.uint8)


def gear(teeth: int = 28) -> Image:
    """Draw a gear: teeth with parallel sides and square corners, a bore with a keyway, six bolt holes."""
    centre, root, tip, half = np.array([160.0, 160.0]), 122.0, 144.0, 6.6
    reach = np.arcsin(half / root)
    profile = np.array([(root * np.cos(reach), -half), (tip, -half), (tip, half), (root * np.cos(reach), half)])
    gap = np.linspace(reach, 2 * np.pi / teeth - reach, 16)[1:-1]
    profile = np.vstack([profile, np.stack([root * np.cos(gap), root * np.sin(gap)], axis=1)])
    rim = np.vstack([profile @ turn(2 * np.pi * i / teeth) for i in range(teeth)])
    bore, key, deep = 34.0, 9.5, 46.0
    open_angle = np.arcsin(key / bore)
    arc = np.linspace(open_angle, 2 * np.pi - open_angle, 360)
    hub = np.vstack([[(deep, -key), (deep, key)], np.stack([bore * np.cos(arc), bore * np.sin(arc)], axis=1)]) @ turn(-np.pi / 2)
    bolts = [circle(80 * np.cos(a), 80 * np.sin(a), 11.5) for a in np.arange(6) * np.pi / 3]
    return white(coverage([ring + centre for ring in (rim, hub, *bolts)], (320, 320)))


def turn(angle: float) -> NDArray[np.float64]:
    """Return the matrix that turns rows (x, y) by `angle`, from x to y."""
    return np.array([(np.cos(angle), np.sin(angle)), (-np.sin(angle), np.cos(angle))])


PICTURES: dict[str, Callable[[], Image]] = {
    "femur.png": femur,
    "femur_gray.png": femur_gray,
    "blobs.png": blobs,
    "blob_with_holes.png": blob_with_holes,
    "plate.png": plate,
    "polycrystal.png": polycrystal,
    "gear.png": gear,
}


def main() -> None:
    """Draw all images next to this script."""
    for name, draw in PICTURES.items():
        path = Path(__file__).with_name(name)
        cv2.imwrite(str(path), draw(), [cv2.IMWRITE_PNG_COMPRESSION, 9])
        print(f"{path.name:20s} {path.stat().st_size:6d} bytes")


if __name__ == "__main__":
    main()
