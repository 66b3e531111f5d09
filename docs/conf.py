"""Settings of the documentation: `python -m sphinx -W -n --keep-going docs build/docs`."""

import sys
from importlib.metadata import version as installed_version
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE / "_ext"))

project = "rocking-blocks"
author = copyright = "the rocking-blocks developers"
version = release = installed_version("rocking-blocks")

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx.ext.mathjax",
    "sphinx_copybutton",
    "sphinx_gallery.gen_gallery",
    "sphinxcontrib.bibtex",
    "offline_mathjax",
    "plain_docstrings",
    "made_text",
    "sign_drawings",
]

exclude_patterns = ["examples", "_ext", "gallery", "results", "sg_execution_times.rst", "*/sg_execution_times.rst"]
source_suffix = {".md": "markdown", ".rst": "restructuredtext"}
nitpicky = True
# Types of other projects; their inventories would need a network.
nitpick_ignore_regex = [
    ("py:.*", r"(np|numpy|npt|xr|xarray|matplotlib|jax|scipy|pathlib|collections|typing|enum|abc)\..*"),
    ("py:.*", r"(Any|ArrayLike|NDArray|Callable|Sequence|Mapping|Iterable|Path|optional|Literal.*|float64|int64)"),
]

myst_enable_extensions = ["dollarmath", "amsmath", "deflist", "colon_fence", "attrs_inline"]
myst_heading_anchors = 3
math_number_all = False
math_eqref_format = "({number})"
numfig = True
default_role = "code"
smartquotes_action = "q"  # two hyphens are an option of a command

autodoc_member_order = "bysource"
autodoc_typehints = "signature"
autodoc_typehints_format = "short"
autodoc_preserve_defaults = True
python_maximum_signature_line_length = 100
napoleon_google_docstring = True
napoleon_numpy_docstring = False
napoleon_use_rtype = False
napoleon_use_ivar = True
napoleon_custom_sections = [("Source", "notes_style")]

bibtex_bibfiles = ["references.bib"]
bibtex_default_style = "plain"
bibtex_reference_style = "author_year"

sphinx_gallery_conf = {
    "examples_dirs": "gallery",
    "gallery_dirs": "auto_gallery",
    "filename_pattern": r"plot_",
    "within_subsection_order": "FileNameSortKey",
    "abort_on_example_error": False,
    "remove_config_comments": True,
    "download_all_examples": False,
    "show_memory": False,
    "capture_repr": ("_repr_html_",),
    "matplotlib_animations": True,
    "reset_modules": ("matplotlib",),
    "min_reported_time": 5,
    "show_signature": False,
}

# For `python -m sphinx -b linkcheck -D plot_gallery=0 docs build/links`, which needs a network.
linkcheck_timeout = 20
linkcheck_retries = 2
linkcheck_workers = 4
linkcheck_anchors = False
linkcheck_ignore = [r"_images/.*"]  # of the pages themselves

html_theme = "furo"
html_title = f"rocking-blocks {version}"
html_static_path = ["_static"]
html_css_files = ["wide_tables.css"]
html_js_files = ["fit_equations.js"]
html_theme_options = {"navigation_with_keys": True}
html_copy_source = False
html_show_sourcelink = False
