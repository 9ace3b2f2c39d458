"""The site: ``sphinx-build -W .docs build/site`` makes all of it from docstrings, examples and the pages beside this file."""

from __future__ import annotations

import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))
sys.path.insert(0, str(HERE.parent))

import generate  # noqa: E402

import img2tri  # noqa: E402

generate.everything(HERE)

project, author = "img2tri", "the authors of img2tri"
version = release = img2tri.__version__
extensions = ["sphinx.ext.autodoc", "numpydoc", "sphinx_gallery.gen_gallery"]
exclude_patterns = ["made/examples/**", "made/data/**"]
default_role = "literal"  # single backticks name things of the code; docstrings link by numpydoc's See Also
html_theme = "pydata_sphinx_theme"
html_title = "img2tri"
html_static_path = ["made/static"]
html_show_sourcelink = False
html_theme_options = {"show_toc_level": 2, "navigation_with_keys": False, "secondary_sidebar_items": ["page-toc"]}
html_context = {"default_mode": "auto"}
html_sidebars = {"index": []}
autodoc_typehints = "none"  # numpydoc's sections have them
autodoc_member_order = "bysource"
numpydoc_show_class_members = False
numpydoc_xref_param_type = False
suppress_warnings = ["config.cache"]  # the scraper of pictures is a function
sphinx_gallery_conf = {
    "examples_dirs": "made/examples",
    "gallery_dirs": "made/gallery",
    "within_subsection_order": "FileNameSortKey",
    "filename_pattern": r"/\d\d_",
    "image_scrapers": (generate.pictures,),
    "reset_modules": (),
    "download_all_examples": False,
    "show_signature": False,
    "show_memory": False,
    "min_reported_time": 1,
    "write_computation_times": False,
    "remove_config_comments": True,
    "abort_on_example_error": True,
    "line_numbers": False,
}
