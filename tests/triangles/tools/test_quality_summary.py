"""Quality against pyvista (Verdict), against libigl's own radii, and against triangles known by heart."""

from __future__ import annotations

import json
import math

import igl
import numpy as np
import pytest

from img2tri.errors import MeshError, ParameterError
from img2tri.triangles.tools.quality_summary import DEFAULT, assess, measure
from img2tri.triangles.tools.triangle_metrics import METRICS, UNBOUNDED

VERDICT = sorted(set(METRICS) - {"q", "shortest_edge", "longest_edge"})


def separate(corners):
    """Triangles (m, 3, 2) as a mesh."""
    return corners.reshape(-1, 2), np.arange(3 * len(corners)).reshape(-1, 3)


def any_triangles(seed=0, m=3000):
    """Random triangles of any shape: a third of them needles or nearly flat, half of them turned over.

    Not worse than this, since Verdict takes angles by the arc cosine: it loses digits on needles, as `measure` does not.
    """
    rng = np.random.default_rng(seed)
    corners = rng.normal(size=(m, 3, 2)) * 10.0 ** rng.uniform(-2, 2, (m, 1, 1))
    k = m // 6
    corners[:k, :, 1] *= 10.0 ** rng.uniform(-2, 0, (k, 1))
    corners[k : 2 * k, 1] = corners[k : 2 * k, 0] + (corners[k : 2 * k, 1] - corners[k : 2 * k, 0]) * 10.0 ** rng.uniform(-2, 0, (k, 1))
    return separate(corners)


def verdict(vertices, triangles, names):
    import pyvista as pv

    surface = pv.PolyData.from_regular_faces(np.c_[vertices, np.zeros(len(vertices))], triangles)
    measured = surface.cell_quality(list(names))
    return {name: np.asarray(measured.cell_data[name]) for name in names}


@pytest.mark.parametrize("name", VERDICT)
def test_agrees_with_pyvista(name):
    v, t = any_triangles()
    np.testing.assert_allclose(measure(v, t, [name])[name], verdict(v, t, [name])[name], rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize("name", sorted(set(VERDICT) - {"relative_size_squared"}))
def test_ranges_are_those_of_pyvista(name):
    import pyvista as pv

    info = pv.cell_quality_info(pv.CellType.TRIANGLE, name)
    metric = METRICS[name]
    if metric.acceptable is not None:
        assert metric.acceptable == pytest.approx((info.acceptable_range[0], min(info.acceptable_range[1], metric.range[1])))
    if metric.best is not None:
        assert metric.best == pytest.approx(info.unit_cell_value)


def test_q_is_twice_the_inradius_over_the_circumradius():
    v, t = any_triangles()
    np.testing.assert_allclose(measure(v, t, ["q"])["q"], 2 * igl.inradius(v, t) / igl.circumradius(v, t)[0], rtol=1e-6, atol=1e-9)
    np.testing.assert_allclose(measure(v, t, ["q"])["q"], 1 / measure(v, t, ["radius_ratio"])["radius_ratio"], rtol=1e-12)


def test_the_equilateral_triangle_is_the_best():
    v, t = separate(np.array([[[0, 0], [2, 0], [1, math.sqrt(3)]]]))
    measured = measure(v, t, list(METRICS))
    for name, metric in METRICS.items():
        assert measured[name][0] == pytest.approx({"area": math.sqrt(3), "shortest_edge": 2, "longest_edge": 2}.get(name, metric.best))


def test_a_right_triangle():
    measured = measure([[0, 0], [4, 0], [0, 3]], [[0, 1, 2]], list(METRICS))
    assert measured["q"][0] == pytest.approx(0.8)  # r = 1, R = 2.5
    assert measured["max_angle"][0] == pytest.approx(90)
    assert measured["min_angle"][0] == pytest.approx(math.degrees(math.atan(0.75)))
    assert measured["area"][0] == pytest.approx(6)
    assert (measured["shortest_edge"][0], measured["longest_edge"][0]) == pytest.approx((3, 5))


def test_values_lie_in_their_ranges():
    v, t = any_triangles(1)
    for name, values in measure(v, t, list(METRICS)).items():
        low, high = METRICS[name].range
        assert values.dtype == np.float64
        assert values.min() >= low - 1e-12
        assert values.max() <= high + 1e-12


def test_needles_keep_their_angles():
    height = 10.0 ** -np.arange(1, 13)
    corners = np.zeros((12, 3, 2))
    corners[:, 1] = [1, 0]
    corners[:, 2, 0], corners[:, 2, 1] = 1, height
    v, t = separate(corners)
    np.testing.assert_allclose(measure(v, t, ["min_angle"])["min_angle"], np.degrees(np.arctan(height)), rtol=1e-12)


FLAT = {
    "on a line": ([[0, 0], [1, 0], [3, 0]], 0.0, 180.0),
    "two coincide": ([[0, 0], [0, 0], [3, 1]], 0.0, 90.0),
    "all coincide": ([[1, 1], [1, 1], [1, 1]], 0.0, 180.0),
}


@pytest.mark.parametrize("name", list(FLAT))
def test_triangles_without_area_have_defined_measures(name):
    corners, smallest, largest = FLAT[name]
    quality = assess(corners, [[0, 1, 2]], list(METRICS))
    value = {key: array[0] for key, array in quality.arrays.items()}
    assert quality.flat == 1
    assert quality.turned_over == 0
    assert (value["min_angle"], value["max_angle"]) == (smallest, largest)
    assert all(value[key] == 0 for key in ("q", "area", "shape", "scaled_jacobian", "relative_size_squared", "shape_and_size"))
    assert all(value[key] == UNBOUNDED for key in ("radius_ratio", "aspect_ratio", "aspect_frobenius", "condition"))
    assert np.isfinite(list(value.values())).all()


def test_flat_triangles_agree_with_pyvista_where_it_is_sensible():
    v, t = separate(np.array([[[0, 0], [1, 0], [3, 0]], [[0, 0], [1, 0], [0, 1]]], float))
    expected = verdict(v, t, VERDICT)
    for name, values in measure(v, t, VERDICT).items():
        np.testing.assert_allclose(values, expected[name], rtol=1e-9, atol=1e-9, err_msg=name)


def test_turned_over_triangles_are_counted_and_measure_as_their_mirror_image():
    v = np.array([[0, 0], [1, 0], [0.2, 0.7]])
    one, other = assess(v, [[0, 1, 2]], list(METRICS)), assess(v, [[0, 2, 1]], list(METRICS))
    assert (one.turned_over, other.turned_over) == (0, 1)
    for name in METRICS:
        assert one.arrays[name] == pytest.approx(other.arrays[name])


def test_metrics_are_those_named_in_their_order():
    v, t = any_triangles(2, 6)
    assert tuple(measure(v, t)) == DEFAULT
    assert list(measure(v, t, ["shape", "area"])) == ["shape", "area"]
    assert list(measure(v, t, "area")) == ["area"]
    with pytest.raises(ParameterError, match=r"metrics: expected one of 'q', 'min_angle', .* found 'skewness'"):
        measure(v, t, ["skewness"])
    with pytest.raises(MeshError, match="triangles"):
        measure(v, t[:0])


def test_summary_by_sorting():
    v, t = any_triangles(3, 400)
    quality = assess(v, t, ["q", "area"])
    for name, values in quality.arrays.items():
        row, ranked = quality.summary()[name], np.sort(values)
        assert (row["min"], row["max"]) == (ranked[0], ranked[-1])
        assert row["mean"] == pytest.approx(math.fsum(values) / 400)
        assert ranked[3] <= row["p1"] <= ranked[4]
        assert ranked[395] <= row["p99"] <= ranked[396]


def test_histogram_counts_every_triangle_once():
    v, t = any_triangles(4)
    quality = assess(v, t, list(METRICS))
    for name in METRICS:
        counts, edges = quality.histogram(name)
        assert counts.sum() == len(t)
        assert len(edges) == len(counts) + 1 == 21
    assert quality.histogram("q")[1][[0, -1]].tolist() == [0, 1]
    assert quality.histogram("min_angle", bins=6)[1].tolist() == [0, 10, 20, 30, 40, 50, 60]
    angle = quality.arrays["min_angle"]
    assert quality.histogram("min_angle", bins=6)[0][3] == ((angle >= 30) & (angle < 40)).sum()


def test_histogram_counts_what_rounding_puts_beyond_the_end():
    turn = np.linspace(0, 6, 200)[:, None] + np.arange(3) * 2 * np.pi / 3
    quality = assess(*separate(np.stack([np.cos(turn), np.sin(turn)], axis=2)), ["min_angle", "max_angle", "q"])
    assert quality.arrays["q"].max() > 1
    for name, last in (("min_angle", -1), ("max_angle", 0), ("q", -1)):
        assert quality.histogram(name)[0][last] == 200


def test_histogram_errors():
    quality = assess([[0, 0], [1, 0], [0, 1]], [[0, 1, 2]], ["q"])
    with pytest.raises(ParameterError, match="name: expected one of 'q', found 'area'"):
        quality.histogram("area")
    with pytest.raises(ParameterError, match="bins: expected a whole number of at least 1, found 0"):
        quality.histogram("q", bins=0)


def test_dictionary_survives_json():
    v, t = any_triangles(5, 50)
    quality = assess(v, t)
    data = json.loads(json.dumps(quality.to_dict(), allow_nan=False))
    assert data["triangles"] == 50
    assert data["turned_over"] == quality.turned_over > 0
    assert data["metrics"]["min_angle"]["unit"] == "degrees"
    assert data["metrics"]["q"]["mean"] == quality.summary()["q"]["mean"]


def test_table_names_what_is_wrong():
    text = str(assess([[0, 0], [1, 0], [0, 1], [2, 0]], [[0, 1, 2], [0, 2, 1], [0, 1, 3]]))
    assert text.splitlines()[0] == "3 triangles, 1 turned over, 1 without area"
    assert [line.split()[0] for line in text.splitlines()[2:]] == list(DEFAULT)
    assert max(map(len, text.splitlines())) <= 80


def test_table_tells_figures_and_units():
    quality = assess([[0, 0], [4, 0], [0, 3]], [[0, 1, 2]], list(METRICS))
    head, columns, *rows = str(quality).splitlines()
    assert head == "1 triangles"
    assert columns.split() == ["min", "1", "%", "mean", "99", "%", "max"]
    for name, row in zip(METRICS, rows, strict=True):
        figure = f"{quality.arrays[name][0]:.4g}"
        assert row.split() == [name, *5 * [figure], *(["degrees"] if name.endswith("_angle") else [])]


def test_ratios_beyond_all_numbers_are_capped():
    value = assess([[0, 0], [1, 0], [0.5, 1e-310]], [[0, 1, 2]], list(METRICS)).arrays
    assert all(value[key][0] == UNBOUNDED for key in ("radius_ratio", "aspect_ratio", "aspect_frobenius", "condition"))
    assert 0 <= value["q"][0] < 1e-300


def test_arguments_are_not_changed():
    v, t = any_triangles(6, 20)
    before = v.copy(), t.copy()
    assess(v, t, list(METRICS))
    assert (v == before[0]).all()
    assert (t == before[1]).all()


def test_what_a_prompt_shows_is_the_table():
    quality = assess([[0, 0], [1, 0], [0, 1]], [[0, 1, 2]])
    assert repr(quality) == str(quality)
    assert len(repr(assess(*any_triangles(6, 2000)))) < 1000
