"""Work on any triangle mesh, whoever made it: how it hangs together, how good it is, smoothing.

mesh_checks          Arrays said to be a mesh -> arrays safe to index with, or an error that says what is wrong.
topology             Edges, boundary, interfaces, neighbours.
triangle_metrics     The measures of one triangle: q, smallest angle, radius ratio and Verdict's others.
pixel_means          The mean of an image over each triangle, exact.
quality_summary      All triangles measured; their summary and histogram.
inversion_guard      Moves taken back where they would turn a triangle over or lower the worst angle.
laplacian_smoothing  Smoothing with uniform weights, the paper's.
cotangent_smoothing  Smoothing with cotangent weights, which keeps a graded mesh; with a free boundary it rounds off pixel steps.
cotangent_laplacian  The matrix itself; moving the boundary with the inside following; smoothing fields on a mesh.
curve_fairing        Implicit fairing of boundary and interfaces: rounds off pixel steps.
"""
