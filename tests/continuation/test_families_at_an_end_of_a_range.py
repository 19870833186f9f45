"""Two oscillators whose coupling ends at none: there their phases are free, and a family of orbits stays at
the end of the range.
"""

from __future__ import annotations

from hybrid_runs import diagram, machine


def van_der_pol(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = (1.0 - x[0] ** 2) * x[1] - x[0] + p.k * (x[2] - x[0])
    dx[2] = x[3]
    dx[3] = (1.0 - x[2] ** 2) * x[3] - x[2] + p.k * (x[0] - x[2])


def test_a_family_ends_at_once_and_says_that_it_stays_there() -> None:
    in_phase, family = diagram(
        machine(["a", "b", "c", "d"], {"k": -0.1}, {"only": van_der_pol}, []),
        "k",
        (-0.4, 0.0),
        [1.0, 0.0, 1.0, 0.0],
        until="settled",
        accuracy=1e-8,
        follow=["BP"],
    )
    (free,) = (point for point in in_phase.special_points if point.label == "BP")
    assert abs(free.parameters["k"]) <= free.error
    assert (family.outcome.status, family.outcome.reason) == ("complete", "bound")
    assert "stays at the end of the range, k = 0" in family.outcome.message
    assert len(family) < 30
