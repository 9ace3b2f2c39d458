"""What a page about a mesh says in words and tables: the certificate, as plain data -> pieces of HTML.

Each promise is a row of the certificate: what was found, what was promised, and a mark. Without a promise there is no mark, but a dash.
"""

from __future__ import annotations

import html
import json
import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from img2tri.arrays import Floats
from img2tri.errors import MeshError

_DEFECTS = {
    "inverted": "Triangles turned over",
    "degenerate": "Triangles without area",
    "nonmanifold_edges": "Edges of over two triangles",
    "pinched_vertices": "Pinched vertices",
    "duplicate_vertices": "Vertices twice in one place",
    "unused_vertices": "Vertices without a triangle",
}
REGION_COLUMNS = ("Region", "Triangles", "Area", "Error", "Parts / holes")
_MARKS = {True: ("✓", "good", "kept"), False: ("✗", "bad", "not kept"), None: ("-", "none", "not promised")}
_LISTS = {"wrong_pixels_at": "pixel centres", "narrow_at": "triangles below"}  # and what their warnings say
_PLACE = re.compile(r"\((-?[\d.]+(?:e[-+]?\d+)?), (-?[\d.]+(?:e[-+]?\d+)?)\)")


@dataclass(frozen=True)
class Place:
    """A place to be looked at.

    Attributes
    ----------
    at
        (x, y) in the world.
    number
        Of the warning it belongs to, from 1; 0 if all is well there.
    first
        Whether it is the place the warning names.
    source
        What of the certificate led there.
    """

    at: tuple[float, float]
    number: int
    first: bool
    source: str


def from_json(report: str) -> dict[str, Any]:
    """Return a certificate as plain data.

    Raises
    ------
    MeshError
        If it is none.
    """
    try:
        facts = json.loads(report)
    except ValueError as problem:
        raise MeshError(f"report: expected JSON, found {report[:40]!r}: {problem}") from None
    if not isinstance(facts, dict):
        raise MeshError(f"report: expected an object of JSON, found {type(facts).__name__}")
    return facts


def text(words: object) -> str:
    """Escape what means something in HTML."""
    return html.escape(str(words))


def places(facts: dict[str, Any]) -> list[Place]:
    """Collect the places of the certificate: those its warnings name, those listed with them, and the extreme ones.

    Examples
    --------
    >>> places({"warnings": ["2 triangles below 30 degrees, the worst 21 at (3.5, 4.0)"], "narrow_at": [[3.5, 4.0], [8.0, 1.0]]})[1]
    Place(at=(8.0, 1.0), number=1, first=False, source='narrow_at')
    """
    found: dict[tuple[float, float], Place] = {}
    lines = facts.get("warnings", [])
    for number, warning in enumerate(lines, 1):
        if match := _PLACE.search(warning):
            at = float(match[1]), float(match[2])
            found.setdefault(at, Place(at, number, True, "warning"))
    for name, words in _LISTS.items():
        number = next((i for i, line in enumerate(lines, 1) if words in line), 0)
        for x, y in facts.get(name) or []:
            found.setdefault((float(x), float(y)), Place((float(x), float(y)), number, False, name))
    for name in ("hausdorff_at", "smallest_angle_at"):
        if facts.get(name):
            x, y = facts[name]
            found.setdefault((float(x), float(y)), Place((float(x), float(y)), 0, False, name))
    return list(found.values())


def verdict(facts: dict[str, Any]) -> str:
    """Say in a few words whether all is well."""
    if "warnings" not in facts:
        return ""
    warnings = len(facts["warnings"])
    if not warnings:
        promised = facts.get("tolerance") is not None
        return f'<span class="chip good">✓ {"every promise kept" if promised else "nothing found wrong"}</span>'
    return f'<span class="chip bad">✗ {warnings} warning{"s" if warnings > 1 else ""}</span>'


def tiles(facts: dict[str, Any], vertices: int, triangles: int, count: int, q: Floats, angle: Floats) -> str:
    """Name the numbers one looks for first."""
    numbers = [
        (f"{triangles:,}", "triangle" if triangles == 1 else "triangles"),
        (f"{vertices:,}", "vertices"),
        (f"{count:,}", "region" if count == 1 else "regions"),
        (f"{angle.min():.1f}°", "smallest angle"),
        (f"{q.mean():.3f}", "mean quality q"),
    ]
    if "hausdorff" in facts:
        numbers.append((_number(facts["hausdorff"]), "outlines and mesh apart"))
    if length := facts.get("settings", {}).get("edge_length"):
        numbers.append((length if isinstance(length, str) else _number(length), "wanted edge length"))
    return "".join(f"<div><b>{text(number)}</b><span>{text(words)}</span></div>" for number, words in numbers)


def warnings(facts: dict[str, Any], seen: Sequence[Place]) -> str:
    """List the warnings, each with the number its places have on the mesh."""
    lines = facts.get("warnings", [])
    if not lines:
        return ""
    where = {place.number: i for i, place in enumerate(seen) if place.first}
    items = "".join(
        f"<li><i>{number}</i>" + (_link(line, where[number]) if number in where else f"<span>{text(line)}</span>") + "</li>"
        for number, line in enumerate(lines, 1)
    )
    return f'<section class="card warned"><h2>Warnings</h2><ol class="warnings">{items}</ol></section>'


def certificate(facts: dict[str, Any], seen: Sequence[Place]) -> str:
    """Lay out the certificate as a table, as far as there is one."""
    where = {place.at: i for i, place in enumerate(seen)}

    def at(name: str) -> int | None:
        listed = facts.get(name) or [None]
        first = listed if isinstance(listed[0], (int, float)) else listed[0]
        return where.get((float(first[0]), float(first[1]))) if first else None

    rows = [*_fidelity(facts, at), *_topology(facts), *_validity(facts), *_quality(facts, at)]
    return f"<table>{''.join(rows)}</table>" if rows else '<p class="quiet">There is no image to judge this mesh by.</p>'


def _fidelity(facts: dict[str, Any], at: Any) -> list[str]:
    rows = [_group("Fidelity")]
    if "hausdorff" in facts:
        distance, most = facts["hausdorff"], facts.get("tolerance")
        promised, kept = ("", None) if most is None else (f"≤ {_number(most)}", distance <= most * (1 + 1e-9))
        rows.append(_row("Outlines and mesh apart", _number(distance), promised, kept, at("hausdorff_at")))
    if "wrong_pixels" in facts:
        rows.append(_row("Pixel centres on a wrong side", facts["wrong_pixels"], "0", facts["wrong_pixels"] == 0, at("wrong_pixels_at")))
    errors = [abs(row["error"]) for row in facts.get("areas", {}).values()]
    if errors:
        # Kept within 1 % for all but regions of a few pixels; which these are, the certificate does not say.
        promised = "≤ 1 %" if facts.get("tolerance") is not None else ""
        kept = True if promised and max(errors) <= 0.01 else None
        rows.append(_row("Areas off at most", _percent(max(errors)).lstrip("+"), promised, kept))
    return rows if len(rows) > 1 else []


def _topology(facts: dict[str, Any]) -> list[str]:
    rows = [_group("Topology")]
    if "topology" in facts:
        found = facts["topology"].values()
        right = sum(row["found"] == row["expected"] for row in found)
        rows.append(_row("Components and holes", f"{right:,} of {len(found):,}", "all", right == len(found)))
    if "neighbours_missing" in facts:
        wrong = len(facts["neighbours_missing"]) + len(facts.get("neighbours_extra", []))
        rows.append(_row("Regions that touch differently", wrong, "0", wrong == 0))
    if "unknown_labels" in facts:
        rows.append(_row("Labels not in the image", len(facts["unknown_labels"]), "0", not facts["unknown_labels"]))
    return rows if len(rows) > 1 else []


def _validity(facts: dict[str, Any]) -> list[str]:
    rows = [_row(words, facts[name], "0", facts[name] == 0) for name, words in _DEFECTS.items() if name in facts]
    return [_group("Validity"), *rows] if rows else []


def _quality(facts: dict[str, Any], at: Any) -> list[str]:
    if "smallest_angle" not in facts:
        return []
    least = facts.get("min_angle")
    angle, narrow = facts["smallest_angle"], facts.get("narrow", 0)
    promised, kept = ("", None) if least is None else (f"≥ {least:g}°", angle >= least - 1e-9)
    rows = [_group("Quality"), _row("Smallest angle", f"{angle:.2f}°", promised, kept, at("smallest_angle_at"))]
    if least is not None:
        rows.append(_row(f"Triangles below {least:g}°", narrow, "0", narrow == 0, at("narrow_at")))
    return rows


def _group(name: str) -> str:
    return f'<tr class="group"><td colspan="4">{name}</td></tr>'


def _row(words: str, found: object, promised: str, kept: bool | None, place: int | None = None) -> str:
    mark, kind, spoken = _MARKS[kept]
    number = f"{found:,}" if isinstance(found, int) else text(found)
    shown = number if place is None else _link(number, place, bad=kept is False)
    return (
        f'<tr><td>{text(words)}</td><td class="number">{shown}</td><td class="number quiet">{text(promised)}</td>'
        f'<td class="mark {kind}" title="{spoken}" aria-label="{spoken}">{mark}</td></tr>'
    )


def _link(words: str, place: int, *, bad: bool = False) -> str:
    return f'<button type="button" class="place{" bad-text" if bad else ""}" data-place="{place}" title="show it">{text(words)}</button>'


def regions(facts: dict[str, Any], rows: Sequence[tuple[int, str, str, int]]) -> str:
    """Lay out the regions, each (label, name, colour, number of triangles), with what the certificate knows about them."""
    body = ""
    for i, (label, name, colour, triangles) in enumerate(rows):
        area, shape = facts.get("areas", {}).get(str(label)), facts.get("topology", {}).get(str(label))
        right = shape is None or shape["found"] == shape["expected"]
        holes = "" if shape is None else f"{shape['found'][0]} / {shape['found'][1]}"
        cells = [_cell(f"{triangles:,}", triangles)]
        if area is None:
            cells += 2 * [_cell("", "")]
        else:
            cells += [_cell(_number(area["mesh"]), area["mesh"]), _cell(_percent(area["error"]), abs(area["error"]))]
        body += (
            f'<tr data-region="{i}"><td data-value="{text(name)}"><button type="button" class="place" data-region="{i}">'
            f'<span class="swatch" style="background:{colour}"></span>{text(name)}</button></td>{"".join(cells)}'
            f'<td class="number{"" if right else " bad-text"}">{holes}</td></tr>'
        )
    heads = [f'<button type="button" data-sort="{i}" title="order">{name}</button>' for i, name in enumerate(REGION_COLUMNS)]
    head = f"<th>{heads[0]}</th>" + "".join(f'<th class="number">{words}</th>' for words in heads[1:])
    return f'<div class="long"><table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table></div>'


def _cell(words: str, value: object) -> str:
    """Lay out a number, with its value to order rows by."""
    return f'<td class="number" data-value="{value}">{words}</td>'


def settings(facts: dict[str, Any]) -> str:
    """Lay out all options."""
    rows = {"recipe": facts.get("recipe"), **facts.get("settings", {}), **facts.get("counted", {})}
    body = "".join(f"<tr><td>{text(name)}</td><td>{text('' if value is None else value)}</td></tr>" for name, value in rows.items())
    return f"<table>{body}</table>"


def _number(value: float) -> str:
    return f"{value:,.4g}" if abs(value) < 1e4 else f"{value:,.0f}"


def _percent(share: float) -> str:
    return f"{100 * share:+.3f} %" if abs(share) >= 5e-6 else "0 %"
