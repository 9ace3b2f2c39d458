"""Many images: each becomes a mesh, in order, by processes of this machine or by the workers of a Dask cluster.

sources       what a user has (paths, patterns, folders, stacks, zarr groups) -> images with their names, one at a time
workers       where functions are called: here, or in local processes, which are started here
dask_cluster  the third place: the workers of a Dask cluster
in_order      calls -> results, in order, in batches that are worth their cost, so many at once
mesh_images   the recipe: `img2tri.mesh_images`
"""
