"""Families of cycles that shrink to an equilibrium: the velocity passes zero between two orbits."""

from __future__ import annotations

from contwalk.branch import Outcome
from contwalk.problems.orbit.orbit_data import OrbitData
from contwalk.problems.problem import Sample


def at_a_point(problem: OrbitData, a: Sample, b: Sample) -> Outcome | None:
    """A cycle shrinks to an equilibrium: beyond it the same ones follow, half a period later.

    The last orbit touches the section, which need not pass through the equilibrium: the parameter there is
    near that of the Hopf point, to the square of what is left of the orbit.
    """
    if problem.forced or problem.section is None:
        return None
    normal = problem.section.normal
    before, after = float(normal @ problem.velocity(a.z)), float(normal @ problem.velocity(b.z))
    if not before > 0.0 > after:
        return None
    # The parameter changes with the square of the amplitude, and so of the velocity.
    share = before**2 / (before**2 - after**2) if abs(before + after) > 1e-3 * before else 0.5
    value = float(a.z[-1] + share * (b.z[-1] - a.z[-1]))
    return shrunk(
        f"The orbit shrinks onto an equilibrium, at a Hopf point near {problem.line.described(value)}: "
        "the family ends there. Nothing to do."
    )


def shrunk(sentence: str) -> Outcome:
    """The end of a family that shrinks to nothing."""
    return Outcome("complete", "shrunk", sentence)
