"""TRIANGLES: points and segments -> triangles; and work on triangles.

generate            Outlines -> triangles: the mesh is made here.
tools               Any mesh: topology, quality, smoothing. Neither folder imports the other. Angles in degrees: tools/triangle_metrics.
min_angle_tangents  The smallest angle of each triangle by its tangent: cheap, for loops that only compare angles.
connected_faces     Which triangles hang together.
"""
