"""What a file says of its image beside the values.

exif_orientation  the EXIF or TIFF orientation -> the image upright
pixel_size        the resolution noted by TIFF, EXIF, JFIF or PNG -> the size of a pixel in millimetres
"""
