"""What a file says of its image beside the values.

exif_orientation    the EXIF or TIFF orientation -> the image upright
pixel_size          the resolution noted by TIFF, EXIF, JFIF or PNG -> the size of a pixel in millimetres
geotiff_imagej_ome  GeoTIFF, ImageJ and OME-TIFF: the size of a pixel, its unit, and where the image lies
nodata              no-data values of files, NaN and masked arrays -> which pixels are not there
wanted_width        the width a user wants -> the size of a pixel
"""
