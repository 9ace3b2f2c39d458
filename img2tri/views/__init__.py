"""For others: a mesh as the objects, files and figures other programs read.

    surface              checks the arrays; lays them flat or gives them a thickness
    edges                each edge once; which of them bound a region
    solid                extrude: triangles -> the closed surface of a solid
    bodies               a closed surface for each region, sharing their walls
    wedges               a solid filled with wedges; quadratic elements
    trimesh_objects      to_trimesh; GLB
    pyvista_objects      to_pyvista, to_grid; VTP and VTU
    writers              STL, PLY, OBJ, OFF
    threemf              3MF
    readers, vtkxml      each format back
    files                save and load, by suffix
    storing              a file is whole or not there
    vectors              outlines as SVG, DXF, GeoJSON
    figure               draw: the mesh over its image, with a histogram
    notebook             a small SVG and a line of numbers
    page, tables, charts a page of HTML with mesh, image and certificate; page.html and page.js beside it
    png                  an image as a PNG
    colours              one colour per region

Here, as in the libraries and formats this room serves, a triangle in space is a face or cell.
"""
