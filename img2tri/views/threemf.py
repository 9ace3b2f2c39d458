"""3MF, the format of slicers: a surface -> the bytes of a file, which is a zip of one XML text and two fixed ones.

Written here because trimesh numbers the parts of a 3MF at random, so that the same mesh would never give the same file, and writes no
colours. The format is that of the 3MF core specification 1.3 and its materials extension.
"""

from __future__ import annotations

import io
import zipfile
from xml.sax.saxutils import escape

import numpy as np

from img2tri.views.colours import palette
from img2tri.views.surface import Surface
from img2tri.views.writers import rows

_UNITS = {"um": "micron", "mm": "millimeter", "cm": "centimeter", "m": "meter", "in": "inch", "ft": "foot"}

_TYPES = """<?xml version="1.0" encoding="UTF-8"?>
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
<m:colorgroup id="1">{colours}</m:colorgroup>
<object id="2" type="{kind}" pid="1" pindex="0"><mesh><vertices>
{vertices}
</vertices><triangles>
{triangles}
</triangles></mesh></object>
</resources>
<build><item objectid="2"/></build>
</model>
"""


def threemf(made: Surface) -> bytes:
    """Return the bytes of a 3MF file: one object with one colour per region, all digits of the coordinates, texts as metadata.

    Regions are colours, which slicers read, and not objects of their own, because an object has to be closed and there are no walls between
    regions. A flat mesh is an object of type "surface", which may be open. The unit is the millimetre, unless
    ``field_data["units"]`` is "um", "cm", "m", "in" or "ft".
    """
    labels, colour = np.unique(made.regions, return_inverse=True)
    notes = {"regions": " ".join(map(str, labels)), **made.field_data}
    model = _MODEL.format(
        unit=_UNITS.get(made.field_data.get("units", "mm"), "millimeter"),
        notes="\n".join(f'<metadata name="img2tri:{_name(name)}">{escape(text)}</metadata>' for name, text in notes.items()),
        colours="".join(f'<m:color color="#{red:02X}{green:02X}{blue:02X}"/>' for red, green, blue in palette(len(labels)).tolist()),
        kind="model" if made.closed else "surface",
        vertices="\n".join(rows('<vertex x="{!r}" y="{!r}" z="{!r}"/>', made.points)),
        triangles="\n".join(rows('<triangle v1="{}" v2="{}" v3="{}" pid="1" p1="{}"/>', np.column_stack([made.faces, colour]))),
    )
    package = io.BytesIO()
    with zipfile.ZipFile(package, "w") as archive:
        for name, text in {"[Content_Types].xml": _TYPES, "_rels/.rels": _RELATIONS, "3D/3dmodel.model": model}.items():
            # A ZipInfo made from the name alone is dated 1980, whatever the clock says.
            archive.writestr(zipfile.ZipInfo(name), text, zipfile.ZIP_DEFLATED)
    return package.getvalue()


def _name(text: str) -> str:
    """Make an XML name of any text: what cannot stand in one becomes an underscore."""
    return "".join(letter if letter.isalnum() or letter in "-." else "_" for letter in text)
