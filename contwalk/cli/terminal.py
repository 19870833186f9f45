"""Text and tables on stdout and stderr."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from contwalk.printable import printable

if TYPE_CHECKING:
    from rich.console import Console


def console(stderr: bool = False) -> Console:
    """A rich console that prints text as it is: no markup, no highlighting."""
    from rich.console import Console

    class Piped(Console):
        """One that leaves it to the command line what is done when nobody reads any more."""

        def on_broken_pipe(self) -> None:
            raise BrokenPipeError

    return Piped(stderr=stderr, markup=False, highlight=False, emoji=False)


def line(out: Console, text: str, indent: int = 0, style: str = "") -> None:
    """A sentence, folded at the width of the terminal and in one piece everywhere else."""
    from rich.padding import Padding
    from rich.text import Text

    text = printable(text)
    if out.is_terminal:
        out.print(Padding(Text(text, style=style), (0, 0, 0, indent)))
    else:
        out.print(Text(" " * indent + text, style=style), soft_wrap=True)


def table(
    out: Console,
    header: Sequence[str],
    rows: Sequence[Sequence[str]],
    indent: int = 0,
    right: Sequence[int] = (),
) -> None:
    """Columns of text; `right` are those to be aligned at the right. Nothing is ever cut off."""
    rows = [[printable(cell) for cell in row] for row in rows]
    if out.is_terminal:
        _folded(out, header, rows, indent, right)
        return
    widths = [max(map(len, column)) for column in zip(header, *rows, strict=True)]
    for row in [header, *rows] if any(header) else rows:
        cells = [
            cell.rjust(width) if position in right else cell.ljust(width)
            for position, (cell, width) in enumerate(zip(row, widths, strict=True))
        ]
        line(out, "  ".join(cells).rstrip(), indent)


def _folded(
    out: Console, header: Sequence[str], rows: Sequence[Sequence[str]], indent: int, right: Sequence[int]
) -> None:
    """The table on a terminal: cells that are too long for it are folded."""
    from rich.padding import Padding
    from rich.table import Table
    from rich.text import Text

    columns = Table(box=None, padding=(0, 2, 0, 0), show_header=any(header), header_style="bold")
    for position, title in enumerate(header):
        columns.add_column(title, justify="right" if position in right else "left", overflow="fold")
    for row in rows:
        columns.add_row(*[Text(cell) for cell in row])
    out.print(Padding(columns, (0, 0, 0, indent), expand=False))
