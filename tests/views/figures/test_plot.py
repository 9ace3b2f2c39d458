from __future__ import annotations

import io
import sys

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib.collections import LineCollection, PolyCollection
from oracles import angles, edge_counts, interfaces
from PIL import Image
from views.plates import cells, ring, strip

from img2tri.errors import FileError, MeshError, ParameterError
from img2tri.types import Frame
from img2tri.views.figures.plot import SUFFIXES, draw
from img2tri.views.figures.region_colours import palette


def drawn(figure, kind):
    return [artist for artist in figure.axes[0].collections if isinstance(artist, kind)]


def pixel_at(figure, x, y):
    """The colour the figure shows at a place in the world."""
    figure.canvas.draw()
    column, row = figure.axes[0].transData.transform((x, y))
    shown = np.asarray(figure.canvas.buffer_rgba())
    return shown[round(len(shown) - row), round(column), :3].astype(int)


def test_by_default_red_edges_each_once():
    figure = draw(*ring())
    (lines,) = drawn(figure, LineCollection)
    assert not drawn(figure, PolyCollection)
    assert len(lines.get_segments()) == len(edge_counts(ring()[1])[0])
    red, green, blue, _ = lines.get_edgecolor()[0]
    assert red > 0.8 > 0.2 > max(green, blue)


def test_coloured_by_quality_on_a_fixed_scale():
    vertices, triangles = ring()
    values = np.linspace(0.4, 0.9, len(triangles))
    figure = draw(vertices, triangles, values=values, colour_by="quality", label="mine")
    (faces,) = drawn(figure, PolyCollection)
    assert np.array_equal(faces.get_array(), values)
    assert faces.get_clim() == (0, 1)
    assert np.array_equal([path.vertices[:3] for path in faces.get_paths()], vertices[triangles])
    _, bar, histogram = figure.axes
    assert bar.get_title(loc="left") == "mine"
    assert bar.get_ylim() == histogram.get_ylim() == (0, 1)
    assert "worst 0.400" in histogram.get_title(loc="left")
    assert sum(patch.get_width() for patch in histogram.patches) == pytest.approx(100)


def test_quality_is_computed_where_none_is_given():
    vertices, triangles, _ = strip()
    (faces,) = drawn(draw(vertices, triangles, colour_by="quality"), PolyCollection)
    p = vertices[triangles]
    a, b, c = (np.linalg.norm(p[:, k] - p[:, k - 1], axis=1) for k in range(3))
    s = (a + b + c) / 2
    area = np.sqrt(s * (s - a) * (s - b) * (s - c))
    heron = 2 * (area / s) / (a * b * c / (4 * area))  # 2 r / R
    assert np.asarray(faces.get_array()) == pytest.approx(heron, rel=1e-12)


def test_values_that_are_no_numbers_are_drawn_as_the_worst():
    vertices, triangles = ring()
    (faces,) = drawn(draw(vertices, triangles, values=np.full(24, np.nan), colour_by="quality"), PolyCollection)
    assert set(faces.get_array()) == {0}


def test_coloured_by_region_with_a_legend_and_strong_interfaces():
    vertices, triangles, regions = strip()
    figure = draw(vertices, triangles, regions=regions, colour_by="region")
    (faces,) = drawn(figure, PolyCollection)
    assert np.array_equal(np.round(255 * faces.get_facecolor()[:, :3]), palette(2)[(regions == 7).astype(int)])
    (legend,) = figure.legends
    assert [text.get_text() for text in legend.get_texts()] == ["3", "7"]
    _, borders = drawn(figure, LineCollection)
    outer = (edge_counts(triangles)[1] == 1).sum()
    assert len(borders.get_segments()) == outer + len(interfaces(triangles, regions))


def test_regions_have_their_names_and_the_axes_their_unit():
    vertices, triangles, regions = strip()
    figure = draw(vertices, triangles, regions=regions, colour_by="region", names={7: "cortical bone"}, unit="mm")
    assert [text.get_text() for text in figure.legends[0].get_texts()] == ["3", "cortical bone"]
    assert figure.axes[0].get_xlabel() == "mm"
    figure.canvas.draw()
    assert figure.legends[0].get_window_extent().x1 <= figure.bbox.x1


def test_of_many_regions_the_largest_are_named_where_they_lie():
    vertices, triangles = cells(np.ones((4, 13), bool))
    regions = np.arange(104) // 4
    regions[:40] = 0
    figure = draw(vertices, triangles, regions=regions, colour_by="region", names={0: "matrix"})
    assert figure.legends == []
    words = figure.axes[0].texts
    assert len(words) == 12
    assert words[0].get_text() == "matrix"
    for word in words:
        label = {"matrix": 0}.get(word.get_text()) or int(word.get_text().replace("matrix", "0"))
        middles = vertices[triangles[regions == label]].mean(axis=1)
        assert np.abs(middles - word.get_position()).sum(axis=1).min() < 1e-9  # inside, in one of its triangles


@pytest.mark.parametrize("colour_by", [None, "quality", "region"])
def test_axes_of_others_are_drawn_in(colour_by):
    from matplotlib.figure import Figure

    vertices, triangles, regions = strip()
    mine = Figure()
    left, right = mine.subplots(1, 2)
    assert draw(vertices, triangles, regions=regions, colour_by=colour_by, ax=right, image=np.eye(3)) is mine
    assert mine.axes == [left, right]
    assert not left.collections
    assert right.collections
    assert len(right.images) == 1
    assert (right.get_legend() is not None) == (colour_by == "region")


def test_a_notebook_shows_a_figure_by_itself():
    data = draw(*ring())._repr_png_()
    with Image.open(io.BytesIO(data)) as read:
        assert min(read.size) > 200


def test_the_histogram_of_angles():
    vertices, triangles, _ = strip()
    figure = draw(vertices, triangles)
    smallest = angles(vertices, triangles).min(axis=1)
    _, histogram = figure.axes
    assert f"worst {smallest.min():.1f}°" in histogram.get_title(loc="left")
    assert f"mean {smallest.mean():.1f}°" in histogram.get_title(loc="left")
    assert histogram.get_ylim() == (0, 60)
    assert len(draw(vertices, triangles, histogram=False).axes) == 1
    assert len(draw(vertices, triangles, histogram=False, colour_by="quality").axes) == 2


def test_the_title_states_counts_and_worst_angle():
    vertices, triangles, _ = strip()
    smallest = angles(vertices, triangles).min()
    assert draw(vertices, triangles).get_suptitle() == f"14 vertices · 12 triangles · smallest angle {smallest:.1f}°"
    triangles[0] = triangles[0, ::-1]
    assert draw(vertices, triangles).get_suptitle().endswith(" · 1 turned over")
    assert draw(vertices, triangles, title="A plate").get_suptitle() == "A plate"


@pytest.mark.parametrize("upward", [True, False])
def test_each_pixel_of_the_image_is_drawn_where_the_frame_says(upward):
    image = np.zeros((3, 5), np.uint8)
    image[0, 1], image[2, 4] = 200, 200
    frame = Frame((3, 5), spacing=(2.0, 3.0), corner=(10.0, -4.0), upward=upward)
    figure = draw([[10, -4], [10.01, -4], [10, -3.99]], [[0, 1, 2]], image=image, frame=frame)
    rows, columns = np.indices((3, 5))
    for r, c in zip(rows.ravel(), columns.ravel(), strict=True):
        x, y = frame.xy(r + 0.5, c + 0.5)
        assert np.all(pixel_at(figure, x, y) == (255 if image[r, c] else 0)), (r, c)
    # Row 0 is at the top of the page either way.
    _, top = frame.xy(0, 0)
    assert figure.axes[0].get_ylim()[1] == top
    left, bottom, right, high = frame.bounds
    assert figure.axes[0].get_xlim() == (left, right)
    assert sorted(figure.axes[0].get_ylim()) == [bottom, high]
    assert figure.axes[0].get_aspect() == 1


def test_a_large_image_is_thinned_and_stays_in_place():
    image = np.zeros((30, 5001), bool)
    image[:, 4000:] = True
    figure = draw([[0, 0], [1, 0], [0, 1]], [[0, 1, 2]], image=image)
    (shown,) = figure.axes[0].images
    assert shown.get_array().shape == (10, 1667)
    assert np.all(pixel_at(figure, 3950, 15) == 0)
    assert np.all(pixel_at(figure, 4050, 15) == 255)


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16, np.float32])
def test_colour_images_keep_their_colours(dtype):
    most = 1 if dtype is np.float32 else np.iinfo(dtype).max
    image = np.zeros((2, 2, 3), dtype)
    image[..., 1] = most
    figure = draw([[0, 0], [0.01, 0], [0, 0.01]], [[0, 1, 2]], image=image)
    assert pixel_at(figure, 1.5, 1.5).tolist() == [0, 255, 0]


def test_the_image_is_faint_behind_coloured_triangles():
    image = np.zeros((4, 4), bool)
    figure = draw([[0, 0], [1, 0], [0, 1]], [[0, 1, 2]], image=image, colour_by="quality")
    assert pixel_at(figure, 3, 3).min() > 150


@pytest.mark.parametrize("image", [np.full((4, 4), np.nan), np.full((4, 4), 7), np.ones((4, 4), bool), np.zeros((4, 4, 4))])
def test_images_without_any_contrast_are_drawn(image):
    assert draw([[0, 0], [1, 0], [0, 1]], [[0, 1, 2]], image=image).axes[0].images


@pytest.mark.parametrize("colour_by", [None, "quality", "region"])
def test_every_kind_of_file_is_the_same_each_time(tmp_path, colour_by):
    vertices, triangles, regions = strip()
    image = np.arange(12).reshape(2, 6)
    starts = {".png": b"\x89PNG", ".svg": b"<?xml", ".pdf": b"%PDF"}
    assert set(starts) == set(SUFFIXES)
    for suffix, start in starts.items():
        written = []
        for name in ("a", "b"):
            path = tmp_path / f"{name}{suffix}"
            draw(vertices, triangles, regions=regions, image=image, colour_by=colour_by, path=path)
            written.append(path.read_bytes())
        assert written[0] == written[1]
        assert written[0].startswith(start)
        assert b"Date" not in written[0]
        assert b"<dc:date>" not in written[0]
    assert len(list(tmp_path.iterdir())) == 6


def test_the_options_change_the_picture(tmp_path):
    vertices, triangles, regions = strip()

    def written(**options):
        draw(vertices, triangles, **options, path=tmp_path / "a.png")
        return (tmp_path / "a.png").read_bytes()

    options = [
        {},
        {"colour_by": "quality"},
        {"colour_by": "quality", "values": np.full(12, 0.5)},
        {"colour_by": "quality", "label": "mine"},
        {"colour_by": "region"},
        {"colour_by": "region", "regions": regions},
        {"image": np.eye(3)},
        {"frame": Frame((3, 3))},
        {"histogram": False},
        {"title": "A plate"},
    ]
    assert len({written(**option) for option in options}) == len(options)


@pytest.mark.parametrize("shape", [(1, 400), (400, 1), (3, 300), (300, 3)])
def test_long_images_leave_room_for_everything(shape):
    vertices, triangles = cells(np.ones(shape, bool))
    figure = draw(vertices, triangles, frame=Frame(shape), image=np.ones(shape), colour_by="quality")
    figure.canvas.draw()
    width, height = figure.get_size_inches()
    assert 4 < width < 11
    assert 3 < height < 9
    title = figure._suptitle.get_window_extent()
    inside = figure.bbox
    for box in [title, *(axes.get_tightbbox() for axes in figure.axes)]:
        assert inside.x0 <= box.x0 < box.x1 <= inside.x1
        assert inside.y0 <= box.y0 < box.y1 <= inside.y1
    assert not any(title.overlaps(axes.get_tightbbox()) for axes in figure.axes)


def test_large_meshes_are_pixels_in_vector_files(tmp_path):
    vertices, triangles = cells(np.ones((110, 110), bool))
    figure = draw(vertices, triangles, colour_by="quality", path=tmp_path / "a.svg")
    assert all(artist.get_rasterized() for artist in figure.axes[0].collections)
    assert (tmp_path / "a.svg").stat().st_size < 2e6  # as lines, 10 MB
    assert not drawn(draw(*ring()), LineCollection)[0].get_rasterized()


def test_nothing_global_of_matplotlib_is_changed(tmp_path):
    before = dict(mpl.rcParams)
    draw(*ring(), path=tmp_path / "a.svg")
    assert dict(mpl.rcParams) == before
    if "matplotlib.pyplot" in sys.modules:
        assert sys.modules["matplotlib.pyplot"].get_fignums() == []


def test_a_figure_that_cannot_be_drawn_leaves_the_old_file(tmp_path, monkeypatch):
    path = tmp_path / "a.png"
    draw(*ring(), path=path)
    whole = path.read_bytes()
    Image.open(io.BytesIO(whole)).verify()

    def fail(*_args, **_options):
        raise RuntimeError("half-way")

    monkeypatch.setattr("matplotlib.figure.Figure.savefig", fail)
    with pytest.raises(RuntimeError, match="half-way"):
        draw(*strip()[:2], path=path)
    assert path.read_bytes() == whole
    assert list(tmp_path.iterdir()) == [path]


def test_what_cannot_be_drawn_is_refused(tmp_path):
    with pytest.raises(ParameterError, match="colour_by: expected one of 'quality', 'region', found 'mood'"):
        draw(*ring(), colour_by="mood")
    with pytest.raises(MeshError, match="values: expected one number for each of 24 triangles"):
        draw(*ring(), values=[1])
    with pytest.raises(MeshError, match="regions: expected one number for each of 24 triangles"):
        draw(*ring(), regions=[1])
    with pytest.raises(MeshError, match="triangles: expected indices"):
        draw([[0, 0]], [[0, 1, 2]])
    for image in (np.zeros(3), np.zeros((3, 3, 2)), np.zeros((0, 3)), [["a"]], np.zeros((2, 2), complex)):
        with pytest.raises(ParameterError, match=r"image: expected shape \(h, w\), \(h, w, 3\) or \(h, w, 4\), found"):
            draw(*ring(), image=image)
    with pytest.raises(FileError, match=r"a\.gif: expected a name that ends in \.pdf, \.png or \.svg, found '\.gif'"):
        draw(*ring(), path=tmp_path / "a.gif")
    with pytest.raises(FileError, match="expected an existing folder"):
        draw(*ring(), path=tmp_path / "none" / "a.png")
