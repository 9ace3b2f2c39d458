"""Random label maps, gray images and options for hypothesis: small, and as awkward as they come."""

from __future__ import annotations

import numpy as np
from hypothesis import HealthCheck, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

# The same examples in every run; and many new ones in each, when asked for by  pytest -m slow.
QUICK = settings(max_examples=40, deadline=None, derandomize=True, suppress_health_check=[HealthCheck.too_slow])
FEW = settings(QUICK, max_examples=15)
THOROUGH = settings(max_examples=2000, deadline=None, suppress_health_check=[HealthCheck.too_slow, HealthCheck.filter_too_much])

SEEDS = st.integers(0, 2**32 - 1)


def shapes(largest=12):
    """(h, w), from a single pixel on."""
    return st.tuples(st.integers(1, largest), st.integers(1, largest))


@st.composite
def noise(draw, largest=12):
    """Pixels that know nothing of each other, white with any density."""
    shape, density = draw(shapes(largest)), draw(st.floats(0, 1))
    return (np.random.default_rng(draw(SEEDS)).random(shape) < density).astype(np.int64)


def masks(largest=12):
    """Every pixel chosen by hypothesis, so that it can take out what does not matter."""
    return hnp.arrays(np.int64, shapes(largest), elements=st.integers(0, 1))


def labels(largest=12):
    """Likewise, with up to eight labels."""
    return st.integers(1, 7).flatmap(lambda most: hnp.arrays(np.int64, shapes(largest), elements=st.integers(0, most)))


@st.composite
def blots(draw, largest=16):
    """Smooth zones: a random image, averaged over its neighbours several times, cut at evenly spread levels."""
    shape, count = draw(shapes(largest)), draw(st.integers(2, 5))
    values = np.random.default_rng(draw(SEEDS)).random(shape)
    for _ in range(draw(st.integers(1, 6))):
        p = np.pad(values, 1, mode="edge")
        values = (p[:-2, 1:-1] + p[2:, 1:-1] + p[1:-1, :-2] + p[1:-1, 2:] + p[1:-1, 1:-1]) / 5
    return np.searchsorted(np.quantile(values, np.arange(1, count) / count), values)


@st.composite
def grains(draw, largest=16):
    """Nearest of some seeds: straight interfaces at any angle, and junctions."""
    h, w = draw(shapes(largest))
    rng = np.random.default_rng(draw(SEEDS))
    seeds = rng.random((draw(st.integers(1, 9)), 2)) * [h, w]
    y, x = np.mgrid[:h, :w] + 0.5
    return np.argmin([np.hypot(y - r, x - c) for r, c in seeds], axis=0)


@st.composite
def label_maps(draw, largest=12):
    """Any of these, with numbers of any size for labels."""
    values = draw(st.one_of(noise(largest), masks(largest), labels(largest), blots(largest + 4), grains(largest + 4)))
    if draw(st.booleans()):
        return values
    count = int(values.max()) + 1
    numbers = draw(st.lists(st.integers(-(2**40), 2**40), min_size=count, max_size=count, unique=True))
    return np.array(numbers, np.int64)[values]


@st.composite
def maps_and_backgrounds(draw, largest=12):
    """A label map with something to mesh in it, and what of it is not meshed: one of its labels, none, or one it does not have."""
    values = draw(label_maps(largest))
    present = np.unique(values).tolist()
    choices = [None, -7, *(present if len(present) > 1 else [])]
    background = draw(st.sampled_from(choices))
    return values, None if background in present and len(present) == 1 else background


def edge_lengths():
    """In pixels, from much finer than the pixels to larger than the image."""
    return st.floats(1, 40)


def tolerances():
    """In pixels."""
    return st.floats(0.1, 2)


def min_angles():
    """Degrees."""
    return st.floats(0, 30)


@st.composite
def gray_images(draw, largest=14):
    """uint8 or float, hard or soft edges, and a threshold that leaves something of it."""
    shape = draw(st.tuples(st.integers(2, largest), st.integers(2, largest)))
    values = np.random.default_rng(draw(SEEDS)).random(shape)
    for _ in range(draw(st.integers(0, 3))):
        p = np.pad(values, 1, mode="edge")
        values = (p[:-2, 1:-1] + p[2:, 1:-1] + p[1:-1, :-2] + p[1:-1, 2:] + 2 * p[1:-1, 1:-1]) / 6
    values = (values - values.min()) / np.ptp(values)
    image = np.round(values * 255).astype(np.uint8) if draw(st.booleans()) else values * 10 - 3
    low, high = np.quantile(image.astype(float), [0.0, 0.9])
    return image, float(low + (high - low) * draw(st.floats(0, 0.99)))
