"""Names to arrays: what may stand on an axis, and how it is written there."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

import numpy as np

from contwalk import quantities
from contwalk.branch import Branch
from contwalk.errors import ContwalkError
from contwalk.system import System
from contwalk.system.declarations import SPLIT, Observable, Parameter, State, nearest
from contwalk.system.units import time_unit

LONG = 24  # characters of a text that has no room beside another one
# Observables that branches have of themselves. They say how stable a motion is, not what it looks like.
BUILT_IN_OBSERVABLES = ("max_re", "max_abs", SPLIT)


class Units(dict[str, str]):
    """Units by name, and in `called` how figures write the names of those that say so."""

    def __init__(self, units: Mapping[str, str], called: Mapping[str, str]) -> None:
        super().__init__(units)
        self.called = dict(called)


def units_of(system: System) -> Units:
    """Units of a system's quantities by name, as the figures' `units` take them."""
    units = {"period": system.time_unit}
    units |= {state.name: state.unit for state in system.states}
    units |= {signal.name: signal.unit for signal in system.signals}
    units |= {parameter.name: parameter.unit for parameter in system.parameters}
    units |= {observable.name: observable.unit for observable in system.observables}
    declared: tuple[State | Parameter | Observable, ...]
    declared = (*system.states, *system.parameters, *system.observables)
    return Units(units, {each.name: _called(each) for each in declared})


def _called(declared: State | Parameter | Observable) -> str:
    """`drag $\\delta$`: a name as a figure writes it, after what it means where that is short."""
    symbol = f"${declared.latex}$" if declared.latex else declared.name
    return f"{plain(declared.about)} {symbol}" if 0 < len(declared.about) <= LONG else symbol


def plain(text: str) -> str:
    """A text of which a figure writes dollar signs as they are."""
    return text.replace("$", r"\$")


def axis_label(name: str, units: Mapping[str, str] | None, place: str = "") -> str:
    """`omega (rad/s)`; the name alone where it has no unit or is dimensionless.

    `place` says at which place of a motion, before the unit.

    Raises
    ------
    ContwalkError
        If the name is declared in LaTeX that no figure can write.
    """
    unit, words = unit_of(name, units or {}), name
    if isinstance(units, Units) and len(units.called.get(name, "")) < 8 * LONG:
        words = units.called.get(name, name)
        if "$" in words:
            _check_written(name, words)
    return words + place if unit in ("", "1") else f"{words}{place} ({written(unit)})"


def _check_written(name: str, words: str) -> None:
    from matplotlib.mathtext import MathTextParser

    try:
        MathTextParser("path").parse(words)
    except (ValueError, RecursionError) as error:
        raise ContwalkError(
            f"'{name}' is declared as {words}, which a figure cannot write.",
            f"Mend `latex` or `about` in the plugin: {str(error).splitlines()[-1]}.",
        ) from error


def time_label(units: Mapping[str, str] | None) -> str:
    """What stands below an axis of time: with the unit of the period, or that the other units imply."""
    known = units or {}
    return axis_label("time", {"time": known.get("period", time_unit(known.values()))})


def unit_of(name: str, units: Mapping[str, str]) -> str:
    """The unit of a quantity; `max:X` and `X@2` have that of the state."""
    state = name.rpartition(":")[2].partition(quantities.VISIT)[0]
    return units.get(name, units.get(state, "1"))


def written(unit: str) -> str:
    """A unit as a figure writes it: `m/s2` with a raised 2, `sqrt(k/M)` with a root sign."""
    # A 1 is part of a name: lengths may be measured in units of l1.
    raised = re.sub(r"(?<=[A-Za-z])([2-4])\b", lambda found: "²³⁴"[int(found[1]) - 2], unit)
    return re.sub(r"\bsqrt\(", "√(", raised)


def _scalar_columns(branch: Branch) -> list[str]:
    dtype = branch.points.dtype
    return [name for name in dtype.names or () if dtype[name].shape == () and dtype[name].kind != "c"]


def known_names(branches: Sequence[Branch]) -> list[str]:
    """Names that stand for one real number per point on at least one branch."""
    known: dict[str, None] = {}
    for branch in branches:
        known |= dict.fromkeys((*branch.names(), *branch.info.parameters, *_scalar_columns(branch)))
        known |= dict.fromkeys(quantities.every_extreme(branch.info.states))
    return list(known)


def values(branch: Branch, name: str) -> np.ndarray | None:
    """The quantity along the branch, of shape (k,); None where the branch has no such quantity."""
    if not branch.knows(name):
        return None
    return np.asarray(branch[name], dtype=float)


def _require_some(branches: Sequence[Branch]) -> None:
    if not branches:
        raise ContwalkError("There are no branches to plot.", "Give at least one branch.")


def with_names(branches: Sequence[Branch], names: Sequence[str]) -> list[Branch]:
    """Those of the branches that have all of the names.

    Raises
    ------
    ContwalkError
        If there is no branch at all, or none has the names; the remedy names the nearest known name.
    """
    _require_some(branches)
    for name in names:
        if not any(branch.knows(name) for branch in branches):
            known = known_names(branches)
            own = [each for each in known if not quantities.of_orbit(each)]
            raise ContwalkError(
                f"No branch has a quantity named '{name}'.",
                f"{nearest(name, known)} Known: {', '.join(own)}; of a state X max:X, min:X, amp:X.".strip(),
            )
    having = [branch for branch in branches if all(branch.knows(name) for name in names)]
    if not having:
        raise ContwalkError(
            f"No branch has all of {', '.join(names)}.", "Plot quantities that belong to the same branch."
        )
    return having


def called(branches: Sequence[Branch]) -> list[str]:
    """What branches are called on one figure: their names, or b1, b2, ... in their order if two share one."""
    names = [branch.name for branch in branches]
    return names if len(set(names)) == len(names) else [f"b{number + 1}" for number in range(len(names))]


def default_x(branches: Sequence[Branch]) -> str:
    """The first free parameter of the first branch that has one."""
    _require_some(branches)
    for branch in branches:
        if branch.info.free:
            return branch.info.free[0]
    raise ContwalkError("No branch has a free parameter.", "Say with x= what stands on the horizontal axis.")


def candidates_for_y(branches: Sequence[Branch]) -> list[str]:
    """The observables of the system's own, which margins are not, then the states.

    Raises
    ------
    ContwalkError
        If there are none.
    """
    _require_some(branches)
    own: dict[str, None] = {}
    for branch in branches:
        margins = {name for point in branch.special_points for name in point.margin}
        own |= dict.fromkeys(
            name
            for name in branch.info.observables
            if name not in (*BUILT_IN_OBSERVABLES, *margins) and not quantities.of_orbit(name)
        )
    own |= dict.fromkeys(name for branch in branches for name in branch.info.states)
    if own:
        return list(own)
    raise ContwalkError(
        "No branch has an observable or a state.", "Say with y= what stands on the vertical axis."
    )
