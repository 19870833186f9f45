"""What a curve in two parameters would have been that could not be begun."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from contwalk.branch import ORBITS
from contwalk.labels import LOCUS

EQUILIBRIUM = "equilibrium"
# Which curves meet in a point: where one of them is walked, one of the others begins there.
_MEET: Mapping[str, Sequence[str]] = {
    "BT": ("LP", "HB"),
    "ZH": ("LP", "HB"),
    "R1": ("LP", "NS"),
    "R2": ("PD", "NS"),
    "LPPD": ("LP", "PD"),
    "LPNS": ("LP", "NS"),
    "PDNS": ("PD", "NS"),
    "GRLP": ("GR", "LP"),
    "GRPD": ("GR", "PD"),
    "GRNS": ("GR", "NS"),
}
# Curves of cycles that are born at points of equilibria, and of doubled orbits at points of orbits.
_OF_CYCLES: Mapping[str, str] = {"GH": "LP", "ZH": "NS", "HH": "NS"}
_OF_DOUBLED: Mapping[str, str] = {"GPD": "LP"}


def unbegun(of: str, free: Sequence[str], of_problem: str) -> dict[str, Any]:
    """What is true of a curve of points of this label, as fields of `BranchInfo`."""
    return {"problem": LOCUS, "free": tuple(free), "settings": {"of": of, "of_problem": of_problem}}


def born_of(problem: Any, label: str) -> dict[str, Any]:
    """The same of the curve that would have begun at a point of a curve; of other problems nothing.

    Curves that cross in a point that is told by no other label are of one kind.
    """
    if problem.kind != LOCUS:
        return {}
    facts = problem.branch_facts()
    own, of_problem = str(facts["settings"]["of"]), str(facts["settings"]["of_problem"])
    if of_problem == EQUILIBRIUM and label in _OF_CYCLES:
        cycles = ORBITS[1] if problem.system.has_events else ORBITS[0]
        return unbegun(_OF_CYCLES[label], facts["free"], cycles)
    others = [of for of in _MEET.get(label, ()) if of != own]
    return unbegun(_OF_DOUBLED.get(label, others[-1] if others else own), facts["free"], of_problem)
