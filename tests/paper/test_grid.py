"""The structured grid, against the listing."""

from __future__ import annotations

import numpy as np
import pytest
from benchmarks import listing

from img2tri.errors import ImageError, ParameterError
from img2tri.paper.grid import mask_filter, structured_grid


def noise(shape, seed=0):
    return np.random.default_rng(seed).random(shape) < 0.5


@pytest.mark.parametrize("shape", [(1, 1), (10, 10), (11, 10), (64, 97), (300, 20)])
def test_the_grid_is_that_of_the_listing(shape):
    grid = structured_grid(shape)
    np.testing.assert_array_equal(grid, listing.generate_mesh(shape))
    assert grid.dtype == np.float64


def test_step_changes_the_distance():
    grid = structured_grid((8, 8), step=2.5)
    assert sorted(set(grid[:, 0])) == [0, 2.5, 5, 7.5]


def test_step_may_differ_across_and_down():
    grid = structured_grid((8, 8), step=(4, 2))
    assert (len(set(grid[:, 0])), len(set(grid[:, 1]))) == (2, 4)


@pytest.mark.parametrize("shape", [(64, 97), (7, 300)])
def test_the_filter_is_that_of_the_listing(shape):
    mask, points = noise(shape), structured_grid(shape, step=3)
    np.testing.assert_array_equal(mask_filter(points, mask), listing.adjust_mesh(points, mask * np.uint8(255)))


def test_points_between_pixels_belong_to_the_pixel_the_listing_looks_up():
    mask = noise((20, 30))
    points = np.random.default_rng(1).uniform(0, [30, 20], (500, 2))
    np.testing.assert_array_equal(mask_filter(points, mask), listing.adjust_mesh(points, mask * np.uint8(255)))


def test_points_outside_the_image_lie_on_no_pixel():
    outside = [[-1, 0], [0, -0.5], [3, 0], [0, 2], [np.nan, 0], [np.inf, 0], [1e300, 1]]
    assert len(mask_filter(outside, np.ones((2, 3), bool))) == 0
    assert mask_filter([], np.ones((2, 3), bool).tolist()).shape == (0, 2)


@pytest.mark.parametrize("step", [0, -1, np.nan, np.inf, "ten", (10, 0)])
def test_a_wrong_step(step):
    with pytest.raises(ParameterError, match="step: expected a number above 0"):
        structured_grid((10, 10), step=step)


def test_a_wrong_shape():
    with pytest.raises(ParameterError, match="shape: expected \\(rows, columns\\)"):
        structured_grid((10, 10, 3))
    with pytest.raises(ParameterError, match="shape: expected a whole number"):
        structured_grid((10, 2.5))


def test_a_wrong_mask():
    with pytest.raises(ImageError, match="mask: expected rows and columns"):
        mask_filter([[0, 0]], np.ones((2, 2, 3)))


def test_wrong_points():
    with pytest.raises(ParameterError, match="points: expected shape \\(n, 2\\)"):
        mask_filter([[0, 0, 0]], np.ones((2, 2)))


def test_a_grid_of_too_many_points_is_refused_before_it_is_made():
    with pytest.raises(ParameterError, match="step: expected a grid of at most .* points, found 0.001 for 10000 x 10000 pixels"):
        structured_grid((10_000, 10_000), step=1e-3)
    assert len(structured_grid((10_000, 10_000), step=1e3)) == 100
