"""How many triangles have which quality: one number per triangle -> a chart as an SVG inside a page, without any library.

The bars have the colours the triangles have on the page, so that the chart is the legend.
"""

from __future__ import annotations

import html

import numpy as np
from numpy.typing import NDArray

from img2tri.arrays import Floats

# The colour map viridis in 17 steps: its lightness goes with the value, for all eyes and in gray.
RAMP = [
    "440154", "48186a", "472d7b", "424086", "3b528b", "33638d", "2c728e", "26828e", "21918c", "1fa088", "28ae80", "3fbc73", "5ec962",
    "84d44b", "addc30", "d8e219", "fde725",
]  # fmt: skip
BARS = 50
_WIDTH, _HEIGHT, _FOOT = 480, 150, 172  # of the chart; where the bars stand; where the numbers below them end


def bins(values: Floats, most: float) -> NDArray[np.uint8]:
    """Return the number of the bar each value is counted in, 0 to 49.

    Examples
    --------
    >>> bins(np.array([0.0, 0.5, 1.0, np.nan]), 1.0).tolist()
    [0, 25, 49, 0]
    """
    limits = np.linspace(0, most, BARS + 1)
    return (np.searchsorted(limits, np.nan_to_num(values).clip(0, most), side="right") - 1).clip(0, BARS - 1).astype(np.uint8)


def chart(name: str, title: str, words: str, values: Floats, most: float, unit: str) -> str:
    """Draw how many triangles have which value.

    Parameters
    ----------
    name
        What the page calls the values: a click on a bar chooses its triangles.
    title, words
        Above the chart, on the left and on the right.
    values
        (m,) float64; what lies outside of 0 to `most` counts as one of these.
    most
        The best value.
    unit
        Behind every number.

    Returns
    -------
    str
        HTML.

    Examples
    --------
    >>> chart("quality", "Quality", "", np.array([0.25, 1.0]), 1.0, "").rpartition('"quiet">')[2]
    'worst 0.250 · 1 % below 0.258 · mean 0.625</div></section>'
    """
    shown = np.nan_to_num(values).clip(0, most)
    counts, limits = np.bincount(bins(values, most), minlength=BARS), np.linspace(0, most, BARS + 1)
    step, tallest = _WIDTH / BARS, (_HEIGHT - 8) / max(int(counts.max()), 1)
    bars = "".join(
        f'<rect x="{i * step:.2f}" y="{_HEIGHT - count * tallest:.2f}" width="{step - 0.6:.2f}" height="{count * tallest:.2f}" '
        f'fill="#{shade((i + 0.5) / BARS)}"/><rect class="hit" role="button" tabindex="-1" data-bin="{name}:{i}" x="{i * step:.2f}" y="0" '
        f'width="{step:.2f}" height="{_HEIGHT}"><title>{low:g}{unit} to {high:g}{unit}: {count:,} triangles</title></rect>'
        for i, (count, low, high) in enumerate(zip(counts.tolist(), limits[:-1], limits[1:], strict=True))
        if count
    )
    ticks = "".join(
        f'<text x="{k * _WIDTH / 4:.0f}" y="{_FOOT - 6}" text-anchor="{anchor}">{k * most / 4:g}{unit}</text>'
        for k, anchor in enumerate(["start", "middle", "middle", "middle", "end"])
    )
    worst, form = shown.min() / most * _WIDTH, ".3f" if most <= 1 else ".1f"
    figures = {"worst": shown.min(), "1 % below": np.quantile(shown, 0.01), "mean": shown.mean()}
    numbers = " · ".join(f"{name} {value:{form}}{unit}" for name, value in figures.items())
    return (
        f'<section class="card"><div class="head"><h2>{html.escape(title)}</h2><span class="quiet">{html.escape(words)}</span></div>'
        f'<svg class="chart" viewBox="0 0 {_WIDTH} {_FOOT}" role="group" aria-label="{html.escape(title)}: {numbers}">'
        f'<line class="axis" x1="0" x2="{_WIDTH}" y1="{_HEIGHT}" y2="{_HEIGHT}"/>{bars}'
        f'<line class="worst" x1="{worst:.1f}" x2="{worst:.1f}" y1="{_HEIGHT - 26}" y2="{_HEIGHT}"/>{ticks}'
        f'</svg><div class="quiet">{numbers}</div></section>'
    )


def shade(share: float) -> str:
    """Return the colour for 0..1 as six digits, between the steps of `RAMP` in proportion.

    Examples
    --------
    >>> shade(0.0), shade(1.0)
    ('440154', 'fde725')
    """
    steps = np.array([[int(colour[i : i + 2], 16) for i in (0, 2, 4)] for colour in RAMP])
    at = np.linspace(0, 1, len(RAMP))
    return "".join(f"{round(float(np.interp(share, at, steps[:, i]))):02x}" for i in range(3))
