"""Texts that others have written, as they may reach a terminal or a table: nothing in them that acts."""

from __future__ import annotations

import re

# Control characters but ends of lines and tabs, and what turns the direction of writing.
_ACTING = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u200e\u200f\u202a-\u202e\u2066-\u2069\ud800-\udfff]")


def printable(text: str) -> str:
    r"""The text with control characters as their codes, such as `\x1b`."""
    return _ACTING.sub(lambda found: ascii(found[0])[1:-1], text)
