"""Files and arrays -> the values in them, and where they lie in the world.

byte_sources   Where the bytes of an image come from: a file by its path, or one that is open already -> a `Source`.
dicom_nifti    DICOM and NIfTI, as scanners and segmentation programs write them -> values, notes and the size of a pixel in millime
fingerprint    The fingerprint of an image: its pixels -> one line of text that is another for any other pixels.
icons          Windows icons: how large the images in them are -> checked before Pillow decodes one, which it does as soon as it ope
image_files    A file -> the values in it, what was noted while reading, and the size of a pixel in millimetres if the file says it.
metadata       What a file notes about its image besides the values: how to turn it upright, and the size of a pixel.
pages          What every decoder returns, and what it checks before it decodes: which page, and how many pixels.
pixel_arrays   What an array of pixels is: the check every stage of this room makes at its door.
pyvista_image  A planar ``pyvista.ImageData`` -> `Picture`, lying where the object lies.
reading        A file, an array or a ``pyvista.ImageData`` -> a `Picture`: the values as they are, and where they lie in the world.
tiff           TIFFs of types Pillow has no mode for: int64, float64, int8, colours of 16 bit -> their values, by tifffile.
"""
