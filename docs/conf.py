"""How the documentation is built: `nox -s docs`, or `sphinx-build -W docs DIR`.

Nothing is fetched, neither while it is built nor by who reads it.
"""

from __future__ import annotations

import sys
from importlib.metadata import version as version_of
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent / "extensions"))

project = "sprung"
author = "The sprung developers"
project_copyright = author
release = version = version_of("sprung")

extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "formulas", "reference"]
exclude_patterns = ["extensions"]
suppress_warnings = ["ref.python"]  # names of fields, which several records share, are no links

myst_enable_extensions = ["amsmath", "colon_fence", "deflist", "dollarmath"]
myst_heading_anchors = 3

# In docstrings a name between single backticks is code, and text between bars is no substitution.
default_role = "code"
napoleon_google_docstring = False
napoleon_use_rtype = False
napoleon_use_ivar = True
autodoc_typehints = "none"
autodoc_member_order = "bysource"
python_use_unqualified_type_names = True

html_theme = "furo"
html_title = f"sprung {version}"
html_show_sourcelink = False
html_static_path = ["static"]
html_css_files = ["sprung.css"]
html_theme_options = {"navigation_with_keys": True}
