"""Phase planes against closed forms: equilibria, rates and manifolds of a double well; what is refused."""

from __future__ import annotations

import numpy as np
import pytest

import contwalk as cw
from contwalk.cli.entry import run
from contwalk.errors import ContwalkError
from contwalk.workflow.phase_plane import plane_of

WELL = cw.system_from_text("x' = v; v' = x - x^3 - d*v; d = 0")
WINDOW = np.array([[-1.8, 1.8], [-1.2, 1.2]])
RUN = """
system: {equations: "x' = v; v' = x - x^3 - d*v; d = 0.3"}
start: {state: {x: 1.0, v: 0.0}}
continue: {parameter: d, range: [0.1, 1.0]}
output: well.h5
"""


def well(d):
    return plane_of(WELL, {"d": d}, ["x", "v"], np.zeros(2), WINDOW)


def test_equilibria_of_a_double_well():
    """(0, 0) is a saddle with the eigenvalues (-d +- sqrt(d^2 + 4)) / 2; (+-1, 0) are stable."""
    rests = sorted(well(0.5).rests, key=lambda rest: rest.place[0])
    np.testing.assert_allclose([rest.place for rest in rests], [[-1, 0], [0, 0], [1, 0]], atol=1e-9)
    assert [rest.stable for rest in rests] == [True, False, True]
    assert [rest.saddle for rest in rests] == [False, True, False]
    expected = (-0.5 + np.array([-1.0, 1.0]) * np.sqrt(4.25)) / 2
    np.testing.assert_allclose(np.sort(rests[1].eigenvalues.real), expected, rtol=1e-7)


def test_manifolds_without_friction_lie_on_the_energy_of_the_saddle():
    """v^2/2 - x^2/2 + x^4/4 = 0, to what their beginning off the saddle and the integrator leave."""
    ways = well(0.0).manifolds
    assert [unstable for _, unstable in ways].count(True) == 2
    assert len(ways) == 4
    for curve, _ in ways:
        x, v = curve.T
        assert np.ptp(x) > 1.4  # out to the turning point, sqrt(2)
        np.testing.assert_allclose(v**2 / 2 - x**2 / 2 + x**4 / 4, 0.0, atol=1e-5)


def test_rates_of_the_grid_are_those_of_the_field():
    plane = well(0.5)
    x, v = np.meshgrid(plane.x, plane.y)
    np.testing.assert_allclose(plane.rates[..., 0], v, atol=1e-15)
    np.testing.assert_allclose(plane.rates[..., 1], x - x**3 - 0.5 * v, atol=1e-14)


def test_a_third_state_is_held_and_equilibria_are_left_out():
    lorenz = cw.system_from_text("x' = 10*(y - x); y' = r*x - y - x*z; z' = x*y - 8/3*z; r = 28")
    plane = plane_of(lorenz, {"r": 28.0}, ["x", "z"], np.array([0.0, 2.0, 0.0]), 30 * WINDOW)
    x, z = np.meshgrid(plane.x, plane.y)
    np.testing.assert_allclose(plane.rates[..., 0], 10 * (2.0 - x), atol=1e-12)
    np.testing.assert_allclose(plane.rates[..., 1], 2.0 * x - 8 / 3 * z, atol=1e-12)
    assert plane.rests == plane.manifolds == ()


@pytest.mark.parametrize(
    "text",
    [
        "x' = v; v' = -x + cos(t); period = 2*pi; a = 1",
        "x' = v; v' = -x; a = 1; event hit: x falls, v = -v",
        "x+ = a*x*(1 - x) - y; y+ = x; a = 3",
    ],
)
def test_what_has_no_one_field_is_refused(text):
    system = cw.system_from_text(text)
    names = system.state_names
    with pytest.raises(ContwalkError, match="has no one field that holds at all times"):
        plane_of(system, {"a": 1.0}, names, np.zeros(2), WINDOW)


def test_command(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "well.yaml").write_text(RUN, encoding="utf-8")
    assert run(["continue", "well.yaml", "--quiet"]) == 0
    plot = ["plot", "well.h5", "--kind", "phase_plane"]
    assert run([*plot, "-o", "plane.png"]) == 0
    assert (tmp_path / "plane.png").stat().st_size > 0
    capsys.readouterr()
    for more, said in (
        (["-x", "v", "-y", "v"], "A phase plane has two states, not v and v."),
        (["-x", "d"], "Name two of x, v with -x and -y."),
        (["--point", "b1/0", "--point", "b1/3"], "The points are at different parameters: d differs."),
    ):
        assert run([*plot, *more, "-o", "other.png"]) == 2
        assert said in capsys.readouterr().err
    assert not (tmp_path / "other.png").exists()


def test_nullclines_are_on_the_zeros():
    plane = well(0.5)
    x, v = np.vstack(plane.nullclines[1]).T
    np.testing.assert_allclose(v, 2.0 * (x - x**3), atol=2e-4)
    assert np.ptp(x) > 2.4  # |v| is 1.2 at |x| = 1.221
    assert np.vstack(plane.nullclines[0])[:, 1] == pytest.approx(0.0, abs=1e-8)


@pytest.mark.parametrize("other", ["1/(x + 0.3) - 2", "abs(x + 0.3)/(x + 0.3) - 0.5*(x - 0.2)/abs(x - 0.2)"])
def test_a_rate_that_changes_its_sign_at_a_pole_or_a_jump_has_no_nullcline_there(other):
    """1/(x + 0.3) is 2 at 0.2; a sum of a sign and half a sign is nowhere zero."""
    system = cw.system_from_text(f"x' = {other}; y' = x - y; a = 1")
    (across, other_null) = plane_of(system, {"a": 1.0}, ["x", "y"], np.zeros(2), WINDOW).nullclines
    found = np.vstack([*across, np.empty((0, 2))])[:, 0]
    assert found == pytest.approx(0.2, abs=1e-4)
    assert len(found) == (0 if "abs" in other else 161)
    assert np.ptp(np.vstack(other_null)[:, 0]) > 2.0
