"""The formats of solvers: `img2tri.views.objects.solver_cells.Cells` -> the bytes of a file.

    save_for_solvers  save: the table of formats by suffix, with the options of each
    msh               writes MSH, of Gmsh and what reads its files: nodes, elements, physical groups
    inp               writes INP, of Abaqus and CalculiX: ELSET, NSET, SURFACE; an analysis that runs
    bdf               writes BDF, of Nastran: GRID, CTRIA3, CPENTA, SET1
    xdmf              writes XDMF, of FEniCSx
    medit             writes MESH, of Medit and FreeFem
    vtu_vtkhdf        writes VTU and VTKHDF, with named parts, for ParaView and pyvista
    plain_text        what those in plain text have in common: numbers in columns, comments, names that a format allows

They are written here because the library that knows most of them, meshio, has no surfaces, no names in Nastran, no edges beside triangles
in MSH 4.1, and writes triangles for Abaqus as rigid ones with more digits than Abaqus reads. Every format is read back in the tests by a
program that has nothing to do with this one.
"""
