"""`--jobs N`: how many processes or threads a command may take."""

from __future__ import annotations

import os
from collections.abc import Callable
from typing import Any

import click

MOST = 1024


class Jobs(click.ParamType):
    """A whole number from 1 up, or `auto` for all processors that this process may use."""

    name = "N|auto"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> int:
        """The number."""
        if value == "auto":
            return processors()
        try:
            number = int(value)
        except ValueError:
            number = 0
        if not 1 <= number <= MOST:
            self.fail(f"{value!r} is no number of jobs. Allowed: 1 to {MOST}, or auto.", param, ctx)
        return number


def processors() -> int:
    """How many processors this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def jobs_option(text: str, default: int | None) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """The option, with what it means for a command."""
    return click.option("--jobs", type=Jobs(), default=default, help=text)
