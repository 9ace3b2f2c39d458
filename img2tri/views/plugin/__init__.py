"""What pyvista finds by entry points.

accessor         What pyvista users find on their own objects, by entry point and with no import of img2tri.
datasets         Objects of pyvista -> `img2tri.views.objects.cells.Cells`, so that whatever is in hand there can be written for sol
readers_writers  What pyvista finds by entry points: readers and writers of the formats it lacks, for `pyvista.read`, ``.save`` and
"""
