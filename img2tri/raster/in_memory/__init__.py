"""Images in memory: arrays of pixels, and the objects of other libraries that hold one.

array_checks     what counts as an array of pixels: shape, type and values, checked at the door of every function of this stage
image_hash       the pixels -> SHA-256, for the report
pyvista_image    a planar ``pyvista.ImageData`` -> `Picture`, lying where the object lies
xarray_image     an ``xarray.DataArray`` -> `Picture`, lying where its coordinates say
simpleitk_image  a ``SimpleITK.Image`` -> `Picture`, lying where it lies in space
pillow_object    how a ``PIL.Image`` is recognised
"""
