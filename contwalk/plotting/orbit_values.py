"""What is drawn of a state: of an equilibrium its value, of an orbit what does not depend on where it is cut.

An autonomous orbit is cut where its phase is fixed, which moves along the branch: the value of a state there
tells nothing. So orbits are drawn by the largest and the least value of the state; orbits with events by the
values at the event, all of them where it comes several times, unless these are the same for all orbits; and
any orbit where the run file says at which section or event to look (`report_at`) by what it asks for.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from contwalk import quantities
from contwalk.branch import ORBITS, Branch
from contwalk.plotting.quantities import axis_label, candidates_for_y, values

# What varies less than this part of its size is constant but for rounding.
CONSTANT = 1e-9


@dataclass(frozen=True)
class Drawn:
    """Names of the quantities that a branch is drawn by, for each branch, and what the axis is called."""

    names: tuple[tuple[str, ...], ...]
    label: str


def drawn_by(branches: Sequence[Branch], y: str, units: Mapping[str, str] | None) -> Drawn:
    """What stands for `y` on each of the branches."""
    plain = tuple((y,) for _ in branches)
    label = axis_label(y, units)
    orbits = [b for b in branches if b.info.problem in ORBITS and y in b.info.states]
    if not orbits:
        return Drawn(plain, label)
    places = {str(b.info.settings.get("reported", "")) for b in orbits}
    if "" not in places and _tells(orbits, y):
        place = f" {places.pop()}" if len(places) == 1 else " at events"
        return Drawn(tuple((y, *_visits(b, y)) for b in branches), axis_label(y, units, place))
    if any(values(b, quantities.MAX + y) is None for b in orbits):
        return Drawn(plain, label)
    ends = tuple(
        (quantities.MAX + y, quantities.MIN + y) if b.info.problem in ORBITS else (y,) for b in branches
    )
    return Drawn(ends, axis_label(y, units, ", largest and least"))


def default_y(branches: Sequence[Branch]) -> str:
    """The first observable of the system's own that has a value somewhere, else the first such state.

    An angle that goes round has neither a largest nor a least value, and an observable none where its event
    never happens. The first of all where none has a value.
    """
    candidates = candidates_for_y(branches)
    return next((name for name in candidates if _has_value(branches, name)), candidates[0])


def _has_value(branches: Sequence[Branch], y: str) -> bool:
    having = [branch for branch in branches if branch.knows(y)]
    return any(
        (found := values(branch, name)) is not None and np.isfinite(found).any()
        for branch, names in zip(having, drawn_by(having, y, {}).names, strict=True)
        for name in names
    )


def _tells(orbits: Sequence[Branch], y: str) -> bool:
    """Whether a state differs from orbit to orbit where it is taken: a mass is at the stop when it hits."""
    found = [np.asarray(branch[y], dtype=float) for branch in orbits]
    if not all(np.isfinite(each).any() for each in found):
        return False
    everything = np.concatenate([each[np.isfinite(each)] for each in found])
    return bool(np.ptp(everything) > CONSTANT * np.abs(everything).max())


def _visits(branch: Branch, y: str) -> list[str]:
    """Names of the state at the second and later visits of the event."""
    own = [name for name in branch.info.observables if name.startswith(y + quantities.VISIT)]
    return sorted(own, key=lambda name: int(name.rpartition(quantities.VISIT)[2]))
