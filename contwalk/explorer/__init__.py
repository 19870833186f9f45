"""A database as a page that one looks at: one file, without a network, for whoever has a browser."""

from __future__ import annotations

from contwalk.explorer.exploring import Explored, explore, explored
from contwalk.explorer.pushing import margins_page

__all__ = ["Explored", "explore", "explored", "margins_page"]
