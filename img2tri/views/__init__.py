"""For others: a mesh as the objects, files and figures other programs read.

    surface              checks the arrays; lays them flat or gives them a thickness
    solid                extrude: triangles -> the closed surface of a solid
    trimesh_objects      to_trimesh; GLB
    pyvista_objects      to_pyvista, to_grid; VTP and VTU
    writers              STL, PLY, OBJ, OFF
    threemf              3MF
    readers, vtkxml      each format back
    files                save and load, by suffix
    storing              a file is whole or not there
    figure               draw: the mesh over its image, with a histogram
    colours              one colour per region

Here, as in the libraries and formats this room serves, a triangle in space is a face or cell.
"""
