"""Reasons of several attempts in one sentence."""

from __future__ import annotations

import re
from collections.abc import Iterable

_NUMBER = re.compile(r"[-+]?\d+(\.\d+)?(e[-+]?\d+)?")


def told_once(reasons: Iterable[str]) -> str:
    """Reasons in a row; of those that differ in nothing but numbers the first."""
    kept: dict[str, str] = {}
    for reason in reasons:
        kept.setdefault(_NUMBER.sub("#", reason), reason)
    return "; ".join(kept.values())


def first_sentence(text: str) -> str:
    """What is wrong, without its remedy and its full stop."""
    return text.split(". ")[0].rstrip(".")
