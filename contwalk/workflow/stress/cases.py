"""What is changed of a study that is not to change what it finds."""

from __future__ import annotations

from dataclasses import dataclass

from contwalk.system import System
from contwalk.workflow.stress.units import Units, units_of

# Powers of two next to a million and a thousand: a change of units then loses no digit, and what differs is
# the computation's own.
MILLION, THOUSAND = 2.0**20, 2.0**10
ACCURACIES = (1e-3, 1e-6, 1e-10, 1e-13)


@dataclass(frozen=True, eq=False)
class Case:
    """One change.

    Parameters
    ----------
    name : str
        In words.
    units : Units
    accuracy : float, optional
        Instead of the run file's.
    """

    name: str
    units: Units
    accuracy: float | None = None


def cases_of(system: System) -> list[Case]:
    """The changes that a system is put to."""
    as_it_is = units_of(system)
    cases = [
        Case("states in units of 1e-6", units_of(system, states=MILLION)),
        Case("states in units of 1e6", units_of(system, states=1.0 / MILLION)),
        Case("parameters in units of 1e-6", units_of(system, parameters=MILLION)),
        Case("parameters in units of 1e6", units_of(system, parameters=1.0 / MILLION)),
        Case("time in units of 1e-3", units_of(system, time=THOUSAND)),
        Case("time in units of 1e3", units_of(system, time=1.0 / THOUSAND)),
    ]
    if len(system.states) > 1:
        cases.append(Case("equations in the opposite order", units_of(system, turned=True)))
    return cases + [Case(f"accuracy {accuracy:g}", as_it_is, accuracy) for accuracy in ACCURACIES]
