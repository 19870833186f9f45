"""Points that a plugin defines: guards that an equilibrium reaches, and kinds of its own."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Any

import numpy as np

from contwalk.branch import SpecialPoint
from contwalk.system import System
from contwalk.system.special_points import KindOfPoint
from contwalk.verification.equations import Evaluation
from contwalk.verification.equilibrium import EquilibriumEquations
from contwalk.verification.finding import CannotTell
from contwalk.verification.solving import Condition


def boundary(point: SpecialPoint, equations: EquilibriumEquations) -> Condition:
    """That a guard of the mode is zero: the one that the note names."""
    functions, n = equations.functions, equations.size
    named = re.findall(r"'([^']+)'", point.note or "")
    found = [each for each in functions.system.leaving(equations.mode) if each.name in named]
    if not found:
        raise CannotTell("The record does not name the guard that the equilibrium reaches.")
    guard = functions.guard(found[0])

    def condition(at: Evaluation) -> float:
        value, slope = guard(0.0, at.z[:n], functions.parameters.at(at.z[n:]))
        return float(value[0]) / max(float(np.linalg.norm(slope[0, 1 : 1 + n])), 1e-300)

    return condition


@dataclass(frozen=True)
class Seen:
    """What a declared kind's test function is given: place and eigenvalues, nothing of the engine.

    Parameters
    ----------
    z, eigenvalues : ndarray, shapes (N + k,) and (r,)
    """

    z: np.ndarray
    eigenvalues: np.ndarray


def kind_of(system: System, label: str) -> KindOfPoint | None:
    """The kind of this label that the plugin declares with a test function of its own."""
    kinds = (each for each in system.point_types if each.label == label)
    return next((each for each in kinds if callable(getattr(each, "value", None))), None)


def own_test(kind: Any, begin: Evaluation) -> Condition:
    """That the test function of a declared kind is zero, in units of the largest eigenvalue."""
    size = max(float(np.abs(begin.spectrum).max(initial=0.0)), 1e-300)

    def condition(at: Evaluation) -> float:
        try:
            return float(kind.value(None, Seen(at.z, _sorted(at.spectrum)))) / size
        except (AttributeError, TypeError) as why:
            raise CannotTell(f"The test function of {kind.label} asks for more than eigenvalues.") from why

    return condition


def _sorted(spectrum: np.ndarray) -> np.ndarray:
    """Eigenvalues by descending real part, as the engine hands them over."""
    return np.asarray(spectrum[np.argsort(-spectrum.real)])
