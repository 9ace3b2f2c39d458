"""Stage 1, from an image to labels: a file or an array in, a label for each pixel and its place in the world out.

In the order of the flow:

reading            `read`: a path, an open file, an array or an object of another library -> `Picture`, the values and where they lie
files              one decoder for each file format, and what tells the formats apart
metadata           what a file says beside the values: which way up, how large a pixel is
in_memory          what counts as an array of pixels; objects of other libraries; the hash of an image
labels             `Picture` -> `Segmentation`: gray values, thresholds, label maps, cropping, removal of specks and holes
reading_decisions  what was decided while reading -> sentences for the report
"""
