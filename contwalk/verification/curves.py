"""What all points of a curve in two parameters are: the condition that holds along it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from contwalk.branch import Branch
from contwalk.labels import LOCUS, MARK
from contwalk.verification.branching import Unfolded
from contwalk.verification.conditions import spectral
from contwalk.verification.equations import Equations
from contwalk.verification.finding import CannotTell
from contwalk.verification.limits import KINDS, limit_of_curve
from contwalk.verification.marks import number
from contwalk.verification.orbit import OrbitEquations
from contwalk.verification.solving import Condition, Sheet

# The multiplier of half a symmetric orbit whose whole loses the symmetry, as it is stored of a curve.
SYMMETRY_BREAKING = "symmetry-breaking"


def unfolds(branch: Branch) -> bool:
    """Whether all points of a curve are branch points at which the equations themselves are singular."""
    return branch.info.settings.get("of") == "BP" and stored(branch).get("name") != SYMMETRY_BREAKING


def on_limit(branch: Branch) -> bool:
    """Whether all points of a curve are at a limit of the machine's motions."""
    return branch.info.problem == LOCUS and str(branch.info.settings["of"]) in (*KINDS, "BE")


def stored(branch: Branch) -> Mapping[str, Any]:
    """What is stored of a curve beside its label."""
    found: Mapping[str, Any] = branch.info.settings.get("curve") or {}
    return found


def of_curve(
    branch: Branch, spectrum: Sequence[complex], equations: Equations, sheet: Sheet
) -> list[Condition]:
    """What all points of a curve in two parameters are; nothing of other branches.

    Parameters
    ----------
    spectrum : sequence of complex
        Stored eigenvalues of the place.
    """
    if branch.info.problem != LOCUS:
        return []
    of, kept = str(branch.info.settings["of"]), stored(branch)
    if isinstance(equations, Unfolded) and unfolds(branch):
        return equations.conditions
    if of in KINDS and isinstance(equations, OrbitEquations):
        return [limit_of_curve(branch.info.settings["limit"], equations, sheet.begin)]
    if of == MARK:
        return [_marked(branch, kept, equations)]
    label = "PD" if kept.get("name") == SYMMETRY_BREAKING else of
    if not (own := spectral(label, spectrum, equations, sheet)):
        raise CannotTell(f"What defines a curve of {of} is not recomputed.")
    return own


def _marked(branch: Branch, kept: Mapping[str, Any], equations: Equations) -> Condition:
    """A number at the value that the curve is stored with."""
    level = float(kept["level"])
    size = max(abs(level), 1e-300) if level else 1.0
    if kept["name"] == "parameter":
        place = len(equations.z) - len(equations.free) - 1 - int(kept["place"])
        return lambda at: (float(at.z[place]) - level) / size
    name = {"real": "max_re", "pair": "max_re"}.get(str(kept["name"])) or str(kept["observable"])
    function = number(branch, equations, name)
    return lambda at: (function(at) - level) / size
