"""3MF, the format of slicers: bodies or a flat mesh -> the bytes of a file, which is a zip of one XML text and two fixed ones.

Written here because trimesh numbers the parts of a 3MF at random, so that the same mesh would never give the same file, and writes no
colours. The format is that of the 3MF core specification 1.3 and its materials extension.

Slicers go by objects: OrcaSlicer and Bambu Studio give each object the filament of its colour, but OrcaSlicer passes over the colours of
triangles, and of a group of several colours takes the last. So each region of a solid is a closed object of its own, whose colour is
alone in its group.
"""

from __future__ import annotations

import io
import zipfile
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from img2tri.arrays import Floats
from img2tri.views.figures.region_colours import region_colours
from img2tri.views.formats.number_rows import rows
from img2tri.views.formats.xml_text import xml_escaped, xml_quoted
from img2tri.views.objects.body_per_region import Body
from img2tri.views.objects.flat_or_extruded import Surface

_UNITS_OF_3MF = {"um": "micron", "mm": "millimeter", "cm": "centimeter", "m": "meter", "in": "inch", "ft": "foot"}

_CONTENT_TYPES = """<?xml version="1.0" encoding="UTF-8"?>
<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">
<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>
<Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/>
</Types>
"""

_RELATIONS = """<?xml version="1.0" encoding="UTF-8"?>
<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">
<Relationship Id="rel0" Target="/3D/3dmodel.model" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/>
</Relationships>
"""

_MODEL = """<?xml version="1.0" encoding="UTF-8"?>
<model unit="{unit}" xml:lang="en-US" xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
 xmlns:m="http://schemas.microsoft.com/3dmanufacturing/material/2015/02" xmlns:img2tri="urn:img2tri">
{notes}
<resources>
{resources}
</resources>
<build>{items}</build>
</model>
"""

_OBJECT = """<object id="{number}" type="{kind}" name={name} pid="{group}" pindex="0"><mesh><vertices>
{vertices}
</vertices><triangles>
{triangles}
</triangles></mesh></object>"""


def bodies_3mf(made: Sequence[Body]) -> bytes:
    """Return the bytes of a 3MF file of closed bodies: one object for each, with its name and colour; all digits of the coordinates.

    Texts are metadata. The unit is the millimetre, unless ``field_data["units"]`` is "um", "cm", "m", "in" or "ft".
    """
    groups = [_colour_group(i, [body.colour]) for i, body in enumerate(made, 1)]
    objects = [
        _object(len(made) + i, i, "model", body.name, body.surface.points, '<triangle v1="{}" v2="{}" v3="{}"/>', body.surface.faces)
        for i, body in enumerate(made, 1)
    ]
    return _package([*groups, *objects], len(made), made[0].surface.field_data, [body.label for body in made])


def flat_3mf(made: Surface) -> bytes:
    """Return the bytes of a 3MF file of a flat mesh: one object of type "surface", which may be open, with a colour for each triangle."""
    labels, colour = np.unique(made.regions, return_inverse=True)
    triangle = '<triangle v1="{}" v2="{}" v3="{}" pid="1" p1="{}"/>'
    whole = _object(2, 1, "surface", "mesh", made.points, triangle, np.column_stack([made.faces, colour]))
    return _package([_colour_group(1, region_colours(labels.tolist(), made.colours)), whole], 1, made.field_data, labels.tolist())


def _colour_group(number: int, colours: Iterable[Sequence[int]]) -> str:
    inside = "".join(f'<m:color color="#{red:02X}{green:02X}{blue:02X}"/>' for red, green, blue in colours)
    return f'<m:colorgroup id="{number}">{inside}</m:colorgroup>'


def _object(number: int, group: int, kind: str, name: str, points: Floats, triangle: str, faces: NDArray[np.integer[Any]]) -> str:
    return _OBJECT.format(
        number=number, kind=kind, name=xml_quoted(name), group=group,
        vertices="\n".join(rows('<vertex x="{!r}" y="{!r}" z="{!r}"/>', points)),
        triangles="\n".join(rows(triangle, faces)),
    )  # fmt: skip


def _package(resources: list[str], objects: int, texts: Mapping[str, str], labels: list[int]) -> bytes:
    """Zip the model; its last resources are the objects to be built."""
    notes = {"regions": " ".join(map(str, labels)), **texts}
    last = len(resources)
    model = _MODEL.format(
        unit=_UNITS_OF_3MF.get(texts.get("units", "mm"), "millimeter"),
        notes="\n".join(f'<metadata name="img2tri:{_xml_name(name)}">{xml_escaped(text)}</metadata>' for name, text in notes.items()),
        resources="\n".join(resources),
        items="".join(f'<item objectid="{number}"/>' for number in range(last - objects + 1, last + 1)),
    )
    package = io.BytesIO()
    with zipfile.ZipFile(package, "w") as archive:
        for name, text in {"[Content_Types].xml": _CONTENT_TYPES, "_rels/.rels": _RELATIONS, "3D/3dmodel.model": model}.items():
            # A ZipInfo made from the name alone is dated 1980, whatever the clock says.
            archive.writestr(zipfile.ZipInfo(name), text, zipfile.ZIP_DEFLATED)
    return package.getvalue()


def _xml_name(text: str) -> str:
    """Make an XML name of any text: what cannot stand in one becomes an underscore."""
    return "".join(letter if letter.isalnum() or letter in "-." else "_" for letter in text)
