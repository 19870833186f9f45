"""A solution with its spectrum, as equilibria and curves of them are watched."""

from __future__ import annotations

from typing import Any

import numpy as np

from contwalk.numerics.spectrum import Spectrum
from contwalk.problems.problem import Linearization, Sample
from contwalk.problems.sample import Rates


def sampled(
    z: np.ndarray,
    unit: np.ndarray,
    weights: np.ndarray,
    linearization: Linearization,
    found: Spectrum,
    before: int | None,
    **further: Any,
) -> Sample:
    """What is watched at a solution, of its equations and of a spectrum.

    Parameters
    ----------
    z, unit, weights : ndarray, shape (N + 1,)
        The solution, its tangent of length 1 in the metric of the weights, and these.
    linearization : Linearization
    found : Spectrum
        Eigenvalues that may become unstable.
    before : int, optional
        How many of them were at the solution before.
    further
        The other attributes of `Sample`.
    """
    return Sample(
        z=z,
        tangent=unit,
        weights=weights,
        eigenvalues=found.values,
        errors=found.errors,
        rates=Rates.known(found.rates, found.of_values),
        measures=found.measures,
        unstable=found.unstable(before),
        magnitudes=linearization.magnitudes,
        excess=linearization.excess_in(weights),
        **further,
    )
