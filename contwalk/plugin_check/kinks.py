"""Fields that are smooth by pieces only: where they jump, and what a run makes of it, told beforehand."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np

from contwalk.fields.blame import first_switched
from contwalk.fields.switching import Inputs, Switching, choices_of
from contwalk.plugin_check.findings import Report, split_switch
from contwalk.plugin_check.samples import Samples
from contwalk.plugin_check.traced import Traced
from contwalk.problems.kink import CLOCK, REMEDY, FieldKink
from contwalk.problems.kinks import between
from contwalk.system import System


def check_kinks(report: Report, name: str, field: Traced, system: System, samples: Samples) -> None:
    """Tell of jumps of a mode's field, and of its derivatives, between sampled states.

    A machine with transitions may never get there in this mode: then it is no warning.
    """
    if not choices_of(field.program):
        return
    n = len(system.states)
    switching = Switching(field.program, [("x", i) for i in range(n)], ("t", 0))
    mode = system.mode(name)
    given = samples.parameters | dict(mode.constants)
    constants = {("p", k): value for k, value in enumerate(samples.values)}

    def evaluate(_: np.ndarray, places: np.ndarray) -> Inputs:
        return {("x", i): x for i, x in enumerate(places.T[:-1])} | {("t", 0): places[:, -1]} | constants

    def where(before: tuple[float, np.ndarray], after: tuple[float, np.ndarray]) -> str:
        (_, a), (_, b) = before, after
        return first_switched(mode.field, (a[-1], a[:-1].tolist()), (b[-1], b[:-1].tolist()), given)

    places = np.column_stack([[field.given(x) for x in samples.states], samples.times])
    sizes = np.abs(places).max(axis=0)
    found: dict[FieldKink, None] = {}
    for ends in pairwise(places):
        found |= dict.fromkeys(between(switching, evaluate, ends, sizes, where))
    for kink in found:
        place, what = split_switch(kink.where)
        # Unknown durations of legs move what does not depend on a state, and every orbit passes an instant.
        at_instants = kink.order == 0 and not kink.moves
        level = "warning" if kink.order < 2 and (at_instants or not system.acting) else "ok"
        told = replace(kink, moves=True) if system.acting else kink
        report.add(level, f"field of mode '{name}'", _sentence(told, what), place)


def _sentence(kink: FieldKink, what: str) -> str:
    if kink.order == 0 and not kink.moves:
        return f"It jumps at instants of time ({what}): steps are short and rough there. {CLOCK}."
    if kink.order == 0:
        return (
            f"It jumps here ({what}), and an orbit that crosses this place is refused: derivatives of its "
            f"motion would be wrong. {REMEDY}"
        )
    if kink.order == 1:
        return (
            f"Its slopes jump here ({what}): special points of orbits that cross this place may stay "
            f'unlocated. {REMEDY} With role="soft" orbits pass it exactly.'
        )
    return (
        f"Its second derivatives jump here ({what}): cubic coefficients of orbits that cross this place are "
        "not right."
    )
