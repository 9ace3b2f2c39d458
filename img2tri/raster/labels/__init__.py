"""Values -> a label for each pixel.

segmentation          `segment`: which of the ways below a picture takes -> `Segmentation`: labels, background, and the gray values that
                      place the outlines
colours_to_gray       colours, palettes and transparency -> one gray value for each pixel
transparency          the alpha channel -> which pixels are there
otsu_threshold        gray values -> a mask: a given level, the middle of two values, or Otsu's level
colour_quantization   the option `colors`: a picture with blurred edges -> the nearest of a few flat colours, and the mixes that place edges
flat_colours          for the former: which colours an image is made of, and which of them a pixel is, or is mixed of
label_map_detection   whether values look like a label map, which is not to be thresholded by mistake
rgb_to_labels         the option `labels`: each integer, palette entry or RGB colour -> one number; which of them is background
absorbed_labels       thin separators: the pixels of some labels given to their nearest neighbours
cropping              the part of a picture within a box
connected_components  the pieces of each region that hang together, and how they touch
specks_and_holes      small components dropped, small holes filled, or only the largest component of each region kept
meshing_warnings      what will come of a label map that is hardly meant, told before the work
"""
