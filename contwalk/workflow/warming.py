"""`contwalk warmup`: compiling beforehand what a first run would compile."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Warmed:
    """A part that is ready now.

    Parameters
    ----------
    name : str
    state : str
        `compiled` now, `was there` already, or `not kept` where the cache cannot be written.
    seconds : float
        What it took.
    """

    name: str
    state: str
    seconds: float


def warm() -> tuple[list[Warmed], Path]:
    """Compile what does not depend on a system, or find it in the cache; its folder."""
    from contwalk import object_cache

    folder = object_cache.directory()
    return [_warmed(name, part, folder) for name, part in parts().items()], folder


def parts() -> dict[str, Callable[[], None]]:
    """What is compiled, whatever the system, by name."""
    from contwalk.flow.ensemble import sampling
    from contwalk.flow.explicit import runge_kutta as explicit
    from contwalk.flow.gauss import gauss_collocation as gauss
    from contwalk.flow.hybrid import event_integrator
    from contwalk.flow.radau import radau_iia as radau
    from contwalk.problems.orbit import condensed, periodic_schur, quotients

    return {
        "explicit methods (dop853, verner98)": explicit.warmup,
        "implicit methods (radau5, radau9)": radau.warmup,
        "collocation (gauss4 to gauss14)": gauss.warmup,
        "sampling": sampling.warmup,
        "hybrid machines": event_integrator.warmup,
        "condensed linear systems": condensed.warmup,
        "products of many segments": periodic_schur.warmup,
        "multipliers": quotients.warmup,
    }


def _warmed(name: str, compile_it: Callable[[], None], folder: Path) -> Warmed:
    before, start = _kept(folder), time.perf_counter()
    compile_it()
    after = _kept(folder)
    state = "compiled" if after - before else "was there" if after else "not kept"
    return Warmed(name, state, time.perf_counter() - start)


def _kept(folder: Path) -> set[Path]:
    return set(folder.rglob("*.o"))
