"""SHAPES: label map -> outlines, shapely polygons, spacing, points."""
