"""The autobalancer at speeds up to 1e8 and loads from nothing to full: how well its eigenvalues are known."""

from types import SimpleNamespace

import mpmath
import numpy as np
import pytest
from invariants import check_branch
from small_systems import labelled

import contwalk as cw
from contwalk.system import load_system

# At omega = 1e8 terms of 1e16 cancel to rates of order one: 60 digits leave 28 of them.
DIGITS = 60


def _matrix(values, x):
    """df/dx of the autobalancer with two masses, in `mpmath` numbers; a balanced state has q = 0 and no
    rates.

    Equations of motion linearised by hand: with the ring's acceleration a = q'' + 2 i w q' - w^2 q,
    M' a = m e w^2 - c (q' + i w q) - k q + m1 l1 sum ((b_j' + w)^2 - i b_j'') exp(i b_j),
    (m1 + J) l1 b_j'' = m1 (a_1 sin b_j - a_2 cos b_j) - (delta + gamma) l1 b_j'.
    """
    p = SimpleNamespace(**{name: mpmath.mpf(value) for name, value in values.items()})
    w, size = p.omega, 8
    total = p.M + p.m + 2 * p.m1
    angles = [mpmath.mpf(v) for v in x[2:4]]
    # Unknowns (a1, a2, b1'', b2'') in terms of (q1, q2, b1, b2, q1', q2', b1', b2'): mass . y = right . state
    mass, right = mpmath.zeros(4, 4), mpmath.zeros(4, size)
    mass[0, 0] = mass[1, 1] = total
    right[0, 0], right[0, 1], right[0, 4] = -p.k, p.c * w, -p.c
    right[1, 0], right[1, 1], right[1, 5] = -p.c * w, -p.k, -p.c
    for j, angle in enumerate(angles):
        sine, cosine = mpmath.sin(angle), mpmath.cos(angle)
        moment = p.m1 * p.l1
        mass[0, 2 + j], mass[1, 2 + j] = -moment * sine, moment * cosine
        right[0, 2 + j], right[0, 6 + j] = -moment * w * w * sine, 2 * moment * w * cosine
        right[1, 2 + j], right[1, 6 + j] = moment * w * w * cosine, 2 * moment * w * sine
        mass[2 + j, 0], mass[2 + j, 1] = -p.m1 * sine, p.m1 * cosine
        mass[2 + j, 2 + j] = (p.m1 + p.J) * p.l1
        right[2 + j, 6 + j] = -(p.delta + p.gamma) * p.l1
    # The ring's acceleration at the equilibrium is not exactly zero for a state rounded to floats: it turns
    # the pull.
    force = [
        p.m * p.e * w * w - p.k * mpmath.mpf(x[0]) + p.c * w * mpmath.mpf(x[1]),
        -p.k * mpmath.mpf(x[1]) - p.c * w * mpmath.mpf(x[0]),
    ]
    for angle in angles:
        force[0] += p.m1 * p.l1 * w * w * mpmath.cos(angle)
        force[1] += p.m1 * p.l1 * w * w * mpmath.sin(angle)
    rest = mpmath.lu_solve(mass, mpmath.matrix([force[0], force[1], 0, 0]))
    for j, angle in enumerate(angles):
        sine, cosine = mpmath.sin(angle), mpmath.cos(angle)
        right[0, 2 + j] += p.m1 * p.l1 * rest[2 + j] * cosine
        right[1, 2 + j] += p.m1 * p.l1 * rest[2 + j] * sine
        right[2 + j, 2 + j] += p.m1 * (rest[0] * cosine + rest[1] * sine)
    solved = mass**-1 * right
    a = mpmath.zeros(size, size)
    for i in range(4):
        a[i, 4 + i] = 1
        for k in range(size):
            a[4 + i, k] = solved[i, k]
    a[4, 0] += w * w
    a[4, 5] += 2 * w
    a[5, 1] += w * w
    a[5, 4] -= 2 * w
    return a


def _true_max_re(values, state):
    with mpmath.workdps(DIGITS):
        x = list(state)
        found = mpmath.eig(_matrix(values, x), left=False, right=False)
        return float(max(mpmath.re(v) for v in found))


def _autobalancer(**changes):
    system = load_system("autobalancer")
    return system, {**system.defaults(), **changes}


@pytest.mark.drawn(1)
@pytest.mark.parametrize("omega", [1e3, 1e5, 1e6, 1e8])
def test_the_stored_error_bounds_the_true_error_of_max_re(omega):
    system, values = _autobalancer(omega=omega)
    problem = cw.Equilibrium(system, values, "omega")
    branch = cw.continue_branch(problem, "balanced", (omega / 1.5, omega * 1.5))
    assert branch.outcome.reason == "bound"
    for i in range(0, len(branch), max(1, len(branch) // 12)):
        row = branch.points[i]
        true = _true_max_re({**values, "omega": float(row["free"][0])}, row["state"])
        found, error = float(branch["max_re"][i]), float(row["spectrum_error"])
        assert abs(found - true) <= error, f"{found} is off by {found - true:.1e}, estimate {error:.1e}"
        # An estimate of use: not more than a thousand roundings of the largest entries, omega^2.
        assert error <= 1e3 * max(abs(found - true), 1e-16 * omega**2)


def test_moderate_speeds_pass_every_invariant():
    system, values = _autobalancer(omega=5.0)
    problem = cw.Equilibrium(system, values, "omega")
    branch = cw.continue_branch(problem, "balanced", (1.5, 6.0))
    check_branch(branch, problem)
    row = branch.points[len(branch) // 3]
    true = _true_max_re({**values, "omega": float(row["free"][0])}, row["state"])
    assert abs(float(row["spectrum"][0].real) - true) <= row["spectrum_error"]


def test_a_vanishing_load():
    """For m -> 0 the leading eigenvalue is nearly -2551 m^2: the rotor turns freely round a load of
    nothing.
    """
    system, values = _autobalancer(omega=5.0, m=1e-4)
    problem = cw.Equilibrium(system, values, "m")
    branch = cw.continue_branch(problem, "balanced", (1e-9, 1e-4))
    assert branch.outcome.reason == "bound"
    for i in range(0, len(branch), max(1, len(branch) // 10)):
        row, load = branch.points[i], float(branch["m"][i])
        true = _true_max_re({**values, "m": load}, row["state"])
        assert abs(branch["max_re"][i] - true) <= row["spectrum_error"]
        assert true == pytest.approx(-2551.0 * load**2, rel=1e-3, abs=2.0 * row["spectrum_error"])
        # Where it is less than what rounding leaves of it, its sign is not known.
        assert (branch["unstable"][i] == -1) == (abs(true) <= row["spectrum_error"])
    assert labelled(branch, "HB", "LP", "BP") == []
    assert set(branch["unstable"]) == {-1, 0}


def test_a_load_up_to_nearly_the_full_capacity():
    """At m = 2 m1 l1 both masses lie opposite the load; 1e-8 below it the square root is still walked."""
    system, values = _autobalancer(omega=5.0)
    full = 2.0 * values["m1"] * values["l1"] / values["e"]
    problem = cw.Equilibrium(system, values, "m")
    branch = cw.continue_branch(problem, "balanced", (values["m"], full - 1e-8), direction="forward")
    check_branch(branch, problem)
    assert branch.outcome.reason == "bound"
    assert branch["m"][-1] == full - 1e-8
    half = np.arccos((full - 1e-8) / full)
    assert abs(abs(branch["beta1"][-1] - np.pi) - half) < 1e-9  # rounding of m over sin(half) = 1e-3
