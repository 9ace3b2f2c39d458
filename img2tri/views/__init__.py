"""For others: a mesh as the objects, files and figures other programs read.

    objects/    the mesh with a thickness, as bodies, with named parts; as trimesh, pyvista and scikit-fem have it
    formats/    files: for printing and looking at, for drawing, and, in formats/solvers/, for computing
    figures/    pictures: plots, notebooks
    page/       one HTML page with mesh, image and certificate, to turn and to zoom
    plugin/     what pyvista finds by itself: ``.img2tri`` on its objects, readers and writers for its ``read`` and ``save``

Each format has one writer. Here, as in the libraries and formats this room serves, a triangle in space is a face or cell.
"""
