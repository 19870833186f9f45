"""`--jobs N`: how many processes or threads a command may take."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import click

from contwalk.workflow.machine import processors

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


def jobs_option(text: str, default: int | None) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """The option, with what it means for a command."""
    return click.option("--jobs", type=Jobs(), default=default, help=text)
