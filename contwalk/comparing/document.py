"""A comparison as plain JSON values: what `contwalk diff A B --json` prints."""

from __future__ import annotations

import math
from dataclasses import asdict
from typing import Any

from contwalk.comparing.databases import Compared, Comparison
from contwalk.comparing.difference import Difference

DIFF_VERSION = 1


def document_of(comparison: Comparison) -> dict[str, Any]:
    """The comparison as JSON; numbers that are not finite are null."""
    return {
        "diff_version": DIFF_VERSION,
        "a": comparison.a,
        "b": comparison.b,
        "same": comparison.same,
        "differences": [_difference(each) for each in comparison.differences],
        "branches": [_branch(each) for each in comparison.branches],
        "notes": list(comparison.notes),
    }


def _branch(compared: Compared) -> dict[str, Any]:
    return {
        "a": list(compared.a),
        "b": list(compared.b),
        "by": compared.by or None,
        "what": compared.what,
        "same": not compared.differences,
        "n_points": list(compared.points),
        "rhs": list(compared.rhs),
        "seconds": list(compared.seconds),
        "differences": [_difference(each) for each in compared.differences],
    }


def _difference(difference: Difference) -> dict[str, Any]:
    plain = asdict(difference)
    for name in ("a", "b", "quantity"):
        plain[name] = plain[name] or None
    return {name: _finite(value) for name, value in plain.items()}


def _finite(value: Any) -> Any:
    return None if isinstance(value, float) and not math.isfinite(value) else value
