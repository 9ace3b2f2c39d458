"""TRIANGLES: points and segments -> triangles; and work on triangles.

generate         Outlines -> triangles: the mesh is made here.
tools            Any mesh: topology, quality, smoothing. Neither folder imports the other.
angles           The smallest angle of each triangle, which both look at.
connected_faces  Which triangles hang together.
"""
