"""Tongues of parametric resonance that are much narrower than a step: at rest two multipliers, or pairs, run
into each other far inside the unit circle, and are beyond it for a while.

x'' + 0.02 x' + (1 + e cos(w t)) x + x^3 = 0 doubles its period about w = 2 where e is above 0.04, and two
such oscillators, of frequencies 1 and sqrt(2.4), coupled by e cos(w t), go around a torus about their sum.
The values are those of a fundamental matrix by SciPy's DOP853 at 1e-13, and of Brent's method.
"""

from __future__ import annotations

import math

import pytest
from hybrid_runs import diagram, machine


def mathieu(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = -0.02 * x[1] - (1.0 + p.e * math.cos(p.w * t)) * x[0] - x[0] ** 3


def two(t, x, p, dx):
    coupling = p.e * math.cos(p.w * t)
    dx[0] = x[1]
    dx[1] = -0.02 * x[1] - x[0] - coupling * x[2] - x[0] ** 3
    dx[2] = x[3]
    dx[3] = -0.02 * x[3] - 2.4 * x[2] - coupling * x[0] - x[2] ** 3


TONGUES = [
    (mathieu, 2, (1.2, 3.0), 0.0402, "PD", (1.9978458240773511, 2.0018532134061475)),
    (mathieu, 2, (1.2, 3.0), 0.04001, "PD", (1.9993972134569886, 2.000302775557657)),
    (mathieu, 2, (1.2, 3.0), 0.0400001, "PD", (1.9997663794823672, 1.9999336589887247)),
    (two, 4, (2.2, 3.0), 0.0505, "NS", (2.5456729607778024, 2.5524684769372445)),
    (two, 4, (2.2, 3.0), 0.04979, "NS", (2.5488382198076778, 2.5493054696354505)),
]


@pytest.mark.parametrize(("field", "states", "range", "e", "label", "edges"), TONGUES)
def test_both_edges_are_located(field, states, range, e, label, edges) -> None:
    forced = machine(
        ["x", "v", "y", "u"][:states],
        {"w": range[0], "e": e},
        {"only": field},
        [],
        period=lambda p: 2.0 * math.pi / p.w,
    )
    (branch,) = diagram(forced, "w", range, [0.0] * states, accuracy=1e-8)
    found = [point for point in branch.special_points if point.label == label]
    assert len(found) == 2
    for point, edge in zip(found, edges, strict=True):
        assert abs(point.parameters["w"] - edge) <= point.error + 1e-11
    many = {"PD": 1, "NS": 2}[label]
    assert [(point.unstable_before, point.unstable_after) for point in found] == [(0, many), (many, 0)]
