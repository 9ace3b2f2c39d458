"""The field of edge lengths, against the least of all lengths wanted anywhere, each grown by its distance."""

from __future__ import annotations

import numpy as np
import oracles
import pytest
import specimens
from scipy.spatial.distance import cdist

from img2tri import mesh_image
from img2tri.errors import ParameterError
from img2tri.shapes.sizes.user_size_field import FIRST_CELLS, LENGTH_STEP, MOST_FIELD_CELLS, size_field
from img2tri.types import Frame

LABELS = np.zeros((30, 40), int)
LABELS[5:12, 5:30], LABELS[20:, 33:] = 1, 2
FRAME = Frame(LABELS.shape)


def centres(frame):
    rows, columns = np.mgrid[: frame.shape[0], : frame.shape[1]] + 0.5
    return frame.xy(rows.ravel(), columns.ravel())


def grown(wanted, frame, gradation):
    """For each pixel the least, over all others, of what these want plus what is grown on the way."""
    places = centres(frame)
    return (wanted.ravel() + gradation * cdist(places, places)).min(axis=1)


def in_plane(places, frame):
    return (places - frame.corner) / frame.pixel


@pytest.mark.parametrize("gradation", [0.1, 0.4, 2.0])
@pytest.mark.parametrize("frame", [FRAME, Frame(LABELS.shape, (0.25, 0.25), (7, -3)), Frame(LABELS.shape, upward=False)])
def test_no_length_grows_faster_than_the_gradation(frame, gradation):
    wanted = np.random.default_rng(0).uniform(1, 20, LABELS.shape) * frame.pixel
    longest, field = size_field(wanted, frame, LABELS, gradation=gradation)
    found, truth = field(in_plane(centres(frame), frame)) * frame.pixel, grown(wanted, frame, gradation)
    assert (found <= wanted.ravel() * (1 + 1e-12)).all()
    assert (found >= truth / LENGTH_STEP**0.5 - 1e-9).all()
    assert (found <= truth * LENGTH_STEP + 1e-9).all()
    assert longest == field.grid.max()


def test_a_function_an_array_and_labels_say_the_same():
    frame = Frame(LABELS.shape, (0.5, 0.5), (10, 20))
    array = np.array([6.0, 1.0, 3.0])[LABELS]

    def function(places):
        rows, columns = frame.row_column(places)
        return array[rows.astype(int), columns.astype(int)]

    (a, one), (b, two), (c, three) = (
        size_field(wanted, frame, LABELS, gradation=0.3) for wanted in ({0: 6, 1: "2px", 2: "12%"}, array, function)
    )
    diagonal = float(np.hypot(15, 20))
    assert 0.12 * diagonal == 3
    assert (a, b) == (pytest.approx(c), c)
    assert one.grid == pytest.approx(two.grid, rel=1e-12)
    assert (two.grid == three.grid).all()
    # Rows of the field go up, those of the image down.
    assert one.grid[20, 10] == pytest.approx(2)
    assert one.grid[4, 35] == pytest.approx(6)


def test_labels_left_out_take_the_greatest():
    for wanted in ({1: 2, 2: 5}, {1: 2, 2: 5, 0: 5}):
        longest, field = size_field(wanted, FRAME, LABELS, gradation=100)
        assert longest == 5
        assert sorted(set(field.grid.ravel())) == [2, 5]
        assert (field.grid == 2).sum() == (LABELS == 1).sum()


def test_between_centres_lengths_are_interpolated_and_beyond_the_image_they_are_those_of_its_rim():
    _, field = size_field(np.tile(np.arange(1.0, 41), (30, 1)), FRAME, LABELS, gradation=5)
    assert field(np.array([[0.5, 3.0], [1.5, 3.0], [1.25, 3.0]])) == pytest.approx([1, 2, 1.75])
    assert field(np.array([[-100, 3.0], [1e6, 3.0]])) == pytest.approx([1, 40])


def test_one_length_needs_no_field():
    frame = Frame((30, 40), (0.5, 0.5))
    for wanted, length in ((8, 16), (np.float32(8), 16), ("8px", 8), ("4%", 2)):
        assert size_field(wanted, frame, LABELS, gradation=0.3) == (pytest.approx(length), None)


def test_a_large_image_gets_coarser_cells():
    _, field = size_field(lambda places: np.where(places[:, 0] < 100, 2, 5 + places[:, 0]), Frame((3000, 2000)), LABELS, gradation=10)
    assert field.cell == pytest.approx(np.sqrt(6e6 / MOST_FIELD_CELLS))
    assert 0.99 * MOST_FIELD_CELLS < field.grid.size < 1.01 * MOST_FIELD_CELLS
    assert field(np.array([[1000.0, 1500.0]])) == pytest.approx(1005, rel=1e-6)


@pytest.mark.parametrize("upward", [True, False])
@pytest.mark.parametrize("spacing", [(1.0, 1.0), (0.5, 2.0)])
def test_no_pixel_of_a_large_image_is_lost(spacing, upward):
    """Not even a single one whose length is short, in cells of several pixels."""
    frame = Frame((3000, 2000), spacing, upward=upward)
    wanted = np.full(frame.shape, 50.0)
    row, column = 1234, 567
    wanted[row, column] = 5
    _, field = size_field(wanted, frame, wanted, gradation=0.5)
    at = in_plane(frame.xy(row + 0.5, column + 0.5)[None], frame)
    assert field.cell > 1.5
    assert field(at) * frame.pixel <= 5 + 0.5 * field.cell * frame.pixel
    far = in_plane(frame.xy(row + 0.5 + 100 / spacing[1], column + 0.5)[None], frame)
    assert field(far) * frame.pixel == 50
    ny, nx = field.grid.shape
    assert ny * field.cell == pytest.approx(3000 * spacing[1] / frame.pixel, abs=field.cell)
    assert nx * field.cell == pytest.approx(2000 * spacing[0] / frame.pixel, abs=field.cell)


@pytest.mark.parametrize("shortest", [0.2, 2.0, 8.0, 100.0])
def test_a_function_is_asked_in_cells_as_small_as_its_shortest_length(shortest):
    frame, asked = Frame((1000, 1000)), []

    def cone(places):
        asked.append(len(places))
        return shortest + 0.3 * np.hypot(*(places - [312.3, 640.7]).T)

    _, field = size_field(cone, frame, LABELS, gradation=0.3)
    coarsest = 1000 / np.sqrt(FIRST_CELLS)
    assert max(1, min(shortest, coarsest)) <= field.cell <= max(1, min(1.7 * shortest, coarsest))
    assert sum(asked) <= 2 * field.grid.size + FIRST_CELLS
    away = np.random.default_rng(0).uniform(0, 1000, (1000, 2))
    truth = shortest + 0.3 * np.hypot(*(away - [312.3, 640.7]).T)
    assert field(away) == pytest.approx(truth, abs=0.3 * field.cell)


@pytest.mark.parametrize(
    ("wanted", "words"),
    [
        (None, "expected a length, lengths by label, an array or a function, found NoneType"),
        ([8, 8], "expected a length, lengths by label, an array or a function, found list"),
        (dict, "expected a length, lengths by label, an array or a function, found type"),
        (lambda places: 8.0, "expected the function to return (1200,) lengths, found shape ()"),
        (lambda places: places, "expected the function to return (1200,) lengths, found shape (1200, 2)"),
        (lambda places: places[:, 0] - 5, "expected lengths above 0 everywhere, found -4.5 to 34.5"),
        (np.ones((40, 30)), "expected an array of the shape of the image (30, 40), found (40, 30)"),
        (np.full((30, 40), "8"), "expected an array of numbers, found <U1"),
        (np.ones((30, 40), bool), "expected an array of numbers, found bool"),
        (np.zeros((30, 40)), "expected lengths above 0 everywhere, found 0 to 0"),
        (np.full((30, 40), np.inf), "expected lengths above 0 everywhere, found inf to inf"),
        ({}, "expected lengths by label, found none"),
        ({1: 8, 3: 8}, "expected labels of the image, found 3, which it does not have"),
    ],
)
def test_what_is_no_length_is_refused(wanted, words):
    with pytest.raises(ParameterError) as refused:
        size_field(wanted, FRAME, LABELS, gradation=0.3, name="size")
    assert str(refused.value) == f"size: {words}"


def test_a_wrong_length_of_a_label_names_it():
    with pytest.raises(ParameterError, match=r"^edge_length\[1\]: expected a number above 0, found -1"):
        size_field({1: -1}, FRAME, LABELS, gradation=0.3)


@pytest.mark.parametrize("steepness", [0.1, 0.3, 0.31, 2.0])
def test_what_grows_no_faster_is_left_as_it_is(steepness):
    """Within the steps in which reach is looked at; a cone as steep as the limit is not touched, a steeper one is cut down to it."""
    y, x = np.mgrid[:60, :80] + 0.5
    asked = 2 + steepness * np.hypot(x - 31.3, y - 22.8)
    _, field = size_field(asked, Frame((60, 80), upward=False), asked, gradation=0.3)
    assert (field.grid <= asked + 1e-12).all()
    assert (field.grid == asked).all() == (steepness <= 0.3)
    lowest = np.unravel_index(asked.argmin(), asked.shape)
    limit = asked.min() + 0.3 * np.hypot(x - x[lowest], y - y[lowest])
    assert (field.grid <= 1.12 * limit).all()


@pytest.mark.parametrize("sign", [1, -1])
def test_growth_is_limited_along_diagonals_too(sign):
    y, x = np.mgrid[:60, :80] + 0.5
    for slope in (0.2, 0.25):  # 0.28 and 0.35 along the diagonal
        asked = 30 + slope * (x + sign * y)
        _, field = size_field(asked, Frame((60, 80), upward=False), asked, gradation=0.3)
        assert (field.grid == asked).all() == (slope == 0.2)
        assert (field.grid <= asked + 1e-12).all()


@pytest.mark.parametrize("growth", [0.1, 0.3])
@pytest.mark.parametrize("asked", [2, 4])
def test_edges_along_an_outline_that_lengths_grow_away_from_are_as_long_as_asked(asked, growth):
    centre, radius, n = (70.3, 69.8), 42, 140
    disc = specimens.disc(n, radius, centre)

    def lengths(places):
        return asked + growth * abs(np.hypot(places[:, 0] - centre[1], places[:, 1] - (n - centre[0])) - radius)

    mesh = mesh_image(disc, edge_length=lengths, gradation=0.3)
    ends = mesh.vertices[oracles.boundary(mesh.triangles)]
    assert np.hypot(*(ends[:, 0] - ends[:, 1]).T).mean() == pytest.approx(asked, rel=0.02)
