"""TRIANGLES: points and segments -> triangles; smoothing; quality."""
