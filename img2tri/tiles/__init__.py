"""One image larger than memory -> one mesh in parts: block by block, each fitted to its neighbours, edge by edge.

    mesh_tiles         `mesh_tiles`, every step in order: the place to begin reading
    pixel_source       the file or array the pixels come from, read window by window
    first_pass         what has to be known of the whole image: level, default edge length, a hash of all pixels -> the plan
    cleaning           specks, holes and largest components, across blocks
    block_plan         the grid of blocks, their order in four colours, their territories; what each is meshed by
    blocks_in_memory   an image in memory by the same blocks: the same bits
    window_regions     the regions in a window, read or cut out
    mesh_block         the work of one task: a block is meshed with what is around it, and fitted to the pieces that are there
    outline_posts      places of outlines near borders of blocks that are vertices in all windows
    seams              two neighbours fitted to each other: pieces, what is merged, gaps that are filled
    piece_files        pieces on disk, whole or not there, from which an interrupted run goes on; or in memory
    parts              the mesh in files of parts: zarr, .pvtu, .vtkhdf, each written by a worker; and read back
    whole_files        files that are whole or not there
    run_tasks          a function called for each block, in this process or on a Dask cluster

    block    a square of the image, 2048 px, from which follows what is meshed at once; never from the tile
    window   a block and what is around it: what one task reads
    piece    the triangles of the mesh that belong to a block
    tile     the blocks that the user wants in one file
    part     the pieces of a tile, in a file

Two neighbours see the same pixels around their common border, but not the same image. Both have the nodes of one lattice, and vertices of
outlines at the same posts, so that their meshes are nearly alike there. The first one stays. Of the other, vertices that are nearly at the
place of a finished one take it. Where the meshes still differ, its triangles near the border give way, outlines are spliced, and the gap
is filled between the two rims, which stay as they are to the last bit: so nothing can hang. Where no good triangles are found, a few of
the first one's are given up too.
"""
