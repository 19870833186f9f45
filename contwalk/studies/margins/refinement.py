"""A plane of labels, refined where they differ: squares of a lattice, split at the borders."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

Vertex = tuple[int, int]


@dataclass(frozen=True)
class Cell:
    """A square of the lattice: its lower left vertex, and its size in steps of the lattice."""

    i: int
    j: int
    size: int

    @property
    def corners(self) -> tuple[Vertex, ...]:
        """Its four vertices."""
        i, j, s = self.i, self.j, self.size
        return (i, j), (i + s, j), (i, j + s), (i + s, j + s)

    @property
    def quarters(self) -> tuple[Cell, ...]:
        """The four squares of half the size in it."""
        half = self.size // 2
        return tuple(Cell(self.i + a, self.j + b, half) for a in (0, half) for b in (0, half))

    def sides(self) -> Iterator[Vertex]:
        """All vertices of the lattice on its sides: smaller neighbours have some of them."""
        i, j, s = self.i, self.j, self.size
        for k in range(s + 1):
            yield from ((i + k, j), (i + k, j + s), (i, j + k), (i + s, j + k))


def refined(
    label: Callable[[Sequence[Vertex]], Sequence[str]], cells: int, levels: int
) -> tuple[dict[Vertex, str], list[Cell]]:
    """Labels of the vertices that were asked for, in that order, and the squares in the end.

    Parameters
    ----------
    label : callable
        The labels of vertices i, j from 0 to ``cells * 2**levels``.
    cells : int
        Squares of the first lattice, each way.
    levels : int
        How often squares are halved whose vertices, or those on their sides, have different labels.
    """
    largest = 2**levels
    known: dict[Vertex, str] = {}

    def ask(of: Sequence[Cell]) -> None:
        new = list(dict.fromkeys(v for cell in of for v in cell.corners if v not in known))
        known.update(zip(new, label(new), strict=True))

    leaves = [Cell(i * largest, j * largest, largest) for i in range(cells) for j in range(cells)]
    ask(leaves)
    for _ in range(levels):
        while True:
            split = [
                cell for cell in leaves if cell.size > 1 and cell.size >= largest and _mixed(cell, known)
            ]
            if not split:
                break
            gone = set(split)
            quarters = [quarter for cell in split for quarter in cell.quarters]
            leaves = [cell for cell in leaves if cell not in gone] + quarters
            ask(quarters)
        largest //= 2
    return known, leaves


def _mixed(cell: Cell, known: dict[Vertex, str]) -> bool:
    return len({known[vertex] for vertex in cell.sides() if vertex in known}) > 1
