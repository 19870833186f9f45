"""Going on from a stored point with another free parameter, and homotopy along a line in parameter space."""

import mpmath
import numpy as np
import pytest
from claimed_errors import DIGITS, assert_error_claim
from invariants import check_branch
from plugin_runs import problem_of, run_text, write_plugin
from small_systems import bifurcations, labelled

import contwalk as cw
from contwalk.errors import StartError

CUSP = "dx[0] = p.a + p.b * x[0] - x[0] ** 3\ndx[1] = -x[1] + x[0]"


@pytest.fixture
def first(tmp_path):
    write_plugin(tmp_path, CUSP, "xy", a=-2.0, b=1.0)
    result = run_text(
        tmp_path,
        """start: {state: {x: -1.5, y: -1.5}}
continue: {parameter: a, range: [-2.0, 2.0]}
mark: {a: [0.125]}
""",
        "first",
    )
    check_branch(result.branches[0], problem_of(tmp_path, result, "a"))
    return result


@pytest.mark.drawn(2)
@pytest.mark.parametrize("point", ["LP1", "LP2", "UZ1", "UZ2", "UZ3", "EP1", "EP2", "0", "7", "20"])
def test_from_any_stored_point_with_another_free_parameter(tmp_path, first, point):
    stored = first.branches[0]
    again = run_text(
        tmp_path,
        f"""start: {{from: first.h5, point: b1/{point}}}
continue: {{parameter: b, range: [-1.0, 2.0]}}
""",
        "again",
    )
    (branch,) = again.branches
    problem = problem_of(tmp_path, again, "b")
    check_branch(branch, problem)
    index = int(point) if point.isdigit() else stored.special(point).index
    row = stored.points[index]
    if point.startswith("LP"):
        # The start is a fold of the new branch too: the walk begins beside it and finds it.
        assert any(fold.parameters["b"] == pytest.approx(1.0, rel=1e-15) for fold in labelled(branch, "LP"))
        return
    origin = branch.points[branch["s"] == 0.0][0]
    assert origin["free"][0] == 1.0
    assert branch.info.parameters["a"] == row["free"][0]
    # The corrector finds the stored solution converged, but for a fold, where rounding moves along the null
    # vector.
    assert np.allclose(origin["state"], row["state"], rtol=0.0, atol=1e-7)
    # Along b the cusp's fold at this a is where 4 b^3 = 27 a^2, on the side of the sheet that turns.
    for fold in labelled(branch, "LP"):
        with mpmath.workdps(DIGITS):
            a = mpmath.mpf(float(row["free"][0]))
            assert_error_claim(fold, "b", mpmath.cbrt(27 * a**2 / 4))


@pytest.mark.long
def test_the_same_free_parameter_goes_on_from_the_stored_value(tmp_path, first):
    again = run_text(
        tmp_path,
        """start: {from: first.h5, point: b1/LP1}
continue: {parameter: a, range: [-2.0, 2.0]}
""",
        "again",
    )
    (branch,) = again.branches
    check_branch(branch, problem_of(tmp_path, again, "a"))
    old = first.branches[0]
    assert sorted(branch["x"][[0, -1]]) == pytest.approx(sorted(old["x"][[0, -1]]), rel=1e-12)
    # The other fold lies on the branch in any case; the one at the start may or may not be named again.
    assert any(q.state["x"] == old.special("LP2").state["x"] for q in labelled(branch, "LP"))


def test_a_point_that_does_not_exist(tmp_path, first):
    for point in ("b1/HB1", "b1/99999", "b7/LP1"):
        with pytest.raises(cw.ContwalkError) as caught:
            run_text(
                tmp_path,
                f"""start: {{from: first.h5, point: {point}}}
continue: {{parameter: b, range: [-1.0, 2.0]}}
""",
                "never",
            )
        assert isinstance(caught.value, StartError) or "b7" in str(caught.value)
    assert not (tmp_path / "never.h5").exists()


def test_a_path_between_two_parameter_sets(tmp_path):
    """a = -1 + 2 s, b = 1/2 + s: folds where 4 (1/2 + s)^3 = 27 (2 s - 1)^2."""
    write_plugin(tmp_path, CUSP, "xy", a=0.0, b=0.0)
    result = run_text(
        tmp_path,
        """start: {state: {x: -1.2, y: -1.2}}
path: {from: {a: -1.0, b: 0.5}, to: {a: 1.0, b: 1.5}}
""",
    )
    (branch,) = result.branches
    system = cw.load_system(str(tmp_path / "small.py"))
    problem = cw.Equilibrium(system, system.defaults(), "path", ({"a": -1.0, "b": 0.5}, {"a": 1.0, "b": 1.5}))
    check_branch(branch, problem)
    assert branch.info.free == ("path",)
    assert (branch["path"][0], branch["path"][-1]) == (0.0, 1.0)
    with mpmath.workdps(DIGITS):
        # 4 b^3 = 27 a^2 along the line: roots by NumPy, each to 50 digits by Newton's method.
        rough = np.roots([4.0, 12.0 * 0.5 - 108.0, 12.0 * 0.25 + 108.0, 4.0 * 0.125 - 27.0])
        inside = sorted(
            mpmath.findroot(lambda s: 4 * (s + 0.5) ** 3 - 27 * (2 * s - 1) ** 2, r.real)
            for r in rough
            if r.imag == 0.0 and 0.0 < r.real < 1.0
        )
    folds = bifurcations(branch)
    assert [q.label for q in folds] == ["LP", "LP"]
    assert len(inside) == 2
    for fold, root in zip(folds, reversed(inside), strict=True):
        along = float(branch["path"][fold.index])
        assert abs(mpmath.mpf(along) - root) <= fold.error <= 1e3 * np.finfo(float).eps
        # Its parameters are those on the line.
        assert fold.parameters["a"] == pytest.approx(-1.0 + 2.0 * along, rel=1e-14)
        assert fold.parameters["b"] == pytest.approx(0.5 + along, rel=1e-14)


def test_a_path_of_a_linear_system_is_the_closed_form(tmp_path):
    """x = (1 + s) / (2 + 3 s) at stiffness 2 + 3 s and load 1 + s."""
    write_plugin(tmp_path, "dx[0] = p.load - p.stiffness * x[0]", "x", load=1.0, stiffness=2.0)
    result = run_text(
        tmp_path,
        """start: {state: {x: 0.5}}
path: {from: {load: 1.0, stiffness: 2.0}, to: {load: 2.0, stiffness: 5.0}}
mark: {path: [0.5]}
""",
    )
    (branch,) = result.branches
    s = branch["path"]
    assert np.allclose(branch["x"], (1.0 + s) / (2.0 + 3.0 * s), rtol=1e-14)
    assert np.allclose(branch["max_re"], -(2.0 + 3.0 * s), rtol=1e-14)
    (middle,) = labelled(branch, "UZ")
    assert (middle.parameters["load"], middle.parameters["stiffness"]) == (1.5, 3.5)
