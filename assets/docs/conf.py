"""How Sphinx builds these pages: `./run docs` runs it, offline and with warnings as errors."""

import sys
from importlib.metadata import version as version_of
from pathlib import Path

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE))

from building.colours import style_sheet  # noqa: E402

project = "railjoule"
author = "the railjoule developers"
project_copyright = "2026, the railjoule developers"
version = release = version_of("railjoule")
language = "en"

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "building.formulas",
    "building.gallery",
    "building.docstrings",
    "building.generated",
]
exclude_patterns = ["building", "static", "templates", "paper"]

myst_enable_extensions = ["attrs_inline", "colon_fence", "dollarmath"]
myst_heading_anchors = 3
myst_links_external_new_tab = True
smartquotes = False

autodoc_typehints = "none"
autodoc_member_order = "bysource"
autodoc_default_options = {"exclude-members": "model_config"}
toc_object_entries = False
napoleon_google_docstring = False
napoleon_use_rtype = False

# MathML of docutils, which browsers draw by themselves: no script, no picture, no LaTeX
html_math_renderer = "mathml"
html_theme = "basic"
html_title = "railjoule"
html_static_path = ["static", "../fonts"]
html_css_files = ["docs.css"]
html_sidebars = {"**": ["searchbox.html", "globaltoc.html"]}
html_context = {"colours": style_sheet()}
templates_path = ["templates"]
html_show_sourcelink = False
html_copy_source = False
html_use_index = False
html_domain_indices = False
pygments_style = "bw"
