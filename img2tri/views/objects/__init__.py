"""A mesh as objects of other libraries, and the geometry they share.

bodies      Several regions as several closed bodies: a plane mesh and a height -> one solid per region, for printing in several mat
cells       What every format for solvers starts from: a mesh in space made of cells of one kind, with its named parts.
edges       The edges of a triangle mesh: triangles -> each edge once, which edges each triangle has, and which of them can be seen
extrusion   A plane mesh with a thickness: triangles -> the closed surface of the solid between two heights.
named_sets  The named parts of a mesh: triangles with their regions, and the frame of the image -> what each edge is called.
surface     What every view starts from: a plane mesh -> triangles in space, with a value of each kind for each of them.
to_pyvista  For pyvista users: a plane mesh -> `pyvista.PolyData` or `UnstructuredGrid`, and the bytes of VTP and VTU files.
to_skfem    For scikit-fem users: a plane mesh -> `skfem.MeshTri` with its parts by name.
to_trimesh  For trimesh users: a plane mesh -> a `trimesh.Trimesh`, flat or closed, and the bytes of a GLB file.
wedges      Solids for solvers: a plane mesh -> wedges, in layers, linear or quadratic; or the flat mesh with quadratic triangles.
"""
