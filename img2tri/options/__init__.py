"""Every option of `mesh_image`, each written once: name, type, default, unit, words, check, and how it is typed on the command line.

    image_options   reading an image, finding its regions     mesh_options   outlines, edge lengths, triangles     paper_options
    option          the record of an entry, and the checks    typed          texts typed on the command line -> values
    all_options           the entries by name: checks, groups for the stages, plain data for reports
    spelling        options that differ from their defaults -> the command line and the Python that make the same mesh
    describing      the signature and the Parameters section of functions that have these options

An option is one entry in one of the groups, which gives it to the stage the group belongs to. The signature that editors and mypy see,
the documentation, the command line and its help, the checks and the settings in a report follow from the entry.
"""

from __future__ import annotations

from img2tri.options.all_options import OPTIONS, MeshOptions

__all__ = ["OPTIONS", "MeshOptions"]
