"""Two phosphorylations by one kinase and one phosphatase (Markevich, Hoek, Kholodenko, J. Cell Biol. 164,
2004, 353): complexes form and fall apart as fast as one likes, beside totals that nobody declares.
"""

from __future__ import annotations

import mpmath
import numpy as np
import pytest
from small_systems import labelled, small_problem

import contwalk as cw
from contwalk.problems.equilibrium.conserved_sums import conserved_sums

STATES = ("M", "Mp", "Mpp", "K", "MK", "MpK", "P", "MppP", "MpP")
START = [500.0, 0.0, 0.0, 50.0, 0.0, 0.0, 100.0, 0.0, 0.0]
TOTALS = {"substrate": "M Mp Mpp MK MpK MppP MpP", "kinase": "K MK MpK", "phosphatase": "P MppP MpP"}


def reactions(x, k2, fast):
    """Rates of all eight, in the order of Markevich's table 1."""
    m, mp, mpp, k, mk, mpk, p, mppp, mpph = x
    binding = (0.02 * m * k - mk, 0.032 * mp * k - mpk, 0.045 * mpp * p - mppp, 0.01 * mp * p - mpph)
    return [fast * each for each in binding], [k2 * mk, 15.0 * mpk, 0.092 * mppp, 0.5 * mpph]


def changes(x, k2, fast):
    (v1, v3, w1, w3), (v2, v4, w2, w4) = reactions(x, k2, fast)
    return [-v1 + w4, v2 - v3 + w2 - w3, v4 - w1, -v1 + v2 - v3 + v4, v1 - v2, v3 - v4,
            -w1 + w2 - w3 + w4, w1 - w2, w3 - w4]  # fmt: skip


def field(t, x, p, dx):
    for i, change in enumerate(changes([x[k] for k in range(9)], p.k2, p.fast)):
        dx[i] = change


def problem(fast: float) -> cw.Equilibrium:
    return small_problem(field, STATES, {"k2": 0.01, "fast": fast}, "k2")


@pytest.mark.parametrize("fast", [1.0, 1e3, 1e6, 1e9, 1e12])
def test_the_totals_are_found_whatever_the_fast_ones_keep_by_themselves(fast):
    found = conserved_sums(problem(fast), np.array([*START, 0.01]))
    weights = [[float(name in total.split()) for name in STATES] for total in TOTALS.values()]
    assert sorted(found.tolist()) == sorted(weights)


def fold_near(k2: float, state: np.ndarray, fast: float) -> float:
    """The fold at these totals by 30 digits: F = 0 and F' q = 0, q of unit length, seven states free."""
    own = [i for i, name in enumerate(STATES) if name not in ("K", "P")]

    def whole(y):
        x = dict(zip(own, y, strict=True))
        x[3] = 50 - x[4] - x[5]
        x[6] = 100 - x[7] - x[8]
        return [x[i] for i in range(9)]

    def equations(y, k):
        dx = changes(whole(y), k, mpmath.mpf(fast))
        balance = sum(y) - 500
        return [dx[0], dx[2], dx[4], dx[5], dx[7], dx[8], balance]

    with mpmath.workdps(50):
        step = mpmath.mpf(10) ** -20

        def along(y, q, k):
            ahead, behind = (
                equations([a + s * step * b for a, b in zip(y, q, strict=True)], k) for s in (1, -1)
            )
            return [(a - b) / (2 * step) for a, b in zip(ahead, behind, strict=True)]

        def system(*u):
            y, q, k = u[:7], u[7:14], u[14]
            return [*equations(y, k), *along(y, q, k), sum(a * a for a in q) - 1]

        y = [mpmath.mpf(float(state[i])) for i in own]
        jacobian = np.array(
            [[float(v) for v in along(y, row, mpmath.mpf(k2))] for row in np.eye(7).tolist()]
        ).T
        units = np.abs(jacobian).max(axis=1)
        q = np.linalg.svd(jacobian / units[:, None])[2][-1]
        found = mpmath.findroot(system, [*y, *(mpmath.mpf(float(v)) for v in q), mpmath.mpf(k2)], tol=1e-40)
        return float(found[14])


@pytest.mark.slow
@pytest.mark.parametrize("fast", [1.0, 1e2, 1e5, 1e8])
def test_both_folds_are_where_forty_digits_have_them(fast):
    """A force that is held at zero moved by rounding and set the scale: the branch was told to be closed."""
    branch = cw.continue_branch(problem(fast), START, (1e-4, 1.0))
    assert branch.outcome.reason == "bound", branch.outcome.message
    folds = labelled(branch, "LP")
    assert [(p.status, p.unstable_before, p.unstable_after) for p in folds] == [
        ("located", 0, 1),
        ("located", 1, 0),
    ]
    for fold in folds:
        exact = fold_near(fold.parameters["k2"], np.array(fold.unknowns)[:9], fast)
        assert fold.parameters["k2"] == pytest.approx(exact, abs=max(fold.error, 4.0 * np.spacing(exact)))
