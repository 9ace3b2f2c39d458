"""Specks go where they belong, nothing else changes, and what hangs together is what the outlines join."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays
from oracles import pixel_topology
from specimens import drawn, polycrystal, rings, spiral

from img2tri.errors import ParameterError
from img2tri.raster.labels.connected_components import connected, find_components
from img2tri.raster.labels.rgb_to_labels import LabelMap
from img2tri.raster.labels.specks_and_holes import LISTED, clean

MAPS = arrays.arrays(np.int64, st.tuples(st.integers(1, 7), st.integers(1, 7)), elements=st.integers(0, 3))
MASKS = arrays.arrays(bool, st.tuples(st.integers(1, 9), st.integers(1, 9)))
BACKGROUNDS = st.sampled_from([0, 2, None, -5])
CONNECTIVITY = st.sampled_from([4, 8])


def cleaned(values, background=0, **options):
    return clean(LabelMap(np.asarray(values), background), **options)[0].values


def slow_components(labels, background, connectivity):
    """Flood, pixel by pixel; which diagonals are open is looked up block by block."""
    h, w = labels.shape

    def rank(value):
        return (value != background, value)

    def neighbours(r, c):
        for dr, dc in ((0, 1), (1, 0), (0, -1), (-1, 0)):
            if 0 <= r + dr < h and 0 <= c + dc < w:
                yield r + dr, c + dc
        for dr in (-1, 1):
            for dc in (-1, 1):
                if 0 <= r + dr < h and 0 <= c + dc < w:
                    one, other = labels[r, c + dc], labels[r + dr, c]
                    checkerboard = one == other != labels[r, c]
                    order = (rank(labels[r, c]) < rank(one)) == (connectivity == 4)
                    if not checkerboard or order:
                        yield r + dr, c + dc

    found = np.full(labels.shape, -1)
    count = 0
    for start in np.ndindex(labels.shape):
        if found[start] < 0:
            waiting, found[start] = [start], count
            while waiting:
                here = waiting.pop()
                for there in neighbours(*here):
                    if found[there] < 0 and labels[there] == labels[here]:
                        found[there] = count
                        waiting.append(there)
            count += 1
    return found


def sides(labels):
    """Sides between pixels of different labels."""
    return labels[:, 1:] != labels[:, :-1], labels[1:] != labels[:-1]


@settings(max_examples=300, deadline=None, derandomize=True)
@given(MAPS, BACKGROUNDS, CONNECTIVITY)
def test_components_are_those_of_a_flood(labels, background, connectivity):
    parts = find_components(labels, background=background, connectivity=connectivity)
    found = np.repeat(parts.component, parts.length).reshape(labels.shape)
    expected = slow_components(labels, background, connectivity)
    assert (found == expected).all()  # numbered by their first pixels, too
    assert (parts.area == np.bincount(expected.ravel())).all()
    assert (parts.values[parts.number[found]] == labels).all()
    assert ((parts.number == 0) == [labels.flat[s] == background for s in np.unique(expected, return_index=True)[1]]).all()
    shared = {}
    for axis in (0, 1):
        one, other = np.delete(expected, -1, axis).ravel(), np.delete(expected, 0, axis).ravel()
        for pair in zip(np.minimum(one, other).tolist(), np.maximum(one, other).tolist(), strict=True):
            shared[pair] = shared.get(pair, 0) + (pair[0] != pair[1])
    told = {}
    for pair, n in zip(np.sort(parts.touching, axis=1).tolist(), parts.sides.tolist(), strict=True):
        told[tuple(pair)] = told.get(tuple(pair), 0) + n
    assert told == {pair: n for pair, n in shared.items() if n}


@pytest.mark.parametrize("connectivity", [4, 8])
@pytest.mark.parametrize("mask", [spiral() > 0, rings() > 0, np.indices((6, 7)).sum(axis=0) % 2 > 0], ids=["spiral", "rings", "board"])
def test_components_of_a_mask_are_those_of_its_topology(mask, connectivity):
    mask = np.pad(mask, 1)
    parts = find_components(mask, connectivity=connectivity)
    components, holes = pixel_topology(mask, connectivity)
    assert ((parts.number > 0).sum(), (parts.number == 0).sum()) == (components, holes + 1)


def test_groups_are_numbered_by_their_first_member():
    assert connected(6, np.array([[5, 0], [4, 1]])).tolist() == [0, 1, 2, 3, 1, 0]
    assert connected(3, np.zeros((0, 2), int)).tolist() == [0, 1, 2]


@settings(max_examples=300, deadline=None, derandomize=True)
@given(st.one_of(MAPS, MASKS), BACKGROUNDS, CONNECTIVITY, st.integers(0, 20))
def test_nothing_below_the_limit_is_left_and_no_side_is_added(labels, background, connectivity, limit):
    before = labels.copy()
    given_map = LabelMap(labels, background)
    found, removed = clean(given_map, min_area=limit, connectivity=connectivity)
    assert (labels == before).all()
    after = np.bincount(slow_components(found.values, background, connectivity).ravel())
    assert len(after) == 1 or after.min() >= limit
    assert (found.values.dtype, found.background) == (labels.dtype, background)
    for one, other in zip(sides(found.values), sides(labels), strict=True):
        assert not (one & ~other).any()
    # Cleaning what is clean gives it back.
    assert (found is given_map) == (removed["pixels"] == 0) == (not removed["listed"])
    assert clean(found, min_area=limit, connectivity=connectivity)[0] is found


@settings(max_examples=200, deadline=None, derandomize=True)
@given(MASKS, CONNECTIVITY, st.integers(2, 12), st.booleans())
def test_components_of_a_mask_that_are_large_enough_stay(mask, connectivity, limit, inverse):
    background = int(inverse)
    own = slow_components(mask, background, connectivity)
    large = np.bincount(own.ravel())[own] >= limit
    found, removed = clean(LabelMap(mask, background), min_area=limit, connectivity=connectivity)
    assert (found.values == mask)[large].all() or not large.any()
    changed = found.values != mask
    assert removed["pixels"] == changed.sum()
    assert removed["specks"] + removed["holes"] == len(np.unique(own[changed])) == len(removed["listed"])
    for row in removed["listed"]:
        first = row["row"], row["column"]
        assert (own == own[first]).sum() == row["area"]
        assert np.argwhere(own == own[first])[0].tolist() == list(first)
        assert (mask[first], found.values[first]) == (row["label"], row["became"])


@settings(max_examples=100, deadline=None, derandomize=True)
@given(MAPS, BACKGROUNDS, CONNECTIVITY, st.integers(2, 9), st.booleans())
def test_only_areas_count_not_the_size_of_pixels_nor_the_names_of_labels(labels, background, connectivity, limit, largest):
    found = cleaned(labels, background, min_area=limit, largest=largest, connectivity=connectivity)
    fine = cleaned(np.kron(labels, np.ones((2, 2), int)), background, min_area=4 * limit, largest=largest, connectivity=connectivity)
    assert (fine == np.kron(found, np.ones((2, 2), int))).all()
    other = None if background is None else 10 * background - 7
    renamed = cleaned(10 * labels - 7, other, min_area=limit, largest=largest, connectivity=connectivity)
    assert (renamed == 10 * found - 7).all()


@settings(max_examples=200, deadline=None, derandomize=True)
@given(MAPS, BACKGROUNDS, CONNECTIVITY)
def test_of_each_region_the_largest_component_is_left(labels, background, connectivity):
    found, _ = clean(LabelMap(labels, background), largest=True, connectivity=connectivity)
    own, new = (slow_components(values, background, connectivity) for values in (labels, found.values))
    for label in np.unique(found.values[found.values != background]):
        assert len(np.unique(new[found.values == label])) == 1
    if background is not None:
        assert (found.values[labels == background] == background).all()
        for label in np.unique(labels[labels != background]):
            most = np.bincount(own[labels == label]).max()
            assert (found.values == label).sum() <= most
    assert clean(found, largest=True, connectivity=connectivity)[0] is found


def test_a_tie_for_the_largest_goes_to_the_first():
    assert cleaned([[1, 1, 0, 1, 1, 0, 2]], largest=True).tolist() == [[1, 1, 0, 0, 0, 0, 2]]


def test_largest_without_a_background_gives_the_rest_to_neighbours():
    labels = np.array([[1, 1, 1, 2, 2, 2], [1, 3, 1, 2, 1, 2], [1, 1, 3, 3, 3, 2]])
    assert cleaned(labels, None, largest=True).tolist() == [[1, 1, 1, 2, 2, 2], [1, 1, 1, 2, 2, 2], [1, 1, 3, 3, 3, 2]]
    # With a background they are nothing.
    assert cleaned(labels, 0, largest=True).tolist() == [[1, 1, 1, 2, 2, 2], [1, 0, 1, 2, 0, 2], [1, 1, 3, 3, 3, 2]]


def test_largest_does_not_fill_holes_and_min_area_does():
    ring = drawn("......", ".1111.", ".1.11.", ".1111.", "......") > 0
    assert clean(LabelMap(ring, 0), largest=True)[0].values is ring
    filled, removed = clean(LabelMap(ring, 0), min_area=2)
    assert pixel_topology(filled.values) == (1, 0)
    assert (removed["specks"], removed["holes"], removed["pixels"]) == (0, 1, 1)
    assert removed["listed"] == [{"label": 0, "area": 1, "row": 2, "column": 2, "became": 1}]


def test_specks_go_to_the_longest_interface():
    labels = np.array([[1, 1, 1, 2, 2], [1, 1, 5, 2, 2], [1, 1, 1, 2, 2]])
    assert cleaned(labels, min_area=2).tolist() == [[1, 1, 1, 2, 2], [1, 1, 1, 2, 2], [1, 1, 1, 2, 2]]
    assert cleaned(labels[:, ::-1], min_area=2).tolist() == [[2, 2, 1, 1, 1]] * 3
    # Equal interfaces: the lowest label; the background is the lowest of all.
    assert cleaned([[1, 1, 5, 2, 2]], min_area=2).tolist() == [[1, 1, 1, 2, 2]]
    assert cleaned([[1, 1, 5, 2, 2]], 2, min_area=2).tolist() == [[1, 1, 2, 2, 2]]
    # Pieces of one label count together.
    labels = np.array([[3, 3, 3, 3, 3], [9, 9, 5, 9, 9], [4, 4, 4, 4, 4]])
    assert cleaned(labels, min_area=2)[1].tolist() == [9] * 5


def test_neighbours_that_stay_go_first():
    # The 6 shares three sides with the 5, itself too small, and one with the 1.
    labels = np.array([[1, 1, 1, 1, 1], [1, 5, 6, 5, 1], [1, 1, 5, 1, 1], [1, 1, 1, 1, 1]])
    assert (cleaned(labels, min_area=5) == 1).all()


def test_clusters_of_specks_grow_to_a_region():
    labels = np.kron([[1, 2, 3, 2]], np.ones((2, 1), int))
    found, removed = clean(LabelMap(labels, None), min_area=4)
    assert np.unique(found.values).size <= 2
    assert removed["specks"] >= 2


def test_the_smallest_goes_first():
    # A hole of one pixel filled, the ring around it has 9 and stays.
    ring = np.pad(drawn("111", "1.1", "111"), 3) > 0
    assert cleaned(ring, min_area=9).sum() == 9
    assert cleaned(ring, min_area=10).sum() == 0
    # An island in a hole goes first, and the hole of 9 then stays or goes with it.
    target = np.pad(drawn("11111", "1...1", "1.1.1", "1...1", "11111"), 3) > 0
    assert cleaned(target, min_area=9).sum() == 16
    assert cleaned(target, min_area=10).sum() == 25


def test_connectivity_says_what_a_speck_is():
    chain = np.pad(np.eye(5, dtype=bool), 2)
    assert not cleaned(chain, min_area=2).any()
    assert cleaned(chain, min_area=2, connectivity=8) is chain
    # Holes that touch in a corner are one for 4, two for 8.
    assert (cleaned(~chain, min_area=2) == ~chain).all()
    assert cleaned(~chain, min_area=2, connectivity=8).all()


def test_what_a_removal_parts_is_looked_at_again():
    # The 3 goes to the 1; the 2 in the first row then no longer hangs together with those below.
    labels = np.array([[1, 2, 1, 1], [1, 3, 2, 2], [1, 1, 2, 2], [1, 1, 2, 2]])
    found, removed = clean(LabelMap(labels, 0), min_area=2)
    assert found.values.tolist() == [[1, 1, 1, 1], [1, 1, 2, 2], [1, 1, 2, 2], [1, 1, 2, 2]]
    assert removed["specks"] == 2


def test_an_image_of_one_label_stays():
    ones = np.ones((3, 4), int)
    for options in ({"min_area": 100}, {"largest": True}, {"min_area": 100, "largest": True}):
        assert cleaned(ones, None, **options) is ones
        assert cleaned(ones, 1, **options) is ones


def test_specks_at_the_frame_go_too():
    assert cleaned([[0, 1, 1, 1], [1, 1, 1, 1]], min_area=2).all()


@pytest.mark.parametrize("options", [{}, {"min_area": None}, {"min_area": 0}, {"min_area": 1}, {"largest": False}])
def test_without_a_limit_nothing_changes(options):
    labels = LabelMap(np.array([[1, 0, 1, 2]]), 0)
    found, removed = clean(labels, **options)
    assert found is labels
    assert removed == {"specks": 0, "holes": 0, "pixels": 0, "listed": []}


def test_areas_of_a_world_are_rounded():
    bar = np.pad(np.ones((2, 2), bool), 3)
    for size in (0.1, 0.3, 0.7, 1 / 3):
        assert cleaned(bar, min_area=(4 * size * size) / (size * size)).any()
    assert not cleaned(bar, min_area=4.001).any()


@pytest.mark.parametrize("dtype", [bool, np.uint8, np.int16, np.uint32, np.uint64, np.int64])
def test_the_type_is_kept_and_views_are_read(dtype):
    big = np.zeros((12, 14), dtype)
    big[2:8, 2:8] = 1
    big[4, 4] = 0
    view = big[::2, ::-2]
    found = cleaned(view, min_area=2)
    assert found.dtype == dtype
    assert (found == (np.abs(np.indices(view.shape) - [[[2]], [[4]]]).max(axis=0) <= 1)).all()


@pytest.mark.parametrize("dtype", [bool, np.uint8, np.uint64])
def test_a_background_that_does_not_fit_the_type_widens_it(dtype):
    labels = np.array([[1, 1, 0, 1]], dtype)
    assert cleaned(labels, -7, largest=True).tolist() == [[1, 1, 0, -7]]
    assert cleaned(labels, -7, largest=True).dtype == np.int64


def test_large_labels_stay_exact():
    far = 2**63 - 1
    labels = np.array([[far, far, far - 1, far, far]], np.uint64)
    assert cleaned(labels, min_area=2).tolist() == [[far] * 5]


def test_the_largest_are_listed_and_all_are_counted():
    mask = np.zeros((60, 60), bool)
    mask[::3, ::3] = True
    mask[30, 30:32] = True
    _, removed = clean(LabelMap(mask, 0), min_area=5)
    assert (removed["specks"], removed["pixels"], len(removed["listed"])) == (400, 401, LISTED)
    assert removed["listed"][0] == {"label": 1, "area": 2, "row": 30, "column": 30, "became": 0}


def test_grains_are_given_back():
    grains = polycrystal(64, 12) + 1
    rng = np.random.default_rng(3)
    dirty = grains.copy()
    inside = np.argwhere((grains == np.roll(grains, 3, 0)) & (grains == np.roll(grains, -3, 0)))[::40]
    dirty[tuple(inside.T)] = rng.integers(20, 30, len(inside))
    assert (cleaned(dirty, None, min_area=4) == grains).mean() > 0.995
    assert (cleaned(dirty, 0, min_area=4) == cleaned(dirty, None, min_area=4)).all()


def test_a_row_of_equals_is_done_in_few_rounds():
    # Each pixel a region of its own: with an order among equals one pixel at a time would have its turn.
    labels = np.arange(300 * 300).reshape(300, 300)
    found, _ = clean(LabelMap(labels, None), min_area=9)
    assert find_components(found.values, background=None).area.min() >= 9


@pytest.mark.parametrize("value", [-1, np.nan, np.inf, "9px2", True, [9]])
def test_bad_min_area(value):
    with pytest.raises(ParameterError, match="^min_area: expected a number of at least 0, found"):
        cleaned([[0, 1]], min_area=value)


@pytest.mark.parametrize("value", [6, "4", None])
def test_bad_connectivity(value):
    with pytest.raises(ParameterError, match="^connectivity: expected 4 or 8, found"):
        cleaned([[0, 1]], connectivity=value)
