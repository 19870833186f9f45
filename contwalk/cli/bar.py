"""A bar on the terminal while something is computed part by part; nothing where nobody watches."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial


@contextmanager
def bar(what: str, total: int | None, quiet: bool) -> Iterator[Callable[..., None] | None]:
    """A bar on stderr while this lasts, gone after it.

    Parameters
    ----------
    what : str
        What is counted: `rays`.
    total : int, optional
        How many there are; None where that is told later.
    quiet : bool
        Whether nothing is to be shown.

    Yields
    ------
    callable or None
        Moves the bar, by `advance=`, or `completed=` and `total=`, with another `description=`. None where
        nobody watches.
    """
    if quiet or not (sys.stdout.isatty() and sys.stderr.isatty()):
        yield None
        return
    from rich.progress import Progress

    from contwalk.cli.terminal import console

    with Progress(console=console(stderr=True), transient=True) as shown:
        yield partial(shown.update, shown.add_task(what, total=total))
