"""How long a critical vector is, as records count it: over the orbit, in halves of the states' ranges."""

from __future__ import annotations

import numpy as np

from contwalk.verification.equations import Evaluation
from contwalk.verification.finding import CannotTell
from contwalk.verification.normal_forms import Told
from contwalk.verification.orbit import OrbitEquations
from contwalk.verification.passage import EPSILON


def squared(equations: OrbitEquations, at: Evaluation, q: np.ndarray, known: float = 0.02) -> Told:
    """The mean square, over the closure and across the flow, of the deviation that starts as q, (n,).

    Of complex q, of both its parts together. The error is what half as many instants make of the integral, or
    `known` of it, to which records know it: they count it at some instants.

    Raises
    ------
    CannotTell
        If the machine has events, the orbit closes up to a symmetry, or a state does not move on it.
    """
    if equations.functions.system.transitions or equations.image:
        raise CannotTell("Deviations are not measured through events or symmetries.")
    (leg,), p = at.legs, equations.functions.parameters.at(equations.free)
    half = 0.5 * np.ptp(np.vstack([piece.states for piece in leg.pieces]), axis=0)
    if not np.all(half > EPSILON**0.5 * equations._scale(leg.mode)):
        raise CannotTell("A state that rests on the orbit has no range.")
    field, times, squares, own = equations.functions.field(leg.mode), list[float](), list[float](), q
    for piece in leg.pieces:
        for t, x, moved in zip(piece.times, piece.states, piece.tangents, strict=True):
            deviation = (moved[:, 1 : 1 + len(x)] @ own) / half
            if not equations.forced:
                flow = field(t, x, p)[0] / half
                deviation = deviation - flow * (flow @ deviation) / (flow @ flow)
            times.append(float(t))
            squares.append(float(np.vdot(deviation, deviation).real))
        own = piece.derivative[:, 1 : 1 + len(own)] @ own
    whole, rough = (np.trapezoid(squares[::k], times[::k]) / leg.duration for k in (1, 2))
    return Told(float(whole), max(abs(float(whole - rough)), known * abs(float(whole))))
