"""What matplotlib makes when it is imported and no figure of a command needs, left out.

Of each kind of artist it looks through all methods and their docstrings, to put tables of properties into the
help of others, and it loads what draws in space. Both are half of the time that it takes to be imported.
"""

from __future__ import annotations

import sys
from importlib import import_module
from types import ModuleType

_IN_SPACE = "mpl_toolkits.mplot3d"
_PROPERTIES = "_update_set_signature_and_docstring"
read = True  # whether whoever runs this process may ask for help on a class of matplotlib


def left_out() -> None:
    """Import what figures are drawn with, without manuals and without axes in space, unless manuals are read.

    Five names of matplotlib are known here; where it has others, all is imported as it is.
    """
    if read or "matplotlib" in sys.modules:
        return
    from matplotlib import _docstring, artist

    if hasattr(artist, "kwdoc") and hasattr(artist.Artist, _PROPERTIES):
        artist.kwdoc = lambda artist: ""
        setattr(artist.Artist, _PROPERTIES, classmethod(lambda cls: None))
        for filled in (_docstring.Substitution, type(_docstring.interpd)):
            setattr(filled, "__call__", lambda self, described: described)  # noqa: B010 (mypy)
    absent = ModuleType(_IN_SPACE)
    absent.Axes3D = None  # type: ignore[attr-defined]
    sys.modules[_IN_SPACE] = absent
    try:
        import_module("matplotlib.projections")
    finally:
        del sys.modules[_IN_SPACE]


def in_space() -> None:
    """Have axes in space, if they were left out."""
    from matplotlib.projections import get_projection_names, register_projection

    if "3d" not in get_projection_names():
        register_projection(import_module(_IN_SPACE).Axes3D)
