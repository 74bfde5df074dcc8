"""Sphinx's settings for the site (tools/docs). The pages are docs/*.md; build_site.py lays them out."""

import os
import re
import sys
from pathlib import Path

repository = Path(os.environ["SLEWLAB_SITE_REPOSITORY"])
sys.path.insert(0, os.environ["SLEWLAB_SITE_PYTHON"])  # the package slewlab, for its docstrings

project = "slewlab"
copyright = "the slewlab authors"
release = re.search(r"project\(slewlab VERSION ([0-9.]+)", (repository / "CMakeLists.txt").read_text(encoding="utf-8")).group(1)
extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon"]
root_doc = "README"
language = "en"

# Pages are written for GitHub: links with a page's slugs, code without a language.
myst_heading_anchors = 4
highlight_language = "none"
default_role = "code"
suppress_warnings = ["myst.header"]  # a page may begin with a table under its title, or leave a level out

autodoc_member_order = "bysource"
autodoc_typehints = "signature"

html_theme = "furo"
html_title = f"slewlab {release}"
html_copy_source = False
html_show_sourcelink = False
html_theme_options = {"top_of_page_buttons": []}
