"""Equilibria from what is stored of their branch."""

from __future__ import annotations

from contwalk.problems.equilibrium.equilibrium import Equilibrium
from contwalk.problems.restoring import Facts


def restored(facts: Facts) -> Equilibrium:
    """The problem of a stored branch of equilibria, of the mode that it is of."""
    return Equilibrium(
        facts.system, facts.parameters, facts.free, facts.ends, facts.pins, facts.state, facts.discretization
    )
