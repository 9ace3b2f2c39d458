"""Many images: each becomes a mesh, in order, by processes of this machine or by the workers of a Dask cluster.

mesh_images    `img2tri.mesh_images`, every step in order: the place to begin reading
image_sources  what a user has (paths, patterns, folders, stacks, zarr groups) -> images with their names, one at a time
local_workers  where functions are called: in this process, or in processes of this machine, which are started here
preloaded      what these processes need, loaded once
dask_cluster   the third place: the workers of a Dask cluster
in_order       calls -> results, in order, in batches that are worth their cost, so many at once
"""
