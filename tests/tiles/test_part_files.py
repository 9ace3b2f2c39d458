"""Parts in files: whoever writes them, whenever, once or twice, the bytes are the same; each has its report."""

from __future__ import annotations

import json

import numpy as np
import pytest
from scipy import ndimage

from img2tri import FileError, load, mesh_image, mesh_tiles
from img2tri.tiles import block_plan, run_tasks
from img2tri.tiles import mesh_tiles as module
from img2tri.tiles.parts.part_files import FORMATS

MASK = ndimage.gaussian_filter(np.random.default_rng(0).standard_normal((200, 220)), 8) > 0


@pytest.fixture(autouse=True)
def small(monkeypatch):
    """Four blocks, each a part."""
    monkeypatch.setattr(block_plan, "BLOCK_SIDE", 128)


def files(folder):
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}


@pytest.mark.parametrize("suffix", FORMATS)
def test_the_bytes_do_not_depend_on_who_writes_when_and_how_often(suffix, tmp_path, monkeypatch):
    (tmp_path / "one").mkdir()
    (tmp_path / "other").mkdir()
    mesh_tiles(MASK, tmp_path / "one" / f"mesh{suffix}", tile=128, edge_length=4.0)

    def backwards(client, stage, function, tasks, shared, share):
        if stage == "save":  # by workers of which one is thought lost, but was only slow
            tasks = dict(reversed(tasks.items()))
            list(run_tasks.done(client, stage, function, tasks, shared, share))
        return run_tasks.done(client, stage, function, tasks, shared, share)

    monkeypatch.setattr(module, "done", backwards)
    mesh_tiles(MASK, tmp_path / "other" / f"mesh{suffix}", tile=128, edge_length=4.0)
    one, other = files(tmp_path / "one"), files(tmp_path / "other")
    assert len(one) >= 1
    assert one == other


def test_each_part_has_its_report_and_so_has_each_block_before_the_end(tmp_path):
    import zarr

    seen = {}

    def look(stage, _):
        if stage == "seams":
            found = (tmp_path / ".mesh.zarr.work").glob("report-*.json")
            seen.update({path.name: json.loads(path.read_text()) for path in found})

    made = mesh_tiles(MASK, tmp_path / "mesh.zarr", tile=128, edge_length=4.0, progress=look)
    assert sorted(seen) == ["report-0-0.json", "report-0-1.json", "report-1-0.json", "report-1-1.json"]
    assert all(report["smallest_angle"] >= 30 and report["distance"] <= 0.5 for report in seen.values())
    parts = [dict(part.attrs) for _, part in zarr.open_group(made.path, mode="r")["parts"].groups()]
    assert len(parts) == 4
    assert sum(part["n_triangles"] for part in parts) == made.n_triangles
    assert min(part["smallest_angle"] for part in parts) == made.report["smallest_angle"]


class Forgetful:
    """A client of a cluster that forgets some of what it is asked for the first time."""

    def __init__(self):
        self.asked, self.scattered, self.keys = 0, 0, set()

    def scatter(self, shared, **_):
        self.scattered += 1
        if self.scattered == 1:
            raise OSError("a worker is gone")
        return shared

    def submit(self, function, *given, key, **_):
        assert key not in self.keys
        self.keys.add(key)
        self.asked += 1
        return Answer(function(*given), lost=self.asked == 2)

    def cancel(self, futures):
        pass


class Answer:
    def __init__(self, value, *, lost):
        self.value, self.lost = value, lost

    def cancelled(self):
        return self.lost

    def result(self):
        return self.value


def test_what_a_cluster_forgets_is_asked_for_again(monkeypatch):
    distributed = pytest.importorskip("distributed")
    monkeypatch.setattr(distributed, "as_completed", lambda futures, timeout: iter(futures))
    client = Forgetful()
    found = dict(run_tasks.done(client, "double", lambda factor, n: factor * n, {"a": 1, "b": 2, "c": 3}, (2,), lambda _: None))
    assert found == {"a": 2, "b": 4, "c": 6}
    assert client.asked == 4


@pytest.mark.parametrize("suffix", FORMATS)
def test_load_reads_the_whole_with_its_frame(suffix, tmp_path):
    options = {"edge_length": 2.0, "spacing": (0.5, 0.25), "origin": (3, 4)}
    made = mesh_tiles(MASK, tmp_path / f"mesh{suffix}", tile=128, **options)
    mesh = load(made.path)
    plain = mesh_image(MASK, blocks=True, **options)
    assert mesh.frame == plain.frame
    assert mesh.vertices.tobytes() == plain.vertices.tobytes()
    assert set(map(tuple, mesh.triangles)) == set(map(tuple, plain.triangles))
    assert mesh.sets().edges.keys() == plain.sets().edges.keys()


@pytest.mark.parametrize("name", ["none.zarr", "none.pvtu", "some.pvtu"])
def test_what_is_no_mesh_in_parts_is_told(name, tmp_path):
    (tmp_path / "some.pvtu").write_text("<VTKFile/>")
    with pytest.raises(FileError, match="expected a mesh made by mesh_tiles"):
        load(tmp_path / name)


@pytest.mark.parametrize("origin", ["lower", "upper"])
def test_the_overview_is_drawn_from_parts(origin, tmp_path):
    labels = np.where(MASK, 2, 0) + 5 * (np.mgrid[:200, :220][0] > 150)
    made = mesh_tiles(labels, tmp_path / "mesh.zarr", edge_length=4.0, labels=True, origin=origin, tile=128)
    assert made.labels.shape == made.angles.shape == (25, 28)
    assert np.nanmin(made.angles) == made.report["smallest_angle"]
    middle = labels[4::8][:, np.minimum(np.arange(4, 224, 8), 219)]
    clear = np.array([[len(np.unique(labels[i : i + 8, j : j + 8])) == 1 for j in range(0, 220, 8)] for i in range(0, 200, 8)])
    assert (made.labels[clear] == middle[clear]).all()
    assert (np.isnan(made.angles)[clear] == (middle == 0)[clear]).all()
    made.plot(tmp_path / "overview.png")
    assert (tmp_path / "overview.png").stat().st_size > 10_000
