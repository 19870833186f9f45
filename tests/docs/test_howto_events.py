"""The pages on friction, relays and clocks: their machines run as they stand, and do what the pages say."""

from __future__ import annotations

import math

import mpmath
import numpy as np
import pytest
from code_blocks import blocks, commands, run_command

import contwalk as cw

pytestmark = pytest.mark.slow

PAGES = {"dry": "docs/howto/friction.md", "relay": "docs/howto/relays.md", "clock": "docs/howto/clocks.md"}
# Along a branch orbits are solved for to a hundred times the accuracy of 1e-8.
WALKED = 1e-6


@pytest.fixture(scope="module")
def ran(tmp_path_factory):
    """The folder after all commands of the pages, and their outputs."""
    where, told = tmp_path_factory.mktemp("events"), {}
    for name, page in PAGES.items():
        (plugin,), (study,) = blocks(page, "python"), blocks(page, "yaml")
        (where / f"{name}.py").write_text(plugin, encoding="utf-8")
        (where / f"{name}.yaml").write_text(study, encoding="utf-8")
        told |= {line: run_command(line, where) for line in commands(page)}
    return where, told


@pytest.mark.parametrize("name", PAGES)
def test_plugins_pass_the_check(ran, name):
    told = ran[1][f"contwalk systems check {name}.py"]
    assert "0 warnings, 0 errors" in told


def test_rest_begins_to_last_where_it_does(ran):
    """From rest, half a period of sliding leads to the image at rest, where the force is that of friction."""
    branches = cw.open_database(ran[0] / "dry.h5").branches()
    assert not [p.name for b in branches for p in b.special_points if p.status != "located"]
    (point,) = [p for p in branches[0].special_points if p.label == "OC"]
    zeta, friction = mpmath.mpf("0.05"), mpmath.mpf("0.3")

    def equations(start, x, omega):
        half, wd = mpmath.pi / omega, mpmath.sqrt(1 - zeta * zeta)
        response = 1 / mpmath.mpc(1 - omega * omega, 2 * zeta * omega)

        def steady(t):
            turning = response * mpmath.expj(omega * t)
            return mpmath.re(turning) + friction, mpmath.re(1j * omega * turning)

        (x0, v0), (x1, v1) = steady(start), steady(start + half)
        a, b = x - x0, (-v0 + zeta * (x - x0)) / wd
        c, s, e = mpmath.cos(wd * half), mpmath.sin(wd * half), mpmath.exp(-zeta * half)
        end, speed = x1 + e * (a * c + b * s), v1 + e * ((wd * b - zeta * a) * c - (wd * a + zeta * b) * s)
        return [end + x, speed, mpmath.cos(omega * start) - x + friction]

    with mpmath.workdps(30):
        truth = float(mpmath.findroot(equations, (0.18, 1.3, 0.51))[2])
    assert abs(point.parameters["omega"] - truth) <= point.error
    assert point.error < 1e-8


def test_the_relay_begins_to_slide_where_it_does(ran):
    """Half a period of x' = A x + B from (0, -1, x3), at the border of sliding, leads to its negative."""
    branches = cw.open_database(ran[0] / "relay.h5").branches()
    assert not [p.name for b in branches for p in b.special_points if p.status != "located"]
    (point,) = [p for b in branches for p in b.special_points if p.label == "OC"]

    def equations(x3, half, zeta):
        a = mpmath.matrix([[-(2 * zeta + 1), 1, 0], [-(2 * zeta + 1), 0, 1], [-1, 0, 0]])
        moved, start = mpmath.expm(a * half), mpmath.matrix([0, -1, x3])
        end = moved * start + mpmath.lu_solve(a, (moved - mpmath.eye(3)) * mpmath.matrix([1, -2, 1]))
        return list(end + start)

    with mpmath.workdps(30):
        truth = float(mpmath.findroot(equations, (-4.8, 3.72, 0.34))[2])
    assert abs(point.parameters["zeta"] - truth) <= point.error
    assert point.error < 1e-8
    without, sliding = branches
    assert without["zeta"].max() == pytest.approx(truth, abs=WALKED)
    assert sliding["zeta"].min() == pytest.approx(truth, abs=WALKED)


def test_the_clock_swings_in_proportion_to_its_push(ran):
    (branch,) = cw.open_database(ran[0] / "clock.h5").branches()
    w = math.sqrt(1.0 - 0.02**2)
    np.testing.assert_allclose(branch["period"], 2.0 * math.pi / w, rtol=WALKED)
    after = branch["push"] / (1.0 - math.exp(-2.0 * math.pi * 0.02 / w))
    quarter = math.atan2(w, 0.02) / w
    largest = after * math.exp(-0.02 * quarter) * math.sin(w * quarter) / w
    np.testing.assert_allclose(branch["max:angle"], largest, rtol=WALKED)
