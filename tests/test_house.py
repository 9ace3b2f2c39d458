"""The house keeps its order: who imports whom, which library lives where, what `import img2tri` costs, what lies about."""

from __future__ import annotations

import ast
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
import test_constants
from children import PATIENCE
from tuning import constants

import img2tri

PACKAGE = Path(img2tri.__file__).parent
ROOT = PACKAGE.parent
FILES = sorted(PACKAGE.rglob("*.py"))
ROOMS = ("raster", "shapes", "triangles", "views")
LONGEST = 300  # lines in a file
MOST_MODULES = 13  # in a folder
MAPS = sorted({path.parent for path in FILES})

# Lowest first; the modules of one row do not import each other.
ORDER = [
    {"errors"},
    {"scipy_kernels"},
    {"arrays"},
    {"types", "cell_lists", "triangle_angles"},
    set(ROOMS),
    {"paper"},
    {"recipes", "certificate"},
    {"options"},
    {"mesh_pictures"},
    {"mesh_exports"},
    {"tiles"},
    {"mesh"},
    {"pipeline"},
    {"many"},
    {"app"},
    {"cli"},
    {"__main__"},
]
FOLDERS = {*ROOMS, "paper", "recipes", "certificate", "options", "many", "tiles", "app", "cli"}  # their files may import each other
# numpy is at home everywhere.
LIBRARIES = {
    "scipy_kernels": {"scipy"},
    "raster": {"cv2", "PIL", "tifffile", "pydicom", "nibabel", "scipy", "h5py", "zarr"},  # scipy joins runs of pixels to components
    "shapes": {"shapely", "scipy", "cv2"},  # cv2 measures distances to the places where lengths are given
    "triangles": {"scipy", "igl", "pythoncdt", "shapely"},
    "views": {"shapely", "skfem", "trimesh", "pyvista", "vtkmodules", "matplotlib", "PIL"},  # PIL writes the pictures of pages
    "paper": {"cv2", "pythoncdt", "scipy", "shapely"},  # cv2 traces its contours
    "recipes": {"scipy"},
    "certificate": {"shapely", "scipy"},
    "mesh_pictures": {"matplotlib"},
    "tiles": {"scipy", "shapely", "zarr", "h5py", "tifffile", "distributed", "vtkmodules", "pyvista", "matplotlib"},
    "app": {"starlette", "uvicorn", "anywidget", "traitlets", "matplotlib"},
    "mesh_exports": {"skfem", "shapely", "trimesh", "pyvista"},  # for types only
    "mesh": {"matplotlib"},  # for types only
    "many": {"distributed"},
    "cli": {"rich", "distributed", "pyarrow"},
}
HEAVY = {"cv2", "PIL", "tifffile", "scipy", "shapely", "igl", "pythoncdt", "trimesh", "pyvista", "vtkmodules", "matplotlib", "rich"}
HEAVY |= {"starlette", "uvicorn", "anywidget", "zarr", "h5py", "dask", "distributed"}
ALLOWED = {"pyproject.toml", "README.md", "LICENSE", "img2tri", "tests", "examples", "data"}

in_checkout = pytest.mark.skipif(not (ROOT / "pyproject.toml").exists(), reason="only where the sources are checked out")


def tree(path):
    return ast.parse(path.read_text(encoding="utf-8"), str(path))


def house_name(path):
    """The row of `ORDER` a file belongs to: its folder, or its own name."""
    parts = path.relative_to(PACKAGE).with_suffix("").parts
    return parts[0]


def imported(nodes):
    """Names of the modules that are imported, with dots."""
    for node in nodes:
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, "imports are absolute"
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


def at_the_top(module):
    """Statements that run when a file is imported: not those in functions, nor those for the type checker alone."""
    waiting = list(module.body)
    while waiting:
        node = waiting.pop()
        for_types = isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING"
        if for_types or isinstance(node, ast.FunctionDef):
            continue
        yield node
        waiting += [child for child in ast.iter_child_nodes(node) if isinstance(child, ast.stmt)]


def own(names):
    return {name.split(".")[1] for name in names if name.startswith("img2tri.")}


def foreign(names):
    return {name.partition(".")[0] for name in names} - set(sys.stdlib_module_names) - {"img2tri", "numpy", "__future__"}


def test_the_list_of_rows_is_complete():
    assert {house_name(path) for path in FILES} == set().union(*ORDER) | {"__init__"}


@pytest.mark.parametrize("path", FILES, ids=lambda p: str(p.relative_to(PACKAGE)))
def test_a_file_imports_only_from_lower_rows_and_its_own_room(path):
    name = house_name(path)
    if name == "__init__":
        return  # it loads public names when they are asked for
    row = next(i for i, names in enumerate(ORDER) if name in names)
    allowed = set().union(*ORDER[:row]) | {"__version__"} | ({name} if name in FOLDERS else set())
    assert own(imported(ast.walk(tree(path)))) <= allowed


@pytest.mark.parametrize("path", FILES, ids=lambda p: str(p.relative_to(PACKAGE)))
def test_a_library_is_used_in_its_own_room(path):
    assert foreign(imported(ast.walk(tree(path)))) <= LIBRARIES.get(house_name(path), set())


@pytest.mark.parametrize("path", FILES, ids=lambda p: str(p.relative_to(PACKAGE)))
def test_large_libraries_are_loaded_when_used(path):
    assert not foreign(imported(at_the_top(tree(path)))) & {"trimesh", "pyvista", "vtkmodules", "matplotlib", "cv2", "tifffile", "rich"}


def modules_after(code):
    """Top-level names of what is loaded after `code` ran in a process of its own."""
    code += "; import sys; print(*{name.partition('.')[0] for name in sys.modules})"
    return set(subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.split())


def test_import_img2tri_loads_no_library():
    assert not modules_after("import img2tri; dir(img2tri)") & (HEAVY | {"numpy"})


def test_mesh_image_loads_no_view():
    code = "import numpy, img2tri; img2tri.mesh_image(numpy.eye(9, dtype=bool)).report"
    assert not modules_after(code) & {"trimesh", "pyvista", "vtkmodules", "matplotlib", "rich", "cv2", "PIL"}


def test_from_a_small_mask_to_a_file_no_package_of_scipy_is_loaded(tmp_path):
    code = "import numpy, sys, img2tri; mesh = img2tri.mesh_image(numpy.hypot(*numpy.mgrid[-20:20, -20:20]) < 15, edge_length=4); "
    code += f"mesh.save({str(tmp_path / 'mesh.stl')!r}); mesh.quality(); print(*[name for name in sys.modules if 'scipy.' in name])"
    found = modules_after(code)
    assert not found & {"scipy.sparse", "scipy.linalg", "scipy.spatial", "scipy.special", "scipy.ndimage"}
    assert not found & {"igl", "shapely", "trimesh", "pyvista", "vtkmodules", "matplotlib", "rich", "cv2", "PIL"}


def test_public_names_are_there_and_no_others():
    assert set(img2tri.__all__) <= set(dir(img2tri))
    assert all(getattr(img2tri, name).__module__.startswith("img2tri.") for name in img2tri.__all__)
    with pytest.raises(AttributeError, match="no attribute 'mesh_imagery'"):
        _ = img2tri.mesh_imagery


@pytest.mark.parametrize("path", FILES, ids=lambda p: str(p.relative_to(PACKAGE)))
def test_only_one_part_of_the_command_line_prints(path):
    calls = {node.func.id for node in ast.walk(tree(path)) if isinstance(node, ast.Call) and isinstance(node.func, ast.Name)}
    assert "print" not in calls or path == PACKAGE / "cli" / "printing.py"
    assert not calls & {"breakpoint", "input", "exit", "quit"}
    assert "logging" not in {name.partition(".")[0] for name in imported(ast.walk(tree(path)))}


@pytest.mark.parametrize("path", FILES, ids=lambda p: str(p.relative_to(PACKAGE)))
def test_every_file_says_what_it_is_for_and_is_short_enough_to_read(path):
    module = tree(path)
    assert ast.get_docstring(module)
    assert len(path.read_text(encoding="utf-8").splitlines()) <= LONGEST


def defined(path):
    """Public classes, functions and constants of a file."""
    for node in tree(path).body:
        if isinstance(node, ast.ClassDef | ast.FunctionDef):
            yield node.name
        elif isinstance(node, ast.Assign | ast.AnnAssign):
            targets = node.targets if isinstance(node, ast.Assign) else [node.target]
            yield from (leaf.id for target in targets for leaf in ast.walk(target) if isinstance(leaf, ast.Name) and leaf.id[0] != "_")


def test_one_name_means_one_thing():
    places = {}
    for path in FILES:
        for name in defined(path):
            if not name.startswith("_"):
                places.setdefault(name, []).append(str(path.relative_to(PACKAGE)))
    twice = {name: found for name, found in places.items() if len(found) > 1}
    assert not twice


def test_every_number_with_a_name_is_held_by_a_test_or_has_a_reason():
    placed = [*test_constants.TUNED, *test_constants.HELD, *test_constants.WHY]
    assert set(constants()) - set(placed) == set(), "say why in tests/test_constants.py, or show in a test_tuning.py that it matters"
    assert set(placed) - set(constants()) == set(), "there is no such constant"
    assert len(placed) == len(set(placed)), "in one place each"


@pytest.mark.parametrize("folder", MAPS, ids=lambda p: str(p.relative_to(PACKAGE.parent)))
def test_a_folder_is_small_and_has_a_map(folder):
    modules = [path.stem for path in folder.glob("[!_]*.py")]
    assert len(modules) <= MOST_MODULES
    folders = [path.parent.name for path in folder.glob("*/__init__.py")]
    text = ast.get_docstring(tree(folder / "__init__.py"))
    missing = [name for name in modules + folders if not re.search(rf"\b{name}\b", text)]
    assert not missing, missing


def test_nothing_is_drawn_from_a_global_source_of_chance():
    for path in FILES:
        attributes = [node for node in ast.walk(tree(path)) if isinstance(node, ast.Attribute)]
        used = {node.attr for node in attributes if ast.unparse(node.value) == "np.random"}
        assert used <= {"default_rng", "Generator"}, path
        assert "random" not in {name.partition(".")[0] for name in imported(ast.walk(tree(path)))}, path


@in_checkout
def test_the_top_level_holds_only_what_belongs_there():
    assert {path.name for path in ROOT.iterdir() if not path.name.startswith(".")} - {"dist", "build", "out"} <= ALLOWED


@in_checkout
def test_the_rooms_of_the_tests_mirror_the_package():
    assert {path.name for path in (ROOT / "tests").iterdir() if path.is_dir() and path.name != "__pycache__"} == {*FOLDERS, "benchmarks"}


def _run(tool, *arguments):
    program = shutil.which(tool, path=f"{Path(sys.executable).parent}:{Path(sys.exec_prefix) / 'bin'}") or shutil.which(tool)
    if program is None:
        pytest.skip(f"{tool} is not installed")
    done = subprocess.run([program, *arguments], cwd=ROOT, capture_output=True, text=True, check=False, timeout=PATIENCE)
    assert done.returncode == 0, done.stdout + done.stderr


@in_checkout
def test_ruff_finds_nothing():
    _run("ruff", "check", ".")
    _run("ruff", "format", "--check", ".")


@in_checkout
def test_mypy_finds_nothing():
    _run("mypy", "--python-executable", sys.executable)
