"""How good the triangles of a mesh are, in numbers: every one measured, their summary and their histogram.

In: vertices and triangles. Out: one number per triangle for each metric of `triangle_metrics`, and the record that sums them up.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from img2tri.arrays import Floats, Ints
from img2tri.errors import choice, integer
from img2tri.triangles.tools.mesh_checks import check_mesh
from img2tri.triangles.tools.triangle_metrics import METRICS, Geometry

DEFAULT = ("q", "min_angle", "max_angle", "radius_ratio", "area", "shortest_edge", "longest_edge")
"""The metrics measured when none are named."""


def measure(vertices: ArrayLike, triangles: ArrayLike, metrics: Sequence[str] | None = None) -> dict[str, Floats]:
    """Measure every triangle.

    Parameters
    ----------
    vertices : (n, 2) float64
    triangles : (m, 3) int64
    metrics
        Names out of `METRICS`, in the order wanted; None takes `DEFAULT`. Each costs time only when named.

    Returns
    -------
    dict
        (m,) float64 for each name, finite for any triangle.

    Raises
    ------
    MeshError
        The arrays are not a mesh.
    ParameterError
        A name that is not known; the message lists those that are.

    Examples
    --------
    >>> measured = measure([[0, 0], [1, 0], [0, 1]], [[0, 1, 2]], ["min_angle", "q"])
    >>> {name: values.round(3).tolist() for name, values in measured.items()}
    {'min_angle': [45.0], 'q': [0.828]}
    """
    return _measure(Geometry(*check_mesh(vertices, triangles)), _names(metrics))


def assess(vertices: ArrayLike, triangles: ArrayLike, metrics: Sequence[str] | None = None) -> Quality:
    """Measure every triangle, as `measure` does, and return the record that sums it up.

    Examples
    --------
    >>> print(assess([[0, 0], [1, 0], [1, 1], [0, 1]], [[0, 1, 2], [0, 2, 3]], ["q", "min_angle", "area"]))
    2 triangles
                      min      1 %     mean     99 %      max
    q              0.8284   0.8284   0.8284   0.8284   0.8284
    min_angle          45       45       45       45       45  degrees
    area              0.5      0.5      0.5      0.5      0.5
    """
    t = Geometry(*check_mesh(vertices, triangles))
    return Quality(_measure(t, _names(metrics)), turned_over=int((t.areas < 0).sum()), flat=int((t.areas == 0).sum()))


def _names(metrics: Sequence[str] | None) -> Sequence[str]:
    names = DEFAULT if metrics is None else [metrics] if isinstance(metrics, str) else metrics
    return [choice("metrics", name, list(METRICS)) for name in names]


def _measure(triangles: Geometry, names: Sequence[str]) -> dict[str, Floats]:
    return {name: METRICS[name].function(triangles) for name in names}


@dataclass(frozen=True, eq=False)
class Quality:
    """The measures of all triangles of a mesh.

    Attributes
    ----------
    arrays
        (m,) float64 for each metric, by name.
    turned_over
        Number of clockwise triangles: 0 in a valid mesh.
    flat
        Number of triangles without any area: 0 in a valid mesh.
    """

    arrays: dict[str, Floats]
    turned_over: int = 0
    flat: int = 0

    def summary(self) -> dict[str, dict[str, float]]:
        """Return "min", "p1", "mean", "p99" and "max" of each metric; "p1" is the value that 1 % of the triangles do not exceed.

        The worst percent is "p1" of a metric that is best when large, and "p99" of one that is best when small.
        """
        table = {}
        for name, values in self.arrays.items():
            p1, p99 = np.quantile(values, [0.01, 0.99])
            figures = {"min": values.min(), "p1": p1, "mean": values.mean(), "p99": p99, "max": values.max()}
            table[name] = {key: float(figure) for key, figure in figures.items()}
        return table

    def histogram(self, name: str, bins: int = 20) -> tuple[Ints, Floats]:
        """Count the triangles in `bins` equal steps of a metric.

        The steps cover all values that are possible where both ends are known (0 to 1 for `q`, 0 to 60 degrees for `min_angle`), so that
        histograms of two meshes can be laid over each other; else the values that occur.

        Returns
        -------
        counts : (bins,) int64
            Their sum is the number of triangles.
        edges : (bins + 1,) float64
        """
        values = self.arrays[choice("name", name, list(self.arrays))]
        low, high = METRICS[name].range
        limits = (low, high) if np.isfinite(high) else (float(values.min()), float(values.max()))
        counts, edges = np.histogram(np.clip(values, *limits), bins=integer("bins", bins, least=1), range=limits)
        return counts.astype(np.int64), edges

    def to_dict(self) -> dict[str, Any]:
        """Return counts, units and summary as plain numbers and strings, fit for JSON."""
        metrics = {name: {"unit": METRICS[name].unit, **figures} for name, figures in self.summary().items()}
        return {"triangles": self._number, "turned_over": self.turned_over, "flat": self.flat, "metrics": metrics}

    @property
    def _number(self) -> int:
        return len(next(iter(self.arrays.values()), ()))

    def _repr_html_(self) -> str:
        """Return the table for a notebook."""
        rows = [
            f"<tr><th>{name}</th>{''.join(f'<td>{figure:.4g}</td>' for figure in figures.values())}<td>{unit}</td></tr>"
            for name, figures in self.summary().items()
            for unit in ["degrees" if METRICS[name].unit == "degrees" else ""]
        ]
        heads = "".join(f"<th>{key}</th>" for key in ("", "min", "1 %", "mean", "99 %", "max", ""))
        return f"<table><caption>{str(self).partition(chr(10))[0]}</caption><tr>{heads}</tr>{''.join(rows)}</table>"

    def __repr__(self) -> str:
        return str(self)

    def __str__(self) -> str:
        head = f"{self._number} triangles"
        head += f", {self.turned_over} turned over" if self.turned_over else ""
        head += f", {self.flat} without area" if self.flat else ""
        width = max([12, *map(len, self.arrays)])
        lines = [head, " " * width + "".join(f"{key:>10}" for key in ("min", "1 %", "mean", "99 %", "max"))]
        for name, figures in self.summary().items():
            unit = "degrees" if METRICS[name].unit == "degrees" else ""
            lines.append(f"{name:<{width}}" + "".join(f"{figure:10.4g}" for figure in figures.values()) + (f"  {unit}" if unit else ""))
        return "\n".join(lines)
