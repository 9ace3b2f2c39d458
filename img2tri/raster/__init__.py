"""Room 1, PIXELS: from a file or an array to a mask, gray values or a label map, and their place in the world.

In the order of the flow:

``reading``
    `read`: a path, an array or a ``pyvista.ImageData`` -> `Picture`, the values as they are and where they lie.
    Paths go through ``decoding``, with ``tags`` and ``medical`` beside it, image data of pyvista through ``imagedata``.
``cropping``
    `crop`: the part of a picture within a box.
``gray``
    `to_gray`: colours, palettes and transparency -> one value per pixel.
``binarizing``
    `binarize`: gray values -> mask, and the level that was chosen.
``labelling``
    `label_map`: values or colours -> an integer label per pixel, and which of them is not meshed.
``cleaning``
    `clean`: a mask or label map without specks and pinholes. Its pieces are found in ``components``.

``checking`` says what an array of pixels is; every stage asks it, so each can be used alone.
"""
