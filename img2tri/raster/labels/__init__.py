"""Values -> a label for each pixel.

segmentation          `segment`: which of the ways below a picture takes -> `Segmentation`: labels, background, and the gray values that
                      place the outlines
colours_to_gray       colours, palettes and transparency -> one gray value for each pixel
otsu_threshold        gray values -> a mask: a given level, the middle of two values, or Otsu's level
label_maps            integers or colours -> a label map, and the label that is not meshed (the background)
cropping              the part of a picture within a box
connected_components  the pieces of each region that hang together, and how they touch
specks_and_holes      small components dropped, small holes filled, or only the largest component of each region kept
"""
