"""What the site is made of besides its pages: examples as gallery scripts, docstrings as an API reference, pictures."""

from __future__ import annotations

import ast
import importlib
import inspect
import pkgutil
import re
import shutil
from pathlib import Path
from types import ModuleType
from typing import Any

import img2tri

ROOT = Path(__file__).resolve().parent.parent
# The rooms in the order of the flow, and what they are called in the reference.
ROOMS = {
    "raster": "Image to labels",
    "shapes": "Labels to outlines",
    "triangles": "Points to triangles",
    "recipes": "Recipes",
    "certificate": "Certificate",
    "views": "Views: objects, files, figures, pages",
    "paper": "The paper",
    "options": "Options",
    "app": "App and notebook",
}
# Examples that only print: a picture of what they compute on.
LOOK = {
    "03_extrude_to_stl": 'img2tri.mesh_image(DATA / "gear.png", edge_length=12, corners="keep").plot(DATA / "gear.png", "{out}/gear.png")',
    "06_poisson_on_a_disc": 'img2tri.mesh_image(disc(CENTRES[0]), edge_length=20).plot(disc(CENTRES[0]), "{out}/disc.png")',
    "08_effective_conductivity": (
        "places = np.stack(np.meshgrid(np.arange(SIZE) + 0.5, SIZE - 0.5 - np.arange(SIZE)), axis=-1).reshape(-1, 2)\n"
        "image = polycrystal(places, 0).reshape(SIZE, SIZE)\n"
        'img2tri.mesh_image(image, labels=True, background=None, edge_length=8).plot(path="{out}/grains.png", colour_by="region")'
    ),
    "12_solid_in_trame": (
        'grains = np.asarray(Image.open(DATA / "polycrystal.png"))[:200, :200]\n'
        'img2tri.mesh_image(grains, labels=True, background=None, edge_length=12).plot(path="{out}/grains.png", colour_by="region")'
    ),
    "13_labels_in_napari": (
        'labels = np.asarray(Image.open(DATA / "polycrystal.png"))[:160, :240]\n'
        'img2tri.mesh_image(labels, labels=True, background=None, edge_length=10).plot(path="{out}/labels.png", colour_by="region")'
    ),
}


def everything(here: Path) -> None:
    """Make all sources in ``made/``, anew."""
    made = here / "made"
    for name in ("examples", "api", "static"):
        shutil.rmtree(made / name, ignore_errors=True)
        (made / name).mkdir(parents=True)
    examples(made / "examples")
    reference(made / "api")
    (made / "glossary.rst").write_text(glossary(), encoding="utf-8")
    shutil.copytree(ROOT / "data", made / "data", dirs_exist_ok=True)  # where the examples look for it
    for picture in (ROOT / "data" / "pictures").iterdir():
        shutil.copy(picture, made / "static" / picture.name)


# ---- examples ----


def examples(folder: Path) -> None:
    """Write each example as a script of sphinx-gallery: a title, its words, its code, and a call of its `main`."""
    about = "Every example runs when this site is made; its pictures are drawn then."
    (folder / "README.rst").write_text(f"Examples\n========\n\n{about}\n", encoding="utf-8")
    for path in sorted((ROOT / "examples").glob("[0-9]*.py")):
        script = gallery_script(path.read_text(encoding="utf-8"), path.stem)
        (folder / path.name).write_text(script, encoding="utf-8")


def gallery_script(text: str, stem: str) -> str:
    """Turn the text of an example into a script of sphinx-gallery."""
    tree = ast.parse(text)
    first, _, rest = (ast.get_docstring(tree) or stem).partition("\n\n")
    title, more = [*re.split(r"\. |(?<=\S): ", first.replace("\n", " "), maxsplit=1), ""][:2]
    title, more = title.rstrip(".:"), more.strip()
    # Indented lines are code.
    rest = re.sub(r"(?<=[^:\n])\n\n(?=    )", "\n\n.. code-block:: text\n\n", "\n\n" + rest).strip("\n")
    words = f"{more[:1].upper()}{more[1:]}\n\n{rest}".replace("|", "\\|")
    lines = text.splitlines()
    body = "\n".join(lines[tree.body[0].end_lineno : tree.body[-1].lineno - 1]).strip()  # without docstring and the last `if`
    body = re.sub(r"Path\(__file__\)(\.resolve\(\))?\.parent\.parent", 'Path("..").resolve()', body)  # scripts of a gallery have no name
    look = LOOK.get(stem, "").replace("{out}", f"out/{stem}")
    return f'r"""\n{title}\n{"=" * len(title)}\n\n{words}\n"""\n\n{body}\n\n# %%\n# Run it:\n\nnumbers = main("out/{stem}")\n{look}\n'


def pictures(_block: Any, variables: dict[str, Any], gallery: dict[str, Any], **_options: Any) -> str:
    """Show the pictures an example has saved: a scraper of sphinx-gallery."""
    from sphinx_gallery.scrapers import figure_rst

    found = []
    out = Path("out") / Path(variables["src_file"]).stem
    out.mkdir(parents=True, exist_ok=True)
    for path in sorted([*out.glob("*.png"), *out.glob("*.gif")]):
        target = Path(str(next(variables["image_path_iterator"])))
        shutil.copy(path, target)
        path.unlink()
        found.append(str(target))
    return figure_rst(found, gallery["src_dir"])


# ---- reference ----


def reference(folder: Path) -> None:
    """Write a page for each room, with every public function and class of its modules, and one for what users import."""
    for room, title in ROOMS.items():
        text = [f"{title}\n{'=' * len(title)}\n", *map(module_text, modules(f"img2tri.{room}"))]
        (folder / f"{room}.rst").write_text("\n".join(text), encoding="utf-8")
    about = "What users import is on the first page; the others go by stage, in the order of the flow."
    rooms = "\n".join(f"   {room}" for room in ("public", *ROOMS))
    (folder / "index.rst").write_text(f"Reference\n=========\n\n{about}\n\n.. toctree::\n   :maxdepth: 1\n\n{rooms}\n", encoding="utf-8")
    (folder / "public.rst").write_text(public(), encoding="utf-8")


def public() -> str:
    """Describe what ``import img2tri`` offers."""
    text = ["What users import\n=================\n"]
    for name in sorted(img2tri.__all__, key=lambda name: (inspect.isclass(getattr(img2tri, name)), name)):
        kind = "autoclass" if inspect.isclass(getattr(img2tri, name)) else "autofunction"
        text.append(f"{name}\n{'-' * len(name)}\n\n.. {kind}:: img2tri.{name}\n" + ("   :members:\n" if kind == "autoclass" else ""))
    return "\n".join(text)


def modules(name: str) -> list[ModuleType]:
    """Import all modules below one."""
    listed = pkgutil.walk_packages(importlib.import_module(name).__path__, name + ".")
    return [importlib.import_module(info.name) for info in listed if not info.ispkg]


def module_text(module: ModuleType) -> str:
    """Describe a module: its docstring as text, and its public functions and classes."""
    name = module.__name__.removeprefix("img2tri.")
    text = f"\n{name}\n{'-' * len(name)}\n\n.. code-block:: text\n\n" + "".join(
        f"   {line}".rstrip() + "\n" for line in (inspect.getdoc(module) or "").splitlines()
    )
    own = [value for key, value in vars(module).items() if not key.startswith("_") and getattr(value, "__module__", "") == module.__name__]
    for value in own:
        if inspect.isfunction(value) or inspect.isclass(value):
            kind = "autofunction" if inspect.isfunction(value) else "autoclass"
            text += f"\n.. {kind}:: {module.__name__}.{value.__name__}\n   :no-index:\n"
    return text


def glossary() -> str:
    """Take the words one has to know from the docstring of the package."""
    words = inspect.getdoc(img2tri) or ""
    listed = words.partition("The words one has to know:")[2].partition("\n\n")[2].partition("\n\n")[0]
    text = "Words\n=====\n\n.. glossary::\n"
    for line in listed.splitlines():
        begins = re.match(r"    (\S.*?)  +(.*)", line)
        text += f"\n   {begins[1]}\n      {begins[2]}\n" if begins else f"      {line.strip()}\n"
    text = text.replace("*", "")
    return text + "\n"
