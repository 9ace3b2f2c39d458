"""Every number with a name in the rooms that make meshes is held by a test, or there is a word why it stays as it is.

Held are those of which a tuning test shows that a mesh gets worse when they are changed. A new constant needs a row there
or here: `test_house` looks whether all have one.
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
import specimens
from tuning import change, constants

import img2tri

TESTS = Path(__file__).parent
TUNING = ("shapes/test_tuning.py", "triangles/generate/test_tuning.py")

HELD = {  # by tests of their own
    "AREA_ROUNDS": "shapes/place/test_constrained_smoothing.py", "ATTEMPTS": "recipes/test_conforming.py",
    "MOST_MATCHES": "shapes/periodic/test_paired_outlines.py", "MOST_ROUNDS": "shapes/simplify/test_tolerance.py",
    "MOST_FIELD_CELLS": "shapes/sizes/test_user_size_field.py", "FIRST_CELLS": "shapes/sizes/test_user_size_field.py",
    "LENGTH_STEP": "shapes/sizes/test_user_size_field.py", "SEARCH": "recipes/test_second_order.py",
    "HALVINGS": "recipes/test_second_order.py",
    "DAMPING": "triangles/tools/test_laplacian_smoothing.py", "UNBOUNDED": "triangles/tools/test_quality_summary.py",
    "NOISE": "shapes/place/test_noisy_edges.py", "NORMAL": "shapes/place/test_noisy_edges.py",
    "SAMPLE": "shapes/place/test_noisy_edges.py", "PURE": "shapes/place/test_noisy_edges.py",
    "TURN_SIDE": "shapes/simplify/test_sharp_turns.py", "SHARP_ANGLE": "shapes/simplify/test_sharp_turns.py",
    "STRAIGHT_SIDE": "shapes/simplify/test_sharp_turns.py", "TURNS_APART": "shapes/simplify/test_sharp_turns.py",
    "MIXED_CROSSINGS": "shapes/simplify/test_sharp_turns.py", "TIP": "shapes/simplify/test_sharp_turns.py",
    "TIP_OFFSET": "shapes/simplify/test_sharp_turns.py",
    "MOST_BLUNT": "shapes/simplify/test_sharp_turns.py",
    "BLOCK_SIDE": "tiles/test_mesh_tiles.py", "PADDING": "shapes/place/test_smoothing_splines.py",
    "CHORD_SHARE": "shapes/simplify/test_vertex_offsets.py", "LEFT_OVER": "test_areas.py",
}  # fmt: skip

REASONS = {
    # What differs by rounding alone is the same; anything between 1e-14 and what can be seen serves.
    "LEAST_WAY SWEPT_ROUNDING "
    "ON_SIDE AT_BOUND NO_STEP SAME_AREA SAME_PLACE ROUNDED JUST_WITHIN ON_AXIS ROUNDING SAME ROW_ROUNDING TANGENT_ROUNDING LEAST_MOVE":
        "rounding",
    # Time or memory; the mesh is the same, up to rounding.
    "BATCH FEW_REGIONS AT_ONCE PLACES_AT_ONCE CHORDS_AT_ONCE NEARBY FIRST_ASKED MOST_SQUARES FEW_PAIRS FEW_BOXES PAUSE "
    "LOOK_AFTER WORKERLESS": "cost",
    # Rounds of what ends by itself before, or ends in an error that says so, or in the best so far.
    "FINER_MATCHES FILLINGS FAIR_ROUNDS BLUNT_ROUNDS RETURNS LEVELS MOST_ATTEMPTS ROUNDS": "stop",
    # They keep a division or a step from becoming too large where there is nothing to divide by.
    "STEEP LEAST_ACROSS LEAST_WIDTH SLANT SOLVABLE FLATTEST NUDGE BY_CHANCE LEAST_PIECE": "guard",
    # Mathematics, or a number of someone else's.
    "RATIO ROW TURN DEFECT GOLDEN_RATIO NODE SUPER TRIANGLE STEPS _ROOT _POSITIVE _UNIT _FROM_ONE": "given",
    # Defaults and limits that users are told; another value is another promise.
    "USUAL_TRIANGLES USUAL_SEGMENTS SHORTEST_SHARE MOST_TRIANGLES CONFETTI AREA_TOLERANCE SMALL_AREA PLACES PRINTED SAME_LENGTH "
    "LEAST_JACOBIAN DEFAULT_SHORTEST DEFAULT_LONGEST MOST_AREA_ERROR FEW_PIXELS SAMPLE_STEP": "said",
    # How blocks are joined: tried in turn, and what comes of it is checked, so that a wrong one ends in a refusal, not in a bad mesh.
    # Chosen on the specimens at every place (tests/tiles/test_every_place.py); not shown one by one.
    "MARGIN_EDGES SMOOTHED LEAST_BLOCK GROSS MARGIN_SCALES NEAR WIDTHS SEGMENT_LENGTHS EATEN REPAIRS PATCHES RINGS LOOSE_CLEARANCE SAMPLES "
    "ALIKE APART AROUND AT_FRAME COMPARED LEAST_RING ODD POSTED REPRESENTED "
    "WALLED STUBS FILLED MET LOST TAKEN CORE REACH BENT CORNER BEHIND SHARP POCKET EVENINGS": "joints",
    "FAIRINGS FAIR": "without them worst angles of blobs and gears rise by a degree in the mean, and blob(512) of the ratchet loses .7",
    "WAY_BACK": "half the diagonal of a pixel, .707: no way back to a middle is longer",
    "TURNINGS PUSHINGS MIDDLINGS MOST_TURN MOST_MIDDLING LEAST_LENGTH LEAST_SINE":
        "three ways to open wedges: LEAST_WEDGE is shown to matter; of the ways any one can be left out, but without pushing nodes of "
        "sectors lie .458 px off (test_node_placement allows .45), without turning those of halved discs .051 (.049)",
    "RIDGE": "chains that lead the same way; since AMID is there too, 0 and .1 move nodes by less than .01 px in the mean",
    "SPLITTINGS SPLITTINGS_NOT_SQUARE": "half of ATTEMPTS, or a quarter: rounds before outlines go back to their middles",
    "COLUMN FARTHEST": "px that are asked across an edge: 3 and half are as good where edges are drawn by area; more finds other edges",
    "NEAR_MIDDLE": "levels farther from the middle are iso-lines; a fifth or half of that changes discs by less than .002 px",
    "MOST": "three quarters, as other edges may be near a quarter of all; 1 is as good where none is",
    "GIVES": "how far the rest of an outline gives area back after a way back: where pixels are not square only",
    "ENDLESS": "where opposite sides divide each other without end, segments are shorter than this; others are longer",
    "ACROSS EDGES_IN_CELL": "of the overview picture: as fine as a screen shows, and no cell without triangles",
    "SMALLEST_NARROW": "rings of fewer points are left as they are; twice as many are as good on discs of 6 px and on tiny maps",
    "WELL_CONDITIONED": "stiffness up to which solving once leaves no error of rounding that can be seen",
    "POOR POOR_RINGS SLIDE_AGAIN SLIDING": "vertices on outlines slide once more only where a mesh has angles below this, and only there",
    "WITHIN": "as SLIDE: points in which segments were divided keep their order, and a third of their distance",
    "TURN_ENOUGH": "half a degree below the least wedge is as good; 0 takes all rounds",
    "SMALL_ENOUGH": "saves a second grid of sizes where the first is nearly as fine as wanted; 1 to 2 serve",
    "SOME_POINTS POINTS_EACH": "a bound of work for an angle beyond what was asked; refinement for that needs fewer",
    "SHORTEST_EDGE SHORTEST_SPLIT": "stops only: sharp corners would be refined for ever; a tenth and the tenfold serve",
}  # fmt: skip

WHY = {name: reason for names, reason in REASONS.items() for name in names.split()}
TUNED = {name for file in TUNING for name in re.findall(r'\("([A-Z_]+)", [\d.]+, "', (TESTS / file).read_text(encoding="utf-8"))}
TILES = {name for name, module in constants().items() if module.startswith("img2tri.tiles.")}
IDLE = sorted(name for name, reason in WHY.items() if reason in ("rounding", "cost", "stop") and name not in TILES)

IMAGES = [
    (specimens.polycrystal(32, 5, 1), {"labels": True, "edge_length": 5}),
    (specimens.polycrystal(24, 4, 3), {"labels": True, "edge_length": 5, "periodic": "xy", "spacing": (1.0, 1.5)}),
    (specimens.ellipse(40, (15.0, 9.0)).astype(np.uint8), {"edge_length": 5, "symmetric": "xy"}),
]


@pytest.mark.parametrize("name", HELD)
def test_the_test_that_holds_a_constant_speaks_of_it(name):
    assert re.search(rf"\b{name}\b", (TESTS / HELD[name]).read_text(encoding="utf-8"))


def made():
    for image, options in IMAGES:
        mesh = img2tri.mesh_image(image, **options)
        yield mesh.vertices, mesh.triangles, np.array([mesh.report.smallest_angle, mesh.report.hausdorff])


@pytest.fixture(scope="module")
def before():
    return list(made())


@pytest.mark.parametrize("factor", [0.5, 2])
@pytest.mark.parametrize("name", IDLE)
def test_what_is_said_not_to_matter_does_not(name, factor, before, monkeypatch):
    change(monkeypatch, name, factor)
    for (vertices, triangles, told), old in zip(made(), before, strict=True):
        assert np.array_equal(triangles, old[1])
        assert np.abs(vertices - old[0]).max() < 1e-9
        assert told == pytest.approx(old[2], abs=1e-9)
