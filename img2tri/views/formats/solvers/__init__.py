"""The formats of solvers: cells with named parts -> the bytes of a file, and back.

bdf           BDF, the bulk data of Nastran: GRID, CTRIA3 / CTRIA6 or CPENTA, a property for each region, a SET1 of nodes for each s
inp           INP, the format of Abaqus and CalculiX: nodes, elements, and NSET, ELSET and SURFACE for every name.
msh           MSH, the format of Gmsh, version 4.1 or 2.2, in text: regions and sets of facets are physical groups with their names.
read_inp      INP read back: the bytes of a file of Abaqus or CalculiX -> cells of one kind, with regions, names, and the facets of
read_msh_bdf  MSH and BDF read back: the bytes of a file -> cells of one kind, with regions, names, and the facets of each set.
solver_files  A mesh as a file for solvers: the suffix names the format, and one table names who writes it and with which options.
text          What the formats in plain text have in common: numbers in columns, numbers in rows, notes, names.
vtu_vtkhdf    VTU and VTKHDF, the formats of VTK for meshes of cells, with the named parts as field data.
xdmf          XDMF, as FEniCSx reads it: the cells in one file, the facets of all sets in another, each a single grid.
"""
