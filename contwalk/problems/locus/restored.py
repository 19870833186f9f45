"""Curves in two parameters from what is stored of them."""

from __future__ import annotations

import numpy as np

from contwalk.problems.locus.equilibrium_locus import EquilibriumLocus, plane_of
from contwalk.problems.restoring import Facts


def restored(facts: Facts) -> EquilibriumLocus:
    """The problem of a stored curve; its borders are made where a point of it is taken up (`at_stored`)."""
    first, second = facts.info.free
    plane = plane_of(
        facts.system, facts.parameters, (first, second), facts.pins, facts.state, facts.discretization
    )
    known = facts.parameters[second], facts.parameters[first]
    kappa = [1.0] if facts.info.settings["of"] == "HB" else []
    drifts = np.zeros(len(facts.pins))
    return EquilibriumLocus(
        plane, str(facts.info.settings["of"]), np.concatenate([facts.state, drifts, kappa, known])
    )
