"""A mesh as a file, and back.

save_load                 save and load: the table of formats by suffix, with who writes and who reads each
stl_ply_obj_off           writes STL, PLY, OBJ, OFF: headers, normals, groups, properties
threemf                   writes 3MF, in colours
glb                       writes GLB, in colours
vtp_vtu                   writes VTP and VTU
svg_dxf_geojson           writes the outlines as drawings
read_stl_ply_obj_off_glb  reads the formats trimesh knows
read_vtp_vtu              reads VTP and VTU
atomic_write              a file is whole or it is not there
solvers/                  MSH, INP, BDF, XDMF, VTU, VTKHDF, with named parts, written and read
"""
