"""The short forms of Python: what they make is a system like any other, and finds the same."""

from __future__ import annotations

import gc
import math

import numpy as np
import pytest
import sympy as sp

import contwalk as cw
from contwalk.errors import ContwalkError, StartError, SystemDefinitionError
from contwalk.system import Mode, Parameter, State, System

TEXT = "x' = A - (B + 1)*x + x^2*y; y' = B*x - x^2*y; A = 1; B = 1.5"


@cw.model(A=1.0, B=1.5)
def brusselator(x, y, *, A, B):
    return A - (B + 1) * x + x**2 * y, B * x - x**2 * y


def field(t, x, p, dx):
    dx[0] = p.A - (p.B + 1) * x[0] + x[0] ** 2 * x[1]
    dx[1] = p.B * x[0] - x[0] ** 2 * x[1]


PLUGIN = System(
    "brusselator",
    states=(State("x"), State("y")),
    parameters=(Parameter("A", 1.0), Parameter("B", 1.5)),
    modes=(Mode("only", field),),
)
x, y, A, B = sp.symbols("x y A B")
SYMPY = cw.system_from_sympy([x, y], [A - (B + 1) * x + x**2 * y, B * x - x**2 * y], {A: 1.0, B: 1.5})


@pytest.mark.parametrize("system", [brusselator, cw.system_from_text(TEXT), PLUGIN, SYMPY], ids=str)
def test_each_form_finds_the_hopf_point_from_nothing(system):
    found = cw.diagram(system, "B", (1, 4), diagram="none")
    assert found["b1/HB1"].parameters["B"] == pytest.approx(2.0, abs=1e-12)
    assert found["b1/HB1"].criticality == "supercritical"
    assert found.start == "the simulation from the origin until settled"


@pytest.fixture(scope="module")
def found():
    return cw.diagram(brusselator, "B", (1, 4))


def test_what_a_diagram_is(found, tmp_path):
    assert [branch.name for branch in found] == ["b1", "b2"]
    assert len(found) == 2
    assert found["b2"].info.parent[0] == "b1"
    assert set(found.special_points) >= {"b1/HB1", "b2/EP1"}
    assert repr(found).splitlines()[1].startswith("b1: ")
    assert "<table" in found._repr_html_()
    axes = found.plot("x")
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("B", "x, largest and least")
    assert found.save(tmp_path / "x.png").stat().st_size > 1000
    kept = cw.open_database(found.save(tmp_path / "x.h5"))
    assert [branch.name for branch in kept] == ["b1", "b2"]
    for name in ("b7", "b1/XX1"):
        with pytest.raises(KeyError, match="Known: "):
            found[name]
    with pytest.raises(ContwalkError, match="neither a database nor a figure"):
        found.save(tmp_path / "x.txt")


def test_a_diagram_is_a_page_too(found):
    page = cw.explore(found)
    assert page.lower().startswith("<!doctype html>")
    assert page == cw.explore(found.database)


def test_files_of_a_diagram_go_with_it():
    here = cw.diagram(brusselator, "B", (1, 1.5), diagram="none")
    folder = here.path.parent
    assert folder.exists()
    del here
    gc.collect()
    assert not folder.exists()


def test_a_start_that_was_far_says_how_far():
    far = cw.diagram(brusselator, "B", (1, 1.8), start={"x": 1.5, "y": 1.0}, diagram="none")
    assert far.start == "the solution near the given state (x moved by -0.5)"


def test_a_forced_system():
    @cw.model(d=0.3, g=0.2, w=1.2, start={"x": 1.0}, period=lambda w: 2 * math.pi / w)
    def duffing(x, v, t, *, d, g, w):
        return v, -d * v + x - x**3 + g * math.cos(w * t)

    found = cw.diagram(duffing, "g", (0.1, 0.3), diagram="none")
    assert found.start == "the simulation from the declared state until settled"
    assert found["b1"].info.problem == "periodic_orbit"
    text = cw.system_from_text(
        "x' = v; v' = -d*v + x - x^3 + g*cos(w*t); d = 0.3; g = 0.2; w = 1.2; period = 2*pi/w; x(0) = 1"
    )
    other = cw.diagram(text, "g", (0.1, 0.3), diagram="none")
    assert other["b1/PD1"].parameters["g"] == pytest.approx(found["b1/PD1"].parameters["g"], rel=1e-9)


def test_one_state_and_defaults_of_the_functions_own():
    @cw.model
    def fork(x, *, r=-1.0):
        """A pitchfork."""
        return r * x - x**3

    assert fork.defaults() == {"r": -1.0}
    assert cw.diagram(fork, "r", (-1, 1), diagram="none")["b1/BP1"].kind == "pitchfork"


def test_sympy_says_what_it_said():
    s = sp.Symbol("t")
    X, V = sp.Function("X")(s), sp.Function("V")(s)
    w, lam = sp.symbols("w lambda")
    right = -sp.Rational(1, 3) * V / sp.sqrt(1 + X**2) - sp.exp(-X) / X**2 + lam * sp.cos(w * s)
    right += sp.Piecewise((X, X > 1), (sp.Abs(V) ** 1.5, True)) + sp.Max(X, V, 1) * sp.Heaviside(X) + sp.pi
    system = cw.system_from_sympy(
        [X, V],
        [sp.Eq(X.diff(s), V), sp.Eq(V.diff(s), right)],
        {w: 1.2, lam: 0.3},
        period=2 * sp.pi / w,
    )
    by_hand = sp.lambdify((s, X, V, w, lam), right, "math")
    from contwalk.python_functions import plain
    from contwalk.system.declarations import ParameterValues

    random, rates = np.random.default_rng(1), np.zeros(2)
    for _ in range(10):
        at, *values = random.uniform(0.2, 2.0, 3)
        plain(system.modes[0].field)(at, np.array(values), ParameterValues(**system.defaults()), rates)
        assert rates[1] == pytest.approx(by_hand(at, *values, 1.2, 0.3), rel=1e-13)


@pytest.mark.parametrize(
    ("equations", "parameters", "said"),
    [
        ([sp.besselj(0, x)], {}, "besselj(...) is no function"),
        ([A * x], {}, "'A' is not defined"),
        ([A * x, x], {A: 1}, "There are 2 equations for 1 states"),
        ([sp.I * x], {}, "I is no finite real number"),
        ([sp.Symbol("a b") * x], {}, "'a b' is no name"),
        ([sp.Piecewise((x, x > 1))], {}, "says nothing for what its conditions leave out"),
        ({y: x}, {}, "no equation for the state x"),
        ([sp.Eq(y, x)], {}, "is not that of dx/dt"),
    ],
)
def test_what_sympy_cannot_say(equations, parameters, said):
    with pytest.raises(SystemDefinitionError) as caught:
        cw.system_from_sympy([x], equations, parameters)
    assert said in str(caught.value)


def two_for_one(x, *, a):
    return x, a


def of_one(x, *, a):
    return a * x


def nothing(x, *, a):
    x + a


def hidden(*x, a):
    return x


def of_nothing(*, a):
    return a


def with_default(x=1.0, *, a):
    return x


def broken(x, *, a):
    return math.no_such_function(x)


@pytest.mark.parametrize(
    ("function", "given", "said"),
    [
        (two_for_one, {"a": 1.0}, "two_for_one returns 2 values for 1 state. Return one for each"),
        (nothing, {"a": 1.0}, "nothing returns 0 values for 1 state"),
        (hidden, {"a": 1.0}, "takes *x, whose names are not known"),
        (of_nothing, {"a": 1.0}, "has no arguments that could be states"),
        (with_default, {"a": 1.0}, "the state x has a default. Defaults of states are start="),
        (broken, {"a": 1.0}, "no_such_function"),
        (two_for_one, {}, "the parameter a has no default. @cw.model(a=1.0)"),
        (two_for_one, {"a": 1.0, "b": 2.0}, "gives b, which is no keyword-only argument"),
        (of_one, {"a": "1"}, "default '1'"),
        (of_one, {"a": 1.0, "start": {"z": 1.0}}, "start names 'z', which is no state"),
        (of_one, {"a": 1.0, "about": {"z": "1"}}, "about names 'z'"),
        (math.sin, {}, "Put it over a function"),
    ],
)
def test_what_a_function_must_be(function, given, said):
    with pytest.raises(SystemDefinitionError) as caught:
        cw.model(**given)(function)
    assert said in str(caught.value)
    if function not in (math.sin,) and given.get("a") != "1":
        assert "test_short_forms.py, line " in str(caught.value)


@pytest.mark.parametrize(
    ("arguments", "keywords", "said"),
    [
        (("q", (1, 2)), {}, "'q' is not a parameter"),
        (("B", (2, 1)), {}, "the wrong way round"),
        (("B", (1, 2)), {"start": {"z": 1.0}}, "'z', which is no state"),
        (("B", (1, 2)), {"accuracy": "x"}, "key accuracy"),
        (("B", (1, 2)), {"folow": 1}, "unknown key"),
        (("B", (1, 2)), {"parameters": {"C": 1.0}}, "'C'"),
    ],
)
def test_what_a_diagram_refuses(arguments, keywords, said):
    with pytest.raises(ContwalkError) as caught:
        cw.diagram(brusselator, *arguments, **keywords)
    assert said in str(caught.value)


def test_no_start_leads_anywhere():
    nowhere = cw.system_from_text("x' = 1 + x^2 + a^2; a = 1")
    with pytest.raises(StartError, match="No start of 'equations' leads to a solution"):
        cw.diagram(nowhere, "a", (-1, 2))


def test_public_names_stay_functions_whatever_is_imported():
    import contwalk.diagram.diagram  # noqa: F401

    assert callable(cw.diagram)
    assert cw.diagram.__module__ == "contwalk.shortcuts.diagrams"


def test_another_process_does_not_know_a_function(tmp_path, monkeypatch):
    """A database of it can be read there; what needs its code is told."""
    from contwalk.system import loading

    path = cw.diagram(brusselator, "B", (1, 1.5), diagram="none").save(tmp_path / "x.h5")
    monkeypatch.setattr(loading, "_MADE", {})
    assert len(cw.open_database(path)["b1"]) > 10
    with pytest.raises(ContwalkError, match="was made in Python by another process"):
        cw.open_database(path, trust=True).system()
