"""Points of curves at which a coefficient of the normal form vanishes: CPC, GPD, CH and GH."""

from __future__ import annotations

import numpy as np

from contwalk.verification import coefficients, normal_forms
from contwalk.verification.equations import Equations, Evaluation
from contwalk.verification.equilibrium import EquilibriumEquations
from contwalk.verification.finding import CannotTell
from contwalk.verification.normal_forms import Differences, widest
from contwalk.verification.orbit import OrbitEquations
from contwalk.verification.passage import TIGHT
from contwalk.verification.rounds import Round
from contwalk.verification.solving import Condition

# The curve on which each lies.
ON = {"CPC": "LP", "GPD": "PD", "CH": "NS", "GH": "HB"}


def vanishing(label: str, equations: Equations) -> Condition:
    """That the coefficient is zero which tells which way what leaves the curve turns.

    Differences are taken at another length for each tolerance, so that what they make of it shows.
    """
    if label == "GH" and isinstance(equations, EquilibriumEquations):
        return _of_hopf(equations)
    if label == "GH" or not isinstance(equations, OrbitEquations):
        raise CannotTell(f"What defines {label} is not recomputed.")
    ahead, length = np.zeros(0), 0.0

    def condition(at: Evaluation) -> float:
        nonlocal ahead, length
        round_ = Round(equations, at, TIGHT)
        scale = equations._scale(round_.mode)

        def unit(xi: np.ndarray) -> float:
            return float(np.max(np.abs(round_.basis @ xi) / scale))

        length = length or normal_forms.straight(round_, unit, _critical(label, at))
        found = Differences(round_, unit, length * _share(at))
        if label == "GPD":
            return normal_forms.flip(found)
        if label == "CH":
            return normal_forms.torus(found, critical_angle(at))
        q, p = normal_forms.critical(round_.matrix, 1.0)
        ahead = q if not len(ahead) else ahead
        return 0.5 * float(np.sign(q @ ahead) * (p @ found.curve(q)[0]))

    return condition


def _critical(label: str, at: Evaluation) -> complex:
    """The multiplier that is at the border."""
    if label == "CH":
        return complex(np.exp(1j * critical_angle(at)))
    return -1.0 if label == "GPD" else 1.0


def critical_angle(at: Evaluation) -> float:
    """The angle of the pair of multipliers that is nearest to the unit circle."""
    above = at.spectrum[at.spectrum.imag > 0.0]
    if not len(above):
        raise CannotTell("No pair of multipliers is complex there.")
    return float(np.angle(above[int(np.argmin(np.abs(np.abs(above) - 1.0)))]))


def _of_hopf(equations: EquilibriumEquations) -> Condition:
    def condition(at: Evaluation) -> float:
        above = at.spectrum[at.spectrum.imag > 0.0]
        if not len(above):
            raise CannotTell("No pair of eigenvalues is complex there.")
        omega = float(above[int(np.argmin(np.abs(above.real)))].imag)
        return coefficients.lyapunov(omega)(coefficients.Bent(equations, at.z, widest() * _share(at)))

    return condition


def _share(at: Evaluation) -> float:
    return 0.5 if at.relative <= TIGHT else 1.0
