"""The formats of solvers, one module each: `img2tri.views.objects.cells.Cells` -> the bytes of a file.

    msh       Gmsh, and what reads its files
    inp       Abaqus and CalculiX
    bdf       Nastran
    xdmf      FEniCSx
    vtk       VTU and VTKHDF, for ParaView and pyvista
    text      what those in plain text have in common

They are written here because the library that knows most of them, meshio, has no surfaces, no names in Nastran, no edges beside triangles
in MSH 4.1, and writes triangles for Abaqus as rigid ones with more digits than Abaqus reads. Every format is read back in the tests by a
program that has nothing to do with this one.
"""
