"""Multipliers of full orbits: powers of those of their closures, where a symmetry closes them up."""

from __future__ import annotations

from dataclasses import replace

from contwalk.branch import Branch


def full_orbits(branch: Branch) -> Branch:
    """The same branch with the multipliers of full orbits in place of those of their closures.

    A symmetry that leads back after k closures turns a multiplier into its k-th power; `spectrum` of the
    points keeps its shape (m,).
    """
    fold = int(branch.info.settings.get("fold", 1))
    if fold == 1:
        return branch
    points = branch.points.copy()
    points["spectrum"] = points["spectrum"] ** fold
    return replace(branch, points=points)
