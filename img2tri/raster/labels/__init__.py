"""Values -> a label for each pixel.

cleaning      Label map -> label map without specks: small components are dropped, small holes filled, or only the largest pieces ke
components    Label map -> its components: the pieces of each region that hang together, and how they touch.
cropping      Picture -> the part of it within a box, which stays where it was in the world.
gray          Colours, palettes and transparency -> one value per pixel, on the image's own scale.
label_maps    Values or colours -> a label map: an integer for each pixel, and which of them is not meshed.
segmentation  Picture -> zones: the label map to be meshed, and the gray values that place its outlines, if they say more than the l
thresholds    Gray values -> a mask, and the level that parts them.
"""
