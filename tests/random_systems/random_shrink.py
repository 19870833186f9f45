"""A smaller machine with the same fault: terms, states' terms and depth taken away while the fault stays."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

from random_recipe import Recipe

Check = Callable[[Recipe], dict[str, Any]]


def shrunk(recipe: Recipe, check: Check) -> tuple[Recipe, dict[str, Any]]:
    """The smallest recipe found by taking away one thing after the other, and its record."""
    record = check(recipe)
    if not record["faults"]:
        return recipe, record
    wanted = record["faults"][0]["code"]
    again = True
    while again:
        again = False
        for smaller in _smaller(recipe):
            try:
                found = check(smaller)
            except Exception:  # a machine that the checks cannot handle is not the one looked for
                continue
            if wanted in [f["code"] for f in found["faults"]]:
                recipe, record, again = smaller, found, True
                break
    return recipe, record


def _smaller(recipe: Recipe) -> Iterator[Recipe]:
    if recipe.depth > 0:
        yield replace(recipe, depth=recipe.depth - 1)
    for mode, equations in recipe.modes.items():
        for i, terms in enumerate(equations):
            for k in range(len(terms)):
                rest = (*terms[:k], *terms[k + 1 :])
                changed = (*equations[:i], rest, *equations[i + 1 :])
                yield replace(recipe, modes={**recipe.modes, mode: changed})
