"""How Sphinx makes the site; see `tools.site`."""

from contwalk.version import __version__

project = "contwalk"
author = "the contwalk developers"
release = version = __version__
extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon"]
myst_enable_extensions = ["colon_fence"]
myst_heading_anchors = 6
napoleon_google_docstring = False
napoleon_use_rtype = False
autodoc_typehints = "none"
autodoc_member_order = "bysource"
html_theme = "furo"
html_title = f"contwalk {__version__}"
html_static_path = ["static"]
html_css_files = ["site.css"]
highlight_language = "none"  # of blocks that name none: commands and formulas
default_role = "code"  # what docstrings have between single backticks
html_copy_source = False
html_show_sphinx = html_show_copyright = False
exclude_patterns = ["files/**"]
# Code in languages that Pygments does not know is shown as it is.
suppress_warnings = ["misc.highlighting_failure"]
