"""Found by what lies beside them, edges do not depend on the brightness and contrast of an image, nor on which side is the bright one."""

from __future__ import annotations

import numpy as np
import pytest

from img2tri.shapes.place.iso_crossings import iso_crossings
from img2tri.shapes.trace.crack_edges import find_crack_edges
from img2tri.shapes.trace.dual_edges import lay_out
from img2tri.types import Frame

Y, X = (np.mgrid[:320, :320] + 0.5) / 8
FINE = (np.hypot(X - 20.3, Y - 19.6) < 14.2) & ~((abs(X - 22) < 5) & (abs(Y - 18) < 4))  # a disc, and a hole along the sides of pixels
SOFT = FINE.reshape(40, 8, 40, 8).mean(axis=(1, 3))
MASK = (SOFT > 0.5).astype(int)


def crossings(gray):
    frame = Frame(gray.shape)
    dual_edges = lay_out(find_crack_edges(MASK, upward=True), frame)
    return iso_crossings(gray, None, dual_edges.middle, dual_edges.vector, frame)


@pytest.mark.parametrize(("contrast", "brightness"), [(1, 10), (100, 37), (3, -1000), (-1, 0), (-50, 255), (-2, -7)])
def test_crossings_do_not_depend_on_brightness_and_contrast(contrast, brightness):
    shift, slack = crossings(SOFT)
    assert np.ptp(shift) > 0.3
    assert len(set(slack.tolist())) > 1
    other_shift, other_slack = crossings(contrast * SOFT + brightness)
    np.testing.assert_allclose(other_shift, shift, atol=1e-9)
    assert np.array_equal(other_slack, slack)


@pytest.mark.parametrize("share", [0.1, 0.25, 0.5, 0.75, 0.9])
def test_an_edge_between_two_grays_is_where_their_areas_are(share):
    gray = np.full((7, 40), 80.0)
    gray[:, :19], gray[:, 19] = 200.0, 80 + 120 * share
    frame = Frame(gray.shape)
    dual_edges = lay_out(find_crack_edges(np.where(gray > 140, 1, 0), background=None, upward=True), frame)
    shift, _ = iso_crossings(gray, None, dual_edges.middle, dual_edges.vector, frame)
    found = (dual_edges.middle + shift * dual_edges.vector)[dual_edges.vector != 0].real
    assert len(found) == 7
    # The mixed pixel has so much of the left one's gray as its area says.
    assert found == pytest.approx(19 + share, abs=0.011 if share == 0.5 else 1e-9)  # no crossing lies on a pixel centre
