"""Every option of `mesh_image`, each written once: name, type, default, unit, words, check, and how it is typed on the command line.

    image_options   reading an image, finding its regions     mesh_options   outlines, edge lengths, triangles     paper_options
    option          the record of an entry, and the checks its value has to pass
    all_options     the entries of all groups by name: checked together, dealt out to the stages, as plain data for reports
    parsing         texts typed on the command line -> values
    reproducing     options -> the command line and the line of Python that make the same mesh
    signature_docs  the signature and the Parameters section of functions that have these options

An option is one entry in one of the groups, which gives it to the stage the group belongs to. The signature that editors and mypy see,
the documentation, the command line and its help, the checks and the settings in a report follow from the entry.
"""

from __future__ import annotations

from img2tri.options.all_options import OPTIONS, MeshOptions

__all__ = ["OPTIONS", "MeshOptions"]
