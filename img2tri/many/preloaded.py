"""What processes need to make meshes, loaded once: they are forked from one that has imported this module and nothing else.

A small disc is meshed, with edges of different lengths, and judged, since libraries are loaded where they are first used.
"""

from __future__ import annotations

import numpy as np

from img2tri.pipeline import mesh_image

mesh_image(np.hypot(*np.mgrid[-8:8, -8:8] + 0.5) < 6, edge_length=lambda places: 2 + places[:, 0] / 8).report  # noqa: B018
