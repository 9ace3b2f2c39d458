"""The paper *A Mathematical Analysis of Image Mesh Generation Using Delaunay Triangulation and Image Processing Techniques*, whole.

Every function of its listing, in the order of the paper:

============  ============================  ==========================================================================
Section       In the listing                Here
============  ============================  ==========================================================================
II-A, III-A   `read_image`                  `raster.reading.read`, then `raster.labels.colours_to_gray.to_gray`, then
                                            `raster.labels.otsu_threshold.binarize` with T = 240
II-B, III-B   `generate_mesh`               `paper.grid.structured_grid`
II-B, III-B   `adjust_mesh`                 `paper.grid.mask_filter`
III-C         `cv2.findContours`            `paper.contours.external_contours`, `paper.contours.contour_polygon`
II-C, III-C   `distribute_boundary_points`  `paper.boundary_points.arc_length_samples`
II-C, III-C   `poisson_disk_sampling`       `paper.poisson_disk.poisson_disk`, Algorithm 1; its darts fall into the squares
                                            of `paper.active_cells`
II-D, III-D   `create_mesh`                 `paper.delaunay.delaunay`
II-E, III-E   `valid_triangles`             `paper.delaunay.centroid_filter`
II-E, III-E   `find_neighbors`              `triangles.tools.topology.adjacency`
II-E, III-E   `laplacian_smoothing`         `triangles.tools.laplacian_smoothing.uniform`
III-C         `put_together`                `paper.structured_unstructured.unstructured_mesh`; without contours
                                            `paper.structured_unstructured.structured_mesh`
============  ============================  ==========================================================================

Three of them are not in this house, since the default recipe needs them too. What differs from the paper, and why, is in the README;
`examples/02_paper_step_by_step.py` goes this way with pictures, and the tests hold each function against the listing as printed.

The modules, in that order: grid, contours, boundary_points, poisson_disk, active_cells, delaunay, structured_unstructured. The values
the paper chooses (T = 240, a grid of 10 px) are in defaults.
"""
