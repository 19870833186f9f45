"""What is known of a published problem: run files, and the values that their diagrams must contain."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

FORTY_DIGITS = "defining equations solved in 40-digit arithmetic"
CLOSED_FORM = "closed form"
MONODROMY = "monodromy of the linear equation by DOP853 at 1e-13"
SHOOTING = "shooting by SciPy's DOP853 at 1e-13"
COLLOCATION = "Gauss collocation of the defining equations at two meshes, by a program of its own"


@dataclass(frozen=True)
class Value:
    """A special point that is known.

    Parameters
    ----------
    label : str
        As contwalk calls it: `LP`, `BP`, `HB`, `PD`, `NS`, ...
    value : float
        Of the free parameter.
    rel : float
        How far `value` itself may be off, relative to it (of a value 0 absolute).
    source : str
        Where the value comes from.
    of : str
        `equilibrium`, or `orbit` (smooth or hybrid): what the point is one of.
    criticality, kind : str, optional
        As contwalk calls them, where the source says so or a computation of its own does.
    times : int
        So many solutions have this point at this value, mirror images for example.
    period : float, optional
        Of the whole orbit.
    """

    label: str
    value: float
    rel: float
    source: str
    of: str = "equilibrium"
    criticality: str | None = None
    kind: str | None = None
    times: int = 1
    period: float | None = None

    @property
    def size(self) -> float:
        """What relative errors are relative to."""
        return abs(self.value) or 1.0

    @property
    def doubt(self) -> float:
        """How far `value` itself may be off."""
        return self.rel * self.size


@dataclass(frozen=True)
class Ending:
    """A branch `of` equilibria or orbits that must end for this reason, and at this value if one is given.

    `error` is how far `value` itself may be off, beside the error that is told with a limit; where no limit
    is told, how far the last stored point may be from it, which tells what end is meant.
    """

    reason: str
    source: str
    value: float | None = None
    error: float = 0.0
    of: str = "orbit"


@dataclass(frozen=True)
class Study:
    """One run file of a problem, and what its diagram must contain: all special points and nothing else.

    Parameters
    ----------
    name : str
        What tells it from the problem's other studies.
    run : dict
        The run file, but for `system` and `output`.
    values : tuple of Value
        All special points.
    endings : tuple of Ending
        Ends that must be among those of the branches.
    real : tuple of Value
        Points that may be found and need not: beyond what the study is about, each shown to be real.
    slow : bool
        Takes seconds: not tried by `make test`.
    long : bool
        Its like is among the others: tried by `make long` alone.
    lost : str
        What is known to be lost or wrong today, in a sentence; empty where nothing is.
    """

    name: str
    run: dict[str, Any]
    values: tuple[Value, ...]
    endings: tuple[Ending, ...] = ()
    real: tuple[Value, ...] = ()
    slow: bool = False
    long: bool = False
    lost: str = ""


@dataclass(frozen=True)
class Peer:
    """A published problem; its equations are the `SYSTEM` of the same file."""

    title: str
    source: str
    studies: tuple[Study, ...] = field(default_factory=tuple)
