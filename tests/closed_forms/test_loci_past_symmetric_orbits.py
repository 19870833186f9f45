"""Curves of folds of orbits that pass an orbit of which a symmetry keeps a state at zero, in closed form.

r' = r (1 - r^2 - u^2) and u' = mu u - u^3 + eps + 25 (r^2 - 1) u: cycles r^2 = 1 - u^2 at eps = 26 u^3 - mu u
fold at mu = 78 u^2, eps = -52 u^3, and where u = 0 their curve has a cusp. The state is w = u (1 + x / 2).
"""

from __future__ import annotations

import math

import numpy as np
from loci_of_orbits import FINE, WALKED, assert_at, labels, largest, orbits
from small_systems import small_system

import contwalk as cw


def field(t, x, p, dx):
    r, c = x[0] ** 2 + x[1] ** 2, 1.0 + 0.5 * x[0]
    u = x[2] / c
    g = 1.0 - r - u**2
    dx[0] = g * x[0] - 3.0 * x[1]
    dx[1] = 3.0 * x[0] + g * x[1]
    dx[2] = (p.mu * u - u**3 + p.eps + 25.0 * (r - 1.0) * u) * c + 0.5 * u * dx[0]


def test_the_cusp_of_folds_is_one_point():
    u = 0.06
    x, mu = math.sqrt(1.0 - u**2), 83.0 * u**2
    system = small_system(field, "xyw", {"mu": mu, "eps": 26.0 * u**3 - mu * u})
    start = [x, 0.0, u * (1.0 + 0.5 * x)]
    branch = cw.continue_branch(orbits(system, "mu"), start, (0.1, 0.4), period=2.0 * np.pi / 3.0)
    ranges = {"mu": (-0.1, 0.5), "eps": (-0.04, 0.04)}
    curve = cw.continue_locus(system, branch, "LP1", ranges, discretization=FINE["discretization"])
    assert labels(curve) == ["CPC"]
    assert_at(curve, "CPC", [(0.0, 0.0)])
    states = curve.points["state"]
    u = states[:, 2] / (1.0 + 0.5 * states[:, 0])
    assert largest(curve["mu"] - 78.0 * u**2) < WALKED
    assert largest(curve["eps"] + 52.0 * u**3) < WALKED
