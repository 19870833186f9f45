"""Equilibria on an isotropic suspension with all masses on the line AB.

They are those of sections 5.2 and 7.2 and of Appendix A, with the misprints corrected.

With `net` masses more on one side than on the other, all are given by one equation for the angle beta of
the majority,

    K m e sin(beta) + c omega m e cos(beta) + net c omega m1 l1 = 0,    K = k - omega^2 M'.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from contwalk.system import Start

from .balanced import state


def make_on_the_line(n: int) -> tuple[Start, ...]:
    """The named equilibria of n masses on the line AB."""
    opposite = tuple(
        Start(
            "opposite" if i == 1 else f"opposite_{i}",
            _on_the_line(n, i),
            about=f"{n - i} together, the last {i} opposite them (two roots)",
            exists=_existence(n - 2 * i),
        )
        for i in range(1, n // 2 + 1)
    )
    together = Start(
        "together",
        _on_the_line(n, 0),
        about="all masses at one angle: first the root away from the unbalance (type 2), "
        "then the root near it (type 3)",
        exists=_existence(n),
    )
    return (together, *opposite)


def _existence(net: int) -> str:
    if net == 0:
        return "everywhere but at an undamped resonance"
    return f"where |m e| sqrt((k - omega^2 M')^2 + (c omega)^2) >= {net} c omega m1 l1 > 0"


def _on_the_line(n: int, opposite: int) -> Callable[..., list[list[float]]]:
    """All masses on the line AB, the last `opposite` of them on the other side."""
    net = n - 2 * opposite

    def states(p: Any) -> list[list[float]]:
        stiffness = p.k - p.omega * p.omega * (p.M + p.m + n * p.m1)
        damping = p.c * p.omega
        if stiffness == 0.0 and damping == 0.0:
            return []
        load, moment = p.m * p.e, net * p.m1 * p.l1
        if net == 0:
            # The load is a common factor; mass 1 lies where AB of the rotor alone points: equation 23.
            towards = math.atan2(-damping, stiffness)
            roots = [towards, towards + math.pi]
        else:
            roots = _roots(load, moment, stiffness, damping)
        found = []
        for root in roots:
            beta = math.remainder(root, 2.0 * math.pi)
            unbalance = complex(load + moment * math.cos(beta), moment * math.sin(beta))
            q = p.omega * p.omega * unbalance / complex(stiffness, damping)
            found.append(state(n, q, [beta] * (n - opposite) + [beta + math.pi] * opposite))
        return found

    return states


def _roots(load: float, moment: float, stiffness: float, damping: float) -> list[float]:
    """Both roots of load (stiffness sin(beta) + damping cos(beta)) + damping moment = 0, or none.

    The first is the one away from the unbalance. Written with atan2, the solution holds at stiffness = 0 too.
    """
    # square = (load stiffness)^2 + (load damping)^2 - (damping moment)^2, negative beyond the fold. As
    # products of sums and differences it keeps its digits where full load and resonance are both near.
    turned = abs(load * stiffness)
    excess = (moment - abs(load)) * (moment + abs(load))
    if excess > 0.0:
        limit = abs(damping) * math.sqrt(excess)
        square = (turned - limit) * (turned + limit)
    else:
        square = turned * turned - damping * damping * excess
    if square < 0.0:
        return []
    middle = math.atan2(load * stiffness, load * damping)
    half = math.atan2(math.sqrt(square), -damping * moment)
    side = 1.0 if stiffness >= 0.0 else -1.0
    return [middle + side * half, middle - side * half]
