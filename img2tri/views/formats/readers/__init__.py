"""Files read back: the bytes of a file -> `img2tri.views.formats.readers.file_contents.Found`, with regions, names and sets.

read_any                  any file by its suffix, with all it holds
flat_mesh                 a plane mesh of any format: its arrays, where its image lies, the names its user gave
known_sets      named sets of edges of a file beyond those that are found anew
solid_quality             cells in space as a file holds them -> a table of their quality
file_contents                     what a file holds: the record all readers return, and the labels in names and tables
read_stl_ply_obj_off_glb  the formats trimesh knows
read_3mf                  3MF
read_vtp_vtu              VTP and VTU
read_vtkhdf               VTKHDF
read_msh_bdf              MSH of Gmsh, BDF of Nastran
read_inp                  INP of Abaqus and CalculiX
read_xdmf                 XDMF
read_medit                MESH of Medit and FreeFem
"""
