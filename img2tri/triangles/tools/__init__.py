"""Work on any triangle mesh: how it hangs together, how good it is, smoothing.

fairing          Rounding off the pixel steps that remain in the boundary and the interfaces of a mesh.
harmonic         What the cotangent Laplacian is good for in the plane: carrying the inside along when the boundary moves, and smoot
inversion_guard  The guard of all moves: no triangle may turn over, and the worst angle may not fall.
mesh_checks      Checks made on arrays that are said to be a mesh, before any of them reaches libigl.
metrics          The usual measures of how good a triangle is.
quality          How good the triangles of a mesh are, in numbers: every one measured, their summary and their histogram.
smoothing        Smoothing, by uniform or by cotangent weights.
topology         How the triangles of a mesh hang together: its edges, its boundary, its interfaces, who is whose neighbour.
"""
