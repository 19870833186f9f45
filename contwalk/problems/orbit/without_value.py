"""The plugin's line where a motion has no value: its field, or something else that is asked on its way."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from itertools import pairwise
from typing import Any

import numpy as np

from contwalk import flow
from contwalk.errors import NO_LINE
from contwalk.fields.blame import first_switched, first_vanishing
from contwalk.flow.hybrid.functions_without_value import functions_of, line_without_value
from contwalk.numerics.distinct import distinct
from contwalk.problems.kink import REMEDY
from contwalk.problems.orbit.lifts import PLAIN
from contwalk.problems.orbit.passage import Passage

# Parts of a step that is looked at more closely, and how far its last finite state is led on, in such parts.
PARTS, AHEAD = 64, (1.0, 4.0, 16.0, 64.0)

Functions = Mapping[str, Callable[..., Any]]


def along(
    passage: Passage,
    values: np.ndarray,
    steps: np.ndarray,
    nodes: np.ndarray,
    method: str,
    functions: Functions | None = None,
) -> str:
    """`The NAME: file, line n: what` of the first function without a value on a motion; empty if none.

    Where all have one, and an implicit step on the way has no solution, a sentence that says so; else what
    comes to 0/0 where the motion breaks off.

    Parameters
    ----------
    passage : Passage
    values : ndarray
        Scalars and fixed parameters.
    steps : ndarray, shape (s + 1,)
        Instants 0..1.
    nodes : ndarray, shape (s + 1, n)
        States there, not finite from where on the motion is none.
    method : str
    functions : mapping, optional
        Of the form `f(t, x, p, out)` by their names in words; by default the field.
    """
    mode = passage.leg.mode
    if functions is None:
        name = f"field of mode '{mode}'"
        functions = {name: functions_of(passage.system, mode)[name]}
    for share, x in _places(passage, values, steps, nodes, method):
        if found := at(passage, values, share, x, functions):
            return found
    found = _unsolved(passage, values, steps, nodes, method)
    return found or ("" if np.isfinite(nodes).all() else vanishing(passage, values, steps, nodes))


def vanishing(passage: Passage, values: np.ndarray, times: np.ndarray, nodes: np.ndarray) -> str:
    """`The NAME: file, line n: what` of a quotient that comes to 0/0 where a motion breaks off, or the like.

    Instants 0..1 of shape (s,), states (s, n); the last one is where.
    """
    finite = np.isfinite(nodes).all(axis=1)
    last = len(nodes) if finite.all() else int(np.argmin(finite))
    if last < 2:
        return ""
    few = distinct(np.linspace(0, last - 1, PARTS).astype(int))
    start, lasting = passage.clock(values)
    instants = start + times[few] * lasting if passage.forced else np.zeros(len(few))
    places = [(float(t), passage.full(x).tolist()) for t, x in zip(instants, nodes[few], strict=True)]
    mode, known = passage.leg.mode, passage.parameters(values)
    known = {**known, **passage.system.mode(mode).constants}
    for name, function in functions_of(passage.system, mode).items():
        if found := first_vanishing(function, places, known):
            return f"The {name}: {found}."
    return ""


def at(passage: Passage, values: np.ndarray, share: float, x: np.ndarray, functions: Functions) -> str:
    """As `along`, at an instant 0..1 and a state of the mode."""
    if not np.isfinite(x).all():
        return ""
    start, lasting = passage.clock(values)
    t = start + share * lasting if passage.forced else 0.0
    known = passage.parameters(values)
    return line_without_value(passage.system, passage.leg.mode, functions, t, passage.full(x), known).strip()


def _unsolved(passage: Passage, values: np.ndarray, steps: np.ndarray, nodes: np.ndarray, method: str) -> str:
    """That the motion goes on in shorter steps where one of these has failed; empty if none has."""
    finite = np.isfinite(nodes).all(axis=1)
    k = int(np.argmin(finite)) - 1
    if finite.all() or k < 0 or not flow.implicit(method):
        return ""
    field, times = passage.field(PLAIN), np.linspace(steps[k], steps[k + 1], PARTS + 1)
    states = flow.along(field, field.constants(values), times, nodes[k], method)
    if not np.isfinite(states).all():
        return ""
    start, lasting = passage.clock(values)
    instants = start + times * lasting if passage.forced else np.zeros(len(times))
    places = [(float(t), passage.full(x).tolist()) for t, x in zip(instants, states, strict=True)]
    field_of_mode, known = passage.system.mode(passage.leg.mode).field, passage.parameters(values)
    switched = (first_switched(field_of_mode, *pair, known) for pair in pairwise(places))
    where = next((found for found in switched if found != NO_LINE), "")
    said = "An implicit step on the way has no solution, though the motion goes on in shorter ones"
    return f"{said}: the field is smooth by pieces only within it, {where}. {REMEDY}" if where else f"{said}."


def _places(
    passage: Passage, values: np.ndarray, steps: np.ndarray, nodes: np.ndarray, method: str
) -> Iterator[tuple[float, np.ndarray]]:
    """Instants and states at the steps, then within the step at which the motion ceases to be finite; within
    all steps if it does at none.
    """
    finite = np.isfinite(nodes).all(axis=1)
    last = len(nodes) if finite.all() else int(np.argmin(finite))
    yield from zip(steps[:last].tolist(), nodes[:last], strict=True)
    field = passage.field(PLAIN)
    c = field.constants(values)
    for k in range(last - 1) if last == len(nodes) else range(max(last - 1, 0), min(last, len(nodes) - 1)):
        times = np.linspace(steps[k], steps[k + 1], PARTS + 1)
        if not times[-1] > times[0]:
            continue
        states = flow.along(field, c, times, nodes[k], method)
        there = np.isfinite(states).all(axis=1)
        until = len(states) if there.all() else int(np.argmin(there))
        rates = field.along(times[:until], states[:until], c)
        without = np.flatnonzero(~np.isfinite(rates).all(axis=1))
        yield from ((float(times[j]), states[j]) for j in without[:1])
        if until < len(states):
            ahead = times[until - 1] + (times[1] - times[0]) * np.array(AHEAD)
            yield from ((float(t), states[until - 1] + (t - times[until - 1]) * rates[-1]) for t in ahead)
