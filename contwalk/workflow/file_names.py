"""Names of files that belong to an output."""

from __future__ import annotations

from pathlib import Path

SUFFIX = ".h5"


def beside(output: Path, what: str) -> Path:
    """`X_what` beside the output `X.h5`; `X.txt_what` beside `X.txt`, for X.h5 may have files of its own."""
    stem = output.stem if output.suffix == SUFFIX else output.name
    return output.with_name(f"{stem}_{what}")
