"""One image larger than memory -> one mesh in parts: block by block, each fitted to its neighbours, edge by edge.

    tiling      `mesh_tiles`, every step in order: the place to begin reading
    sources     where pixels come from, read window by window
    survey      the first pass: level, default edge length, a hash of all pixels -> a plan
    plans       the grid of blocks, their order in four colours, their territories; what each is meshed by
    blocks      the work of one task: a block and what is around it, and what its mesh adds to the pieces that are there
    merging     a new mesh fitted to finished pieces: where both agree it goes on, else there is a gap to fill
    attempts    which way of filling a gap is tried where
    splices     where outlines go on through a gap
    cavities    a gap triangulated, smoothed, refined
    pieces      triangles of one block with their seam
    storage     pieces on disk, whole or not there
    numbering   the proof that all seams fit, and the numbers of vertices
    outputs     zarr, .pvtu, .vtkhdf

Two neighbours see the same pixels around their common border, but not the same image, and their meshes differ. The first one stays. Of the
other the triangles near its border give way, outlines are spliced, and the gap is filled between the two rims, which stay as they are to
the last bit: so nothing can hang. Where no good triangles are found, a few of the first one's are given up too.
"""
