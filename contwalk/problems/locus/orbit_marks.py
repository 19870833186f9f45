"""Marked values on curves of orbits: of both parameters, and of what is observed along them."""

from __future__ import annotations

from typing import Any

import numpy as np

from contwalk.errors import NotFinite
from contwalk.problems.locus.valued import BESIDE
from contwalk.problems.locus.valued_curves import measured
from contwalk.problems.orbit.augmented import along
from contwalk.problems.problem import Located, Sample


def value(problem: Any, name: str, z: np.ndarray) -> float:
    """An observable of the curve, or a free parameter, at z, shape (N + k + 2,)."""
    names = problem.line.names
    if name in names:
        return float(z[-1 - names.index(name)])
    if name in problem.curve.observables:
        return float(problem.further(z)[problem.curve.observables.index(name)])
    there, own = problem.plane.first(z)
    return measured(there, own, name)


def rate(problem: Any, name: str, sample: Sample) -> float:
    """Its derivative along the curve; NaN where there is no motion beside the sample's."""
    names = problem.line.names
    if name in names:
        return float(sample.tangent[-1 - names.index(name)])
    try:
        ahead, behind = (value(problem, name, sample.z + h * sample.tangent) for h in (BESIDE, -BESIDE))
    except NotFinite:
        return float("nan")
    return (ahead - behind) / (2.0 * BESIDE)


def located(problem: Any, name: str, level: float, sample: Sample) -> Located | None:
    """The point of the curve near a sample at which it has the value `level`."""
    system = along(sample, lambda there, z: value(there, name, z) - level, rate(problem, name, sample))
    found: Located | None = problem.located(system, sample)
    return found
