"""CrackEdges against brute force: which there are, what lies beside them, what follows them."""

from __future__ import annotations

import numpy as np
import pytest
import specimens
import strategies
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from strategies import QUICK

from img2tri.arrays import label_changes
from img2tri.shapes.trace.crack_edges import NODE, find_crack_edges

OUTSIDE = -1
NOTHING = frozenset({0, OUTSIDE})
RANDOM = {"random": np.random.default_rng(2).integers(0, 4, (9, 11)), "random mask": np.random.default_rng(3).integers(0, 2, (12, 9))}
# Of large images a part is enough, as brute force takes its time.
LABELS = {name: labels[:24, :24] for name, labels in (specimens.ALL | RANDOM).items()}


def numbers(labels, background=0):
    """Region numbers (h + 2, w + 2), what is outside around them."""
    values = [v for v in np.unique(labels).tolist() if v != background]
    result = np.zeros(labels.shape, int)
    for i, v in enumerate(values, start=1):
        result[labels == v] = i
    return np.pad(result, 1, constant_values=OUTSIDE)


def walls(p):
    """All sides that are crack_edges: their two corners -> the numbers beside."""
    h, w = p.shape[0] - 2, p.shape[1] - 2
    found = {}
    for r in range(h + 1):
        for c in range(w + 1):
            corner = r * (w + 1) + c
            for other, beside in ((corner + 1, (p[r, c + 1], p[r + 1, c + 1])), (corner + w + 1, (p[r + 1, c], p[r + 1, c + 1]))):
                in_image = c < w if other == corner + 1 else r < h
                if in_image and beside[0] != beside[1] and set(map(int, beside)) != NOTHING:
                    found[frozenset((corner, other))] = {int(max(b, 0)) for b in beside}
    return found


def pairs(p, connectivity):
    """Sides that follow each other, as the rule has it: sets of two sides, each the set of its two corners."""
    h, w = p.shape[0] - 2, p.shape[1] - 2
    there, result = walls(p), set()
    for r in range(h + 1):
        for c in range(w + 1):
            a, b, lower, d = (int(v) for v in p[r : r + 2, c : c + 2].ravel())
            corner = r * (w + 1) + c
            up, left, right, down = (frozenset((corner, corner + step)) for step in (-w - 1, -1, 1, w + 1))
            here = [side for side in (up, left, right, down) if side in there]
            at_the_corner_of_the_image = r in (0, h) and c in (0, w)
            if len(here) == 2 and not at_the_corner_of_the_image:
                along = OUTSIDE in (a, b, lower, d)
                frame = {up: c in (0, w), down: c in (0, w), left: r in (0, h), right: r in (0, h)}
                if not along or all(frame[side] for side in here):
                    result.add(frozenset(here))
            if len(here) == 4 and (a == d or b == lower):
                join_falling = a == d and (b != lower or a == (min(a, b) if connectivity == 4 else max(a, b)))
                around = ((up, right), (left, down)) if join_falling else ((up, left), (right, down))
                result |= {frozenset(pair) for pair in around}
    return result


def sides(crack_edges):
    """Each crack as the set of its two corners."""
    return [frozenset(ends) for ends in zip(crack_edges.tail.tolist(), crack_edges.head.tolist(), strict=True)]


def check(labels, background=0, upward=True, connectivity=4):
    p = numbers(labels, background)
    crack_edges = find_crack_edges(labels, background=background, upward=upward, connectivity=connectivity)
    h, w = labels.shape
    n = len(crack_edges.tail)

    # Which there are: as many as unequal neighbours, and sides of pixels on the frame.
    inside = p[1:-1, 1:-1]
    rim = np.concatenate([inside[0], inside[-1], inside[:, 0], inside[:, -1]])
    assert n == (inside[1:] != inside[:-1]).sum() + (inside[:, 1:] != inside[:, :-1]).sum() + (rim > 0).sum()
    expected, found = walls(p), sides(crack_edges)
    assert len(set(found)) == n
    assert set(found) == set(expected)

    # What lies beside: half a pixel to the left and to the right of the middle.
    (r0, c0), (r1, c1) = np.divmod(crack_edges.tail, w + 1), np.divmod(crack_edges.head, w + 1)
    sign = 1 if upward else -1
    r, c, to_left = (r0 + r1) / 2 + 0.5, (c0 + c1) / 2 + 0.5, np.array([c0 - c1, r1 - r0]) * sign / 2
    left, right = (p[np.round(r + s * to_left[0]).astype(int), np.round(c + s * to_left[1]).astype(int)] for s in (1, -1))
    assert np.array_equal(crack_edges.left, np.maximum(left, 0))
    assert np.array_equal(crack_edges.right, np.maximum(right, 0))
    assert (crack_edges.left < crack_edges.right).all()
    assert np.array_equal(crack_edges.on_frame, (left == OUTSIDE) | (right == OUTSIDE))

    # What follows: each at most once, with the same regions beside, and just where the rule says so.
    follows = np.flatnonzero(crack_edges.successor != NODE)
    after = crack_edges.successor[follows]
    assert len(np.unique(after)) == len(after)
    assert np.array_equal(crack_edges.head[follows], crack_edges.tail[after])
    for beside in (crack_edges.left, crack_edges.right, crack_edges.on_frame):
        assert np.array_equal(beside[follows], beside[after])
    assert {frozenset((found[i], found[j])) for i, j in zip(follows.tolist(), after.tolist(), strict=True)} == pairs(p, connectivity)

    assert crack_edges.shape == (h, w)
    assert crack_edges.labels.dtype == np.int64
    assert crack_edges.labels[1:].tolist() == [v for v in np.unique(labels).tolist() if v != background]


@pytest.mark.parametrize("connectivity", [4, 8])
@pytest.mark.parametrize("name", LABELS)
def test_crack_edges_are_those_of_brute_force(name, connectivity):
    for labels in specimens.turned(LABELS[name]):
        check(labels, connectivity=connectivity)


@pytest.mark.parametrize("upward", [True, False])
@pytest.mark.parametrize("name", LABELS)
def test_with_and_without_background_seen_from_both_sides(name, upward):
    labels = LABELS[name]
    for background in (None, 12345, *np.unique(labels)[:3].tolist()):
        check(labels, background=background, upward=upward)
        check(labels, background=background, upward=upward, connectivity=8)


@QUICK
@given(strategies.maps_and_backgrounds(), st.booleans(), st.sampled_from([4, 8]))
def test_any_label_map(case, upward, connectivity):
    check(*case, upward=upward, connectivity=connectivity)


@pytest.mark.parametrize("dtype", [bool, np.uint8, np.int8, np.uint16, np.int16, np.uint32, np.int32, np.uint64, np.int64])
def test_the_crack_edges_do_not_depend_on_the_type_of_the_labels(dtype):
    rng = np.random.default_rng(1)
    for shape in ((1, 1), (1, 9), (7, 1), (5, 13), (8, 8), (16, 24)):
        labels = rng.integers(0, 2 if dtype is bool else 4, shape)
        one, other = find_crack_edges(labels), find_crack_edges(labels.astype(dtype))
        for name in ("tail", "head", "left", "right", "successor", "on_frame", "labels"):
            assert np.array_equal(getattr(one, name), getattr(other, name))
        check(labels.astype(dtype))


def test_labels_may_be_negative_huge_and_far_apart():
    values = np.array([-(2**63), -(2**40), -1, 5, 2**31, 2**63 - 1])
    labels = values[np.random.default_rng(0).integers(0, 6, (6, 7))]
    for background in (None, 0, *values.tolist()):
        check(labels, background=background)
    assert find_crack_edges(labels, background=None).labels[1:].tolist() == values.tolist()


def test_a_view_in_any_order_of_memory_is_the_same_image():
    labels = np.random.default_rng(4).integers(0, 3, (10, 14))
    for view in (np.asfortranarray(labels), labels.repeat(2, 0).repeat(2, 1)[::2, ::2], labels[::-1][::-1]):
        one, other = find_crack_edges(labels), find_crack_edges(view)
        assert np.array_equal(one.tail, other.tail)
        assert np.array_equal(one.successor, other.successor)


def test_the_image_is_not_changed():
    labels = np.random.default_rng(4).integers(0, 3, (10, 14)).astype(np.uint8)
    kept = labels.copy()
    labels.flags.writeable = False
    find_crack_edges(labels)
    assert np.array_equal(labels, kept)


@pytest.mark.parametrize("labels", [np.zeros((4, 5), int), np.full((1, 1), 7)])
def test_where_nothing_is_meshed_there_is_no_crack(labels):
    crack_edges = find_crack_edges(labels, background=int(labels[0, 0]))
    assert len(crack_edges.tail) == len(crack_edges.successor) == 0
    assert crack_edges.labels.tolist() == [0]


# ---- checkerboards, each worked out by hand: which corners of the middle block the outline cuts off ----


def chord_arc_areas(rows, connectivity=4, background=0):
    """Pixels of the middle block that outlines pass around, as places a b c d; "" where they meet in a node."""
    labels = specimens.drawn(*rows)
    h, w = labels.shape
    middle = (h // 2) * (w + 1) + w // 2
    crack_edges = find_crack_edges(labels, background=background, connectivity=connectivity)
    at = np.flatnonzero((crack_edges.head == middle) & (crack_edges.successor != NODE))
    ends = {tuple(sorted((crack_edges.tail[i] - middle, crack_edges.head[crack_edges.successor[i]] - middle))) for i in at}
    around = {(-w - 1, -1): "a", (-w - 1, 1): "b", (-1, w + 1): "c", (1, w + 1): "d"}
    return "".join(sorted(around[pair] for pair in ends))


@pytest.mark.parametrize(
    ("rows", "by_sides", "by_corners"),
    [
        (("1.", ".1"), "ad", "bc"),  # of a mask: 4 parts the foreground, 8 joins it
        ((".1", "1."), "bc", "ad"),
        (("12", "21"), "bc", "ad"),  # of two labels 4 joins the lower, 8 the higher
        (("21", "12"), "ad", "bc"),
        (("12", "31"), "bc", "bc"),  # of three labels the two that are equal are joined
        (("1.", "21"), "bc", "bc"),
        ((".1", "2."), "bc", "bc"),
        (("31", "12"), "ad", "ad"),
        (("12", "34"), "", ""),  # four labels meet in a node
        (("12", ".3"), "", ""),
    ],
)
def test_checkerboards(rows, by_sides, by_corners):
    for padding in (0, 1, 2):
        padded = np.pad(specimens.drawn(*rows), padding)
        drawn = ["".join(map(str, row)) for row in padded.tolist()]
        assert chord_arc_areas(drawn) == by_sides
        assert chord_arc_areas(drawn, connectivity=8) == by_corners


def test_without_background_the_label_0_is_a_label_like_others():
    assert chord_arc_areas(["1.", ".1"], background=None) == "ad"
    assert chord_arc_areas(["1.", ".1"], background=1) == "bc"  # the 1 is what is not meshed, so the lowest


# ---- changes ----


@st.composite
def flat_values(draw):
    dtype = draw(st.sampled_from([np.bool_, np.uint8, np.int8, np.uint16, np.int16, np.uint32, np.int32, np.uint64, np.int64]))
    elements = st.booleans() if dtype is np.bool_ else st.integers(0, 2)
    return draw(hnp.arrays(dtype, st.integers(0, 70), elements=elements))


@QUICK
@given(flat_values(), st.integers(1, 40))
def test_changes_are_found_at_any_length_shift_and_type(values, shift):
    expected = np.flatnonzero(values[shift:] != values[:-shift]) if len(values) > shift else []
    assert np.array_equal(label_changes(values, shift), expected)


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16, np.uint32, np.uint64])
@pytest.mark.parametrize("length", range(1, 40))
def test_a_single_change_is_found_wherever_it_is(dtype, length):
    for at in range(length):
        values = np.full(length, 7, dtype)
        values[at] = np.iinfo(dtype).max
        assert label_changes(values, 1).tolist() == [i for i in (at - 1, at) if 0 <= i < length - 1]
        assert label_changes(values, 5).tolist() == [i for i in (at - 5, at) if 0 <= i < length - 5]
