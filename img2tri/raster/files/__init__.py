"""Image files -> the values in them, notes, and the size of a pixel: one decoder for each format.

byte_sources      where the bytes come from: a path, or a file that is open already
format_detection  `decode`: which format a file has, told by its first bytes or its suffix, and the decoder for it; damaged files
decoded_image     what every decoder returns, and checks first: is there such a page, are there too many pixels
image_names       folders and patterns -> names of images
pillow_images     PNG, JPEG, GIF, BMP, WebP, most TIFFs and all else that Pillow knows
windows_icons     the size of the images in an icon, checked before Pillow decodes them
tiff              TIFFs of types Pillow has no mode for
dicom             DICOM: frames, rescaling to measured values
nifti             NIfTI: slices of a volume
npy_npz           NumPy's own files
nrrd_metaimage    NRRD (3D Slicer) and MetaImage (ITK, ITK-SNAP), with the names of segments
hdf5_zarr         HDF5 and zarr: ``file.h5:/path``
volumes           of volumes and stacks one plane: which axes are the image, and only as many bytes as that needs
"""
