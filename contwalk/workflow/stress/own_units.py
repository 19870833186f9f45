"""What a study in other units has found, in the plugin's own units: a database to be laid beside another."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from contwalk.branch import Branch, BranchInfo
from contwalk.special_point import SpecialPoint
from contwalk.storage import Database
from contwalk.storage.memory import MemoryDatabase
from contwalk.workflow.stress.units import Units


def in_own_units(found: Database, units: Units) -> Database:
    """A database in memory with all that can be compared of branches.

    Unknowns, tangents and arclengths stay as they are: they are in the metric of each.
    """
    result = MemoryDatabase(found.header)
    for branch in found.branches():
        info = replace(
            branch.info,
            states=units.names,
            parameters={name: value / units.of(name) for name, value in branch.info.parameters.items()},
        )
        result.start_branch(info)
        for row in _rows(branch, info, units):
            result.append(info.name, row)
        for point in branch.special_points:
            result.append_special(info.name, _point(point, branch.info, units))
        result.finish(info.name, branch.outcome, branch.cost)
    return result


def _rows(branch: Branch, info: BranchInfo, units: Units) -> np.ndarray:
    """Its rows in the plugin's own units, shape (k,)."""
    rows = branch.points.copy()
    rows["state"] = units.own(rows["state"])
    rows["period"] /= units.time
    for k, name in enumerate(info.free):
        rows["free"][:, k] /= units.of(name)
    for k, name in enumerate(info.observables):
        rows["observables"][:, k] /= units.of(name)
    rate = units.time if _in_rates(info) else 1.0
    rows["spectrum"].real *= rate  # not of complex numbers: infinite ones would have no value
    rows["spectrum"].imag *= rate
    rows["spectrum_error"] *= rate
    weights, used = rows["weights"], np.isfinite(rows["unknowns"]).sum(axis=1)
    number = len(units.names)
    if weights.shape[1] > number:
        weights[:, :number] = units.own(weights[:, :number])
    for k, name in enumerate(info.free):
        weights[np.arange(len(rows)), used - k] /= units.of(name)
    return rows


def _point(point: SpecialPoint, info: BranchInfo, units: Units) -> SpecialPoint:
    first = units.of(info.free[0])
    mark = dict(point.mark)
    if "value" in mark and "name" in mark:
        mark["value"] = mark["value"] / units.of(str(mark["name"]))
    return replace(
        point,
        parameters={name: value / units.of(name) for name, value in point.parameters.items()},
        state={name: value / units.states.get(name, 1.0) for name, value in point.state.items()},
        period=None if point.period is None else point.period / units.time,
        error=None if point.error is None else point.error / first,
        errors={name: value / units.of(name) for name, value in point.errors.items()},
        mark=mark,
    )


def _in_rates(info: BranchInfo) -> bool:
    """Whether the spectrum is of rates of growth, and not of multipliers."""
    return "equilibrium" in (info.problem, info.settings.get("of_problem"))
