"""THE PAPER: every function of its listing, in the order of the paper, and its two recipes.

active_cells     Where in a region there may be room for points: squares of one size, split in four and sifted, again and again.
boundary_points  Points spread evenly along a closed outline: a ring in, n points at equal arc length out.
contours         Contours of the white zone: a mask in, one closed ring of pixel centres for each component out.
delaunay         The paper's triangles: points in, the Delaunay triangles whose centroid is inside the shape out.
grid             Structured grid: an image in, evenly spaced candidate points out; those on white pixels stay.
poisson_disk     Poisson-disk points inside a region: the region and its boundary points in, points at least a distance apart out.
recipes          The paper's two recipes, from the stages in shapes/ and triangles/: a mask in, triangles out.
"""
