"""A table of many images, a row each: counts, angles, areas, distance, seconds, what was chosen; and which are whole already.

A row is written as soon as its image is done, so that an interrupted run leaves the rows it has; `--resume` reads them, and skips images
whose bytes and options are those of their row and whose files are still what was written.
"""

from __future__ import annotations

import csv
import hashlib
import io
import json
import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from img2tri import __version__
from img2tri.cli.job import Job, Outcome
from img2tri.cli.stdin_stdout import DASH
from img2tri.errors import FileError, ParameterError

if TYPE_CHECKING:
    from img2tri.mesh import TriangleMesh

TABLES = (".csv", ".parquet")
COLUMNS = (
    "image", "status", "problem", "triangles", "vertices", "regions", "area", "image_area", "min_angle", "mean_q", "distance", "tolerance",
    "kept", "edge_length", "threshold", "threshold_from", "pixel_width", "pixel_height", "z", "seconds", "files",
    "image_sha256", "made_with", "files_sha256",
)  # fmt: skip
WHOLE, FAILED = "whole", "failed"


def facts(job: Job, mesh: TriangleMesh, seconds: float) -> dict[str, Any]:
    """Return the row of an image that was meshed; lengths and areas in world units, angles in degrees."""
    report, quality = mesh.report, mesh.quality().summary()
    settings = report.settings
    areas = report.areas.values()
    return {
        "image": job.image, "status": WHOLE, "triangles": report.n_triangles, "vertices": report.n_vertices,
        "regions": len(set(mesh.regions.tolist())), "area": sum(entry["mesh"] for entry in areas),
        "image_area": sum(entry["image"] for entry in areas), "min_angle": report.smallest_angle, "mean_q": quality["q"]["mean"],
        "distance": report.hausdorff, "tolerance": report.tolerance, "kept": report.kept, "edge_length": settings["edge_length"],
        "threshold": settings["threshold"], "threshold_from": settings["threshold_from"], "pixel_width": mesh.frame.spacing[0],
        "pixel_height": mesh.frame.spacing[1], "z": mesh.frame.z, "seconds": round(seconds, 3), "files": ";".join(job.files),
        "image_sha256": _sum([job.image]), "made_with": made_with(job), "files_sha256": _sum(job.files),
    }  # fmt: skip


def in_one_line(row: dict[str, Any]) -> str:
    """Say what an image became."""
    if row["status"] == FAILED:
        return f"{row['image']}: failed"
    counts = f"{row['triangles']:,} triangles, {row['vertices']:,} vertices"
    figures = f"worst angle {row['min_angle']:.2f}, mean q {row['mean_q']:.3f}, distance {row['distance']:.3g}, {row['seconds']:.2f} s"
    return f"{row['image']}: {counts}, {figures}{'' if row['kept'] else '; not all promises kept'}"


def made_with(job: Job) -> str:
    """Return the hash of all that decides what is made of an image: version, options, files."""
    what = [__version__, job.options, job.meshes, job.plot, job.colour_by, job.report]
    return hashlib.sha256(json.dumps(what, default=str, sort_keys=True).encode()).hexdigest()


def _sum(paths: Sequence[str]) -> str:
    """Return the hash of files one after the other; empty where one is missing, or stdin."""
    total = hashlib.sha256()
    for path in paths:
        if path == DASH or not os.path.isfile(path):
            return ""
        with open(path, "rb") as file:
            total.update(hashlib.file_digest(file, "sha256").digest())
    return total.hexdigest()


def is_whole(job: Job, row: dict[str, Any] | None) -> bool:
    """Whether a job was done before: the same bytes with the same options, and its files are as they were written."""
    if row is None or row["status"] != WHOLE or row["made_with"] != made_with(job) or not row["files_sha256"]:
        return False
    return bool(row["image_sha256"]) and row["image_sha256"] == _sum([job.image]) and row["files_sha256"] == _sum(job.files)


def rows_of(path: str) -> dict[str, dict[str, Any]]:
    """Read the rows of a table that an earlier run left, by image; none where there is no table."""
    if not os.path.exists(path):
        return {}
    try:
        if path.lower().endswith(".parquet"):
            rows = _parquet().read_table(path).to_pylist()
        else:
            with open(path, encoding="utf-8", newline="") as file:
                rows = [row for row in csv.DictReader(file) if None not in row.values()]  # a row cut short is none
        return {row["image"]: row for row in rows if set(COLUMNS) <= set(row)}
    except (OSError, ValueError) as problem:
        raise FileError(f"--summary: expected the table of an earlier run in {path!r}, found what cannot be read ({problem})") from problem


class SummaryTable:
    """A table that grows row by row."""

    def __init__(self, path: str, before: dict[str, dict[str, Any]]) -> None:
        self.path, self.rows = path, dict(before)
        self.each = path.lower().endswith(".csv")
        if self.each:
            self._write(_lines([dict(zip(COLUMNS, COLUMNS, strict=True)), *self.rows.values()]), "w")

    def add(self, outcome: Outcome) -> None:
        """Add the row of an image."""
        row = outcome.row or {"image": outcome.image, "status": FAILED, "problem": outcome.problem}
        self.rows[outcome.image] = row
        if self.each:
            self._write(_lines([row]), "a")

    def close(self) -> None:
        """Write the rows of a table that cannot grow."""
        if self.each:
            return
        import pyarrow

        from img2tri.views.formats.atomic_write import store, writable

        rows = [{name: row.get(name) for name in COLUMNS} for row in self.rows.values()]
        lengths = [row["edge_length"] for row in rows]
        for row, length in zip(rows, lengths, strict=True):
            row["edge_length"] = None if isinstance(length, str) else length  # a field has no one length
        buffer = io.BytesIO()
        _parquet().write_table(pyarrow.Table.from_pylist(rows), buffer)
        store(writable(self.path, TABLES), buffer.getvalue())

    def _write(self, text: str, mode: str) -> None:
        try:
            with open(self.path, mode, encoding="utf-8", newline="") as file:
                file.write(text)
        except OSError as problem:
            raise FileError(f"--summary: {self.path!r} cannot be written: {problem.strerror or problem}") from problem


@contextmanager
def summary_table(path: str | None, before: dict[str, dict[str, Any]]) -> Iterator[SummaryTable | None]:
    """Open a table, if one was asked for; what it has when the work ends, however that is, stays."""
    if path is None:
        yield None
        return
    table = SummaryTable(path, before)
    try:
        yield table
    finally:
        table.close()


def check_summary(path: str | None, resume: bool, jobs: Sequence[Job]) -> list[Job]:
    """See that a table can be written, and return the jobs with it in mind."""
    if path is None:
        if resume:
            raise ParameterError("--resume: expected with --summary, the table that says what is whole, found none")
        return list(jobs)
    from img2tri.views.formats.atomic_write import writable

    writable(path, TABLES)
    if path.lower().endswith(".parquet"):
        _parquet()
    taken = {os.path.realpath(name) for job in jobs for name in (job.image, *job.files)}
    if os.path.realpath(path) in taken:
        raise FileError(f"--summary: expected a file of its own, found {path!r}, which is in use")
    return [replace(job, summary=True) for job in jobs]


def _lines(rows: Sequence[dict[str, Any]]) -> str:
    text = io.StringIO()
    csv.DictWriter(text, COLUMNS, restval="", lineterminator="\n").writerows(rows)
    return text.getvalue()


def _parquet() -> Any:
    try:
        import pyarrow.parquet
    except ImportError as missing:
        raise ParameterError(f"--summary: a .parquet needs pyarrow ({missing}): pip install pyarrow, or name a .csv") from missing
    return pyarrow.parquet
