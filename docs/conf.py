"""Configuration of the documentation: `nox -s docs`, or `sphinx-build -W docs DIR`.

Neither the build nor the pages load anything from a network.
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
suppress_warnings = ["ref.python"]  # field names that several records share cannot be links

myst_enable_extensions = ["amsmath", "colon_fence", "deflist", "dollarmath"]
myst_heading_anchors = 3

# In docstrings a name between single backticks is code, and text between bars is not a substitution.
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
