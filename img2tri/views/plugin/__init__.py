"""What pyvista finds by its entry points, with no import of img2tri.

accessor          ``.img2tri`` on pyvista's own objects: mesh an image, measure, smooth and plot a mesh
slices            planes normal to x or y, laid down to be meshed and put up again
plot_regions      each region in a colour of its own, with its name
readers_writers   pyvista.read and ``.save`` for .msh, .inp, .bdf and .xdmf
dataset_to_cells  whatever object of pyvista is in hand -> `img2tri.views.objects.solver_cells.Cells`
"""
