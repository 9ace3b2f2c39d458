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


def everything(here: Path) -> None:
    """Make all sources in ``made/``, anew."""
    made = here / "made"
    for name in ("examples", "api", "static"):
        shutil.rmtree(made / name, ignore_errors=True)
        (made / name).mkdir(parents=True)
    examples(made / "examples")
    reference(made / "api")
    (made / "glossary.rst").write_text(glossary(), encoding="utf-8")
    for picture in (ROOT / "data" / "pictures").iterdir():
        shutil.copy(picture, made / "static" / picture.name)


# ---- examples ----


def examples(folder: Path) -> None:
    """Write each example as a script of sphinx-gallery: a title, its words, its code, and a call of its `main`."""
    (folder / "README.rst").write_text("Examples\n========\n\nEvery example runs when this site is made; its pictures are drawn then.\n", encoding="utf-8")
    for path in sorted((ROOT / "examples").glob("[0-9]*.py")):
        (folder / path.name).write_text(gallery_script(path.read_text(encoding="utf-8"), path.stem), encoding="utf-8")


def gallery_script(text: str, stem: str) -> str:
    """Turn the text of an example into a script of sphinx-gallery."""
    tree = ast.parse(text)
    words = ast.get_docstring(tree) or stem
    first, _, rest = words.partition("\n\n")
    title, _, more = first.replace("\n", " ").partition(". ") if ". " in first else first.replace("\n", " ").partition(": ")
    title = title.rstrip(".:")
    lines = text.splitlines()
    body = "\n".join(lines[tree.body[0].end_lineno : tree.body[-1].lineno - 1]).strip()  # without docstring and the last `if`
    body = body.replace("Path(__file__).resolve().parent.parent", f"Path({str(ROOT)!r})").replace("Path(__file__).parent.parent", f"Path({str(ROOT)!r})")
    more = more.strip()
    more = more[:1].upper() + more[1:]
    about = f'"""\n{title}\n{"=" * len(title)}\n\n{more}\n\n{_literal(rest)}\n"""'
    return f'{about}\n\n{body}\n\n# %%\n# Run it:\n\nnumbers = main("out/{stem}")\n'


def _literal(words: str) -> str:
    """Keep indented lines as they are: before them a paragraph ends in two colons."""
    return re.sub(r"(?<=[^:\n])\n\n(?=    )", "\n\n::\n\n", "\n\n" + words).strip("\n").replace("\n\n::\n\n    ", "\n\n.. code-block:: text\n\n    ")


def pictures(_block: Any, variables: dict[str, Any], gallery: dict[str, Any], **_options: Any) -> str:
    """Show the pictures an example has saved: a scraper of sphinx-gallery."""
    from sphinx_gallery.scrapers import figure_rst

    folder = Path(variables["example_globals"].get("__file__") or "").parent
    found = []
    out = Path("out") / Path(variables["src_file"]).stem
    for path in sorted([*out.glob("*.png"), *out.glob("*.gif")]):
        target = Path(str(next(variables["image_path_iterator"])))
        shutil.copy(path, target)
        path.unlink()
        found.append(str(target))
    del folder
    return figure_rst(found, gallery["src_dir"])


# ---- reference ----


def reference(folder: Path) -> None:
    """Write a page for each room, with every public function and class of its modules, and one for what users import."""
    for room, title in ROOMS.items():
        text = [f"{title}\n{'=' * len(title)}\n", f".. currentmodule:: img2tri.{room}\n"]
        for module in modules(f"img2tri.{room}"):
            text.append(module_text(module))
        (folder / f"{room}.rst").write_text("\n".join(text), encoding="utf-8")
    rooms = "\n".join(f"   {room}" for room in ROOMS)
    (folder / "index.rst").write_text(
        "Reference\n=========\n\nWhat users import from `img2tri` is on the first page; the others go by stage, in the order of the flow.\n\n"
        f".. toctree::\n   :maxdepth: 1\n\n   public\n{rooms}\n",
        encoding="utf-8",
    )
    (folder / "public.rst").write_text(public(), encoding="utf-8")


def public() -> str:
    """Describe what ``import img2tri`` offers."""
    text = ["What users import\n=================\n"]
    for name in sorted(img2tri.__all__, key=lambda name: (inspect.isclass(getattr(img2tri, name)), name)):
        kind = "autoclass" if inspect.isclass(getattr(img2tri, name)) else "autofunction"
        text.append(f"{name}\n{'-' * len(name)}\n\n.. {kind}:: img2tri.{name}\n" + ("   :members:\n" if kind == "autoclass" else ""))
    return "\n".join(text)


def modules(name: str) -> list[ModuleType]:
    """Import all modules below one, but those that need what may not be installed."""
    found = []
    for info in pkgutil.walk_packages(importlib.import_module(name).__path__, name + "."):
        if not info.ispkg:
            found.append(importlib.import_module(info.name))
    return found


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
        name, meaning = line[4:18].strip(), line[18:].strip()
        text += (f"\n   {name}\n      " if name else "\n      ") + meaning.replace("*", "")
    return text + "\n"
