"""`--scheduler ADDRESS`: a cluster of dask.distributed that computes in place of this machine."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import click


def scheduler_option() -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """The option."""
    text = "Scheduler of a dask.distributed cluster that computes; the result does not depend on it."
    return click.option("--scheduler", metavar="ADDRESS", help=text)


def check_one(context: click.Context, jobs: int, scheduler: str | None) -> None:
    """Refuse processes here beside a cluster."""
    if scheduler is not None and jobs != 1:
        raise click.UsageError("--jobs and --scheduler say both what computes. Give one of them.", context)
