"""The paper's own listing, function by function, as the baseline for times and the oracle for what our stages must equal.

Copied as printed: same names, same loops, same order of steps. What had to be touched so that it runs is marked "Deviation".
The printed indentation is broken by the columns of the page; it is set here as the text describes it.
"""

from __future__ import annotations

import cv2
import numpy as np
from scipy.spatial import Delaunay
from scipy.spatial.distance import cdist
from shapely.geometry import Point, Polygon


# III-A
def read_image(image_path):
    image = cv2.imread(image_path)
    gray = cv2.cvtColor(image, cv2.COLOR_BGR2GRAY)
    _, binary = cv2.threshold(gray, 240, 255, cv2.THRESH_BINARY)
    return image, binary


# III-B
def generate_mesh(image_shape):
    height, width = image_shape
    x = np.arange(0, width, 10)
    y = np.arange(0, height, 10)
    xv, yv = np.meshgrid(x, y)
    points = np.vstack([xv.ravel(), yv.ravel()]).T
    return points  # noqa: RET504


def adjust_mesh(points, binary_image):
    y, x = np.where(binary_image == 255)
    mask = np.zeros(binary_image.shape, dtype=bool)
    mask[y, x] = True
    adjusted_points = [point for point in points if mask[int(point[1]), int(point[0])]]
    return np.array(adjusted_points)


# III-C
def distribute_boundary_points(boundary, n_points):
    boundary = np.vstack([boundary, boundary[0]])
    total_length = np.sum(np.sqrt(np.sum(np.diff(boundary, axis=0) ** 2, axis=1)))
    spacing = total_length / n_points
    boundary_points = []
    current_length = 0
    i = 0
    while len(boundary_points) < n_points:
        start = boundary[i]
        end = boundary[i + 1]
        segment_length = np.linalg.norm(end - start)
        while current_length + segment_length >= spacing:
            t = (spacing - current_length) / segment_length
            new_point = start + t * (end - start)
            boundary_points.append(new_point)
            current_length = 0
            start = new_point
            segment_length = np.linalg.norm(end - start)
        current_length += segment_length
        i += 1
        if i >= len(boundary) - 1:
            break
    if np.linalg.norm(boundary_points[0] - boundary_points[-1]) > spacing / 2:
        boundary_points.append(boundary_points[0])
    return np.array(boundary_points)


# Deviation: the generator is passed in, where the listing draws from numpy's global one.
def poisson_disk_sampling(boundary, boundary_points, min_dist, num_samples, min_dist_to_boundary, rng):
    polygon = Polygon(boundary)
    bbox = polygon.bounds
    points = []
    while len(points) < num_samples:
        x = rng.uniform(bbox[0], bbox[2])
        y = rng.uniform(bbox[1], bbox[3])
        candidate = Point(x, y)
        if polygon.contains(candidate):  # noqa: SIM102
            if len(points) == 0 or np.min(cdist([candidate.coords[0]], points)) > min_dist:  # noqa: SIM102
                if np.min(cdist([candidate.coords[0]], boundary_points)) > min_dist_to_boundary:
                    points.append([x, y])
    return np.array(points)


# III-D
def create_mesh(tri_points):
    return Delaunay(tri_points)


# III-E
# Deviation: printed as bare statements; made a function of the names they use.
def valid_triangles(tri, all_points, polygon):
    valid_triangles = []
    for simplex in tri.simplices:
        vertices = all_points[simplex]
        triangle_center = vertices.mean(axis=0)
        if polygon.contains(Point(triangle_center)):
            valid_triangles.append(simplex)
    return valid_triangles


def find_neighbors(point_index, triangles):
    neighbors = set()
    for tri in triangles:
        if point_index in tri:
            neighbors.update(tri)
    if point_index in neighbors:
        neighbors.remove(point_index)
    return list(neighbors)


def laplacian_smoothing(points, triangles, boundary_points, iterations=10):
    for _ in range(iterations):
        new_points = np.copy(points)
        for i in range(len(points)):
            if i < len(boundary_points):
                continue
            neighbors = find_neighbors(i, triangles)
            if neighbors:
                new_points[i] = np.mean(points[neighbors], axis=0)
        points[:] = new_points
    return points


# III-C, III-D and III-E in the order of the text.
# Deviations: `binary_image` is the parameter (printed: `image`, unused, and `binary_image` undefined);
# `distribute_boundary_points` is called by the name it is defined with (printed: `distribute_uniform_boundary_points`);
# the steps after `all_points`, described in sections III-D and III-E, follow it in the loop; the meshes are returned
# (printed: nothing is).
def put_together(binary_image, n_boundary_points, n_interior_points, min_distance, min_dist_to_boundary, rng):
    meshes = []
    contours, _ = cv2.findContours(binary_image, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_SIMPLE)
    for contour in contours:
        boundary = contour.reshape(-1, 2)
        boundary_points = distribute_boundary_points(boundary, n_boundary_points)
        interior_points = poisson_disk_sampling(boundary, boundary_points, min_distance, n_interior_points, min_dist_to_boundary, rng)
        all_points = np.vstack([boundary_points, interior_points])
        tri = create_mesh(all_points)
        triangles = valid_triangles(tri, all_points, Polygon(boundary))
        laplacian_smoothing(all_points, triangles, boundary_points)
        meshes.append((all_points, np.array(triangles), boundary_points))
    return meshes
