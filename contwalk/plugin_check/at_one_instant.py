"""What transitions that may have one instant lead to in either order."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

import numpy as np

from contwalk.errors import ContwalkError
from contwalk.flow.hybrid.machine import HybridMachine, ModeFlow, hybrid_machine
from contwalk.numerics.linear import EPSILON
from contwalk.plugin_check.events import Happening
from contwalk.plugin_check.findings import Report, place_of
from contwalk.plugin_check.motion import MOST_STARTS
from contwalk.plugin_check.orders import conflict, orders_told, results
from contwalk.plugin_check.samples import Samples
from contwalk.plugin_check.states_at_event import ITERATIONS
from contwalk.system import System, Transition


def check_at_one_instant(
    report: Report, system: System, happenings: Sequence[Happening], samples: Samples
) -> None:
    """Report of pairs of transitions out of a mode whether their order matters where both happen at once."""
    machine = hybrid_machine(system, samples.parameters)
    acting = [happening for happening in happenings if happening.transition.role == "hard"]
    for one, other in combinations(acting, 2):
        pair = one.transition, other.transition
        if pair[0].source == pair[1].source and pair[0].guard is not pair[1].guard:
            try:
                _check(report, machine, pair, one.before[:MOST_STARTS], samples)
            except ContwalkError:  # a reset or a field without a value there is told elsewhere
                continue


def _check(
    report: Report,
    machine: HybridMachine,
    pair: tuple[Transition, Transition],
    before: Sequence[tuple[float, np.ndarray]],
    samples: Samples,
) -> None:
    one, other = pair
    flow, system, scale = machine.mode(one.source), machine.system, samples.scales
    met, told = 0, ""
    for t, x in before:
        at = _on_both(flow, pair, t, x, scale)
        if at is None:
            continue
        found = results(machine, t, at, one.source, scale, 0.0, declared=True)
        if not found or len(found[0].order) < 2:
            continue
        met += 1
        apart = conflict(found, scale)
        told = told or ("" if apart is None else orders_told(system, t, *apart, scale))
    what, names = f"transitions '{one.name}' and '{other.name}'", {one.name, other.name}
    declared = names <= {name for each in system.transitions for name in each.together}
    if told:
        report.ok(
            what,
            f"{told} Where a symmetry makes them one, say which acts first with together=(...); elsewhere it "
            "does not matter.",
            place_of(one.reset or one.guard),
        )
    elif met and not declared:
        report.ok(what, f"at one instant they lead to the same in either order, at {met} of {met} states.")


def _on_both(
    flow: ModeFlow, pair: tuple[Transition, Transition], t: float, x: np.ndarray, scale: np.ndarray
) -> np.ndarray | None:
    """The state near x, both of shape (n,), at which both guards are zero; None where none is found."""
    guards = [flow.guards[flow.transitions.index(each)] for each in pair]
    own, at = flow.states, np.array(x, dtype=float)
    for _ in range(ITERATIONS):
        slopes = [guard.slopes(t, at[own], flow.p, np.zeros(len(own))) for guard in guards]
        values = np.array([each.value for each in slopes])
        matrix = np.array([each.gradient[1:] for each in slopes]) * scale[own]
        if not (np.isfinite(values).all() and np.isfinite(matrix).all()):
            return None
        step = np.linalg.lstsq(matrix, -values, rcond=None)[0]
        at[own] += scale[own] * step
        if np.abs(step).max() <= EPSILON * max(float(np.abs(at / scale).max()), 1.0):
            return at
    return None
