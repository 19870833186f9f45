"""Small systems for the tests of the engine, one line each."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import contwalk as cw
from contwalk.branch import Branch, SpecialPoint
from contwalk.system import Mode, Parameter, State, System


def small_system(
    field: Callable[..., None], states: Sequence[str | State], parameters: dict[str, float], **rest: Any
) -> System:
    """A system of one mode; states by name or declared."""
    return System(
        "small",
        states=tuple(State(s) if isinstance(s, str) else s for s in states),
        parameters=tuple(Parameter(name, value) for name, value in parameters.items()),
        modes=(Mode("only", field),),
        **rest,
    )


def small_problem(
    field: Callable[..., None],
    states: Sequence[str | State],
    parameters: dict[str, float],
    free: str,
    **rest: Any,
) -> cw.Equilibrium:
    """The equilibria of a small system."""
    system = small_system(field, states, parameters, **rest)
    return cw.Equilibrium(system, system.defaults(), free)


def labelled(branch: Branch, *labels: str) -> list[SpecialPoint]:
    """Special points with these labels, in their order along the branch."""
    return [point for point in branch.special_points if point.label in labels]


def bifurcations(branch: Branch) -> list[SpecialPoint]:
    """Special points but end points and marks."""
    return labelled(branch, "LP", "BP", "HB")


def circle(t, x, p, dx):
    """A limit cycle: the circle of radius sqrt(mu), gone round in 2 pi."""
    growth = p.mu - x[0] ** 2 - x[1] ** 2
    dx[0] = growth * x[0] - x[1]
    dx[1] = x[0] + growth * x[1]
