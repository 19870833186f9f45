"""Curves in two parameters from what is stored of them."""

from __future__ import annotations

from importlib import import_module
from typing import Any

import numpy as np

from contwalk.labels import RANGES
from contwalk.problems.locus.curves import curve_of
from contwalk.problems.locus.equilibrium_locus import EquilibriumLocus, plane_of, spans_of
from contwalk.problems.restoring import Facts


def restored(facts: Facts) -> Any:
    """The problem of a stored curve; its borders are made where a point of it is taken up (`at_stored`)."""
    if facts.info.settings["of_problem"] == "equilibrium":
        return _of_equilibria(facts)
    # Curves of equilibria need no compiled flows.
    return import_module("contwalk.problems.locus.orbit_restored").restored(facts)


def _of_equilibria(facts: Facts) -> EquilibriumLocus:
    first, second = facts.info.free
    plane = plane_of(
        facts.system, facts.parameters, (first, second), facts.pins, facts.state, facts.discretization
    )
    known = facts.parameters[second], facts.parameters[first]
    curve = curve_of(facts.info.settings)
    own = [1.0 if curve.pair else 0.0] * curve.own
    drifts = np.zeros(len(facts.pins))
    place = np.concatenate([facts.state, drifts, own, known])
    return EquilibriumLocus(
        plane, curve, place, spans_of(facts.info.settings.get(RANGES, {}), (second, first))
    )
