"""The values the paper chooses, where an option of `img2tri.mesh_image` is left out."""

from __future__ import annotations

PAPER_THRESHOLD = 240  # gray values above it are meshed (III-A)
GRID_STEP = 10  # px between the points of the structured grid (III-B)
PAPER_SMOOTHING = {"structured": "none", "unstructured": "uniform"}  # by recipe (III-E)
