"""A mesh as a file, and back.

save_load        save and load: the table of formats by suffix, with who writes and who reads each
stl_ply_obj_off  writes STL, PLY, OBJ, OFF: headers, normals, groups, properties
threemf          writes 3MF, in colours
glb              writes GLB, in colours
vtp_vtu          writes VTP and VTU
svg_dxf_geojson  writes the outlines as drawings
solvers/         writes MSH, INP, BDF, XDMF, MESH, VTU, VTKHDF, with named parts
readers/         reads them back, with all they hold
xml_text         texts in XML
number_rows      arrays of numbers as text, one row in a line
array_names      names of arrays that files can hold
atomic_write     a file is whole or it is not there
"""
