"""The documentation as a site that one can search, built by Sphinx without a network.

Sphinx and MyST rather than mkdocs: the pages stay the Markdown that they are, docstrings become the reference
of Python by autodoc, and the index of its search is a script, so that search works where a page is
opened from a disk; that of mkdocs-material asks a server for its index.
"""
