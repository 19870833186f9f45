"""Kinds of special points, as far as a plugin's declaration is concerned."""

from __future__ import annotations

from typing import ClassVar


class KindOfPoint:
    """A kind of special point: one that a system declares is looked for on its branches only.

    Attributes
    ----------
    label : str
        As it is stored; several kinds may share one.
    """

    label: ClassVar[str]
