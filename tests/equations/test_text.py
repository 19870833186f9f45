"""Equations as text: what each form means, and what is refused with its line."""

from __future__ import annotations

import math

import numpy as np
import pytest
from by_hand import CLOSE, largest_difference

import contwalk as cw
from contwalk.errors import ContwalkError
from contwalk.python_functions import plain
from contwalk.system.declarations import ParameterValues


def rates_of(text, *x, t=0.0):
    system = cw.system_from_text(text)
    out = np.zeros(len(x))
    plain(system.modes[0].field)(t, np.array(x, float), ParameterValues(**system.defaults()), out)
    return out.tolist()


def test_every_form():
    system = cw.system_from_text(
        """
        # A driven cell
        V' = I + pulse(t) - i_na - gk*(V - EK)   # mV
        dm/dt = (1 - m)*rate(V) - m*if(V > 0 & !(V == 1))then(exp(-V^2/2))else(heav(V)*-V)
        i_na = gna*m**3*(V - ENa); gna = 1.2
        gk = 0.36; EK = -7.7e-1; ENa = .5; I = 1; width = 2*pi/3; k = 2
        rate(u) = 1/(1 + exp(-u/k))
        pulse(t) = sin(t/width)*sign(cos(t/width))
        period = 2*pi*width
        V(0) = -0.65
        event hit: V - 3*m falls, m = -m/2
        """
    )

    def by_hand(t, p, v, m):
        i_na = p.gna * m**3 * (v - p.ENa)
        pulse = math.sin(t / p.width) * math.copysign(1, math.cos(t / p.width))
        closing = math.exp(-(v**2) / 2) if v > 0 else 0.0
        return (p.I, pulse, -i_na, -p.gk * v, p.gk * p.EK), ((1 - m) / (1 + math.exp(-v / p.k)), -m * closing)

    assert largest_difference(system, by_hand) < CLOSE
    assert system.defaults()["width"] == 2 * math.pi / 3
    assert [state.start for state in system.states] == [-0.65, None]
    assert system.about == "A driven cell"
    assert system.states[0].about == "mV"
    p = ParameterValues(**system.defaults())
    assert plain(system.period)(p) == 2 * math.pi * p.width
    (transition,) = system.transitions
    after = np.zeros(2)
    transition.reset(0.0, np.array([3.0, 1.0]), p, after)
    assert after.tolist() == [3.0, -0.5]
    assert (transition.guard(0.0, np.array([3.0, 1.0]), p), transition.direction) == (0.0, "falling")
    (current,) = system.signals
    x = np.array([[1.0, 2.0], [0.5, 1.0]])
    assert current.function(np.zeros(2), x, p).tolist() == [1.2 * 8 * 0.5, 0.0]
    assert "sha256" in system.reference


@pytest.mark.parametrize(
    ("right", "value"),
    [
        ("-x^2", -9.0),
        ("2^-x^2", 2.0**-9.0),
        ("2^3^0.5", 2 ** (3**0.5)),
        ("-x*2 - -x", -3.0),
        ("1/2 + 7/3*x", 7.5),
        ("x - (x - 2)", 2.0),
        ("12/(x*2)/2", 1.0),
        ("(1 > 2) + (x > 2) + (x >= 3)", 2.0),
        ("-(x > 2)", -1.0),
        ("!(x < 2) & x != 5 | 0", 1.0),
        ("if(x)then(7)else(1)", 7.0),
        ("min(x, 2) + max(x, 2) + abs(-x)", 8.0),
        ("atan2(1, x) + hypot(x, 4) + log(8, 2) + ln(1)", math.atan2(1, 3) + 8.0),
        ("gamma(x) + erf(0) + lgamma(1) + mod(-1, x)", 4.0),
        ("heav(0) + heav(-1) + sign(-x) + sign(0)", 0.0),
        ("floor(2.5) + ceil(2.5) + fabs(-1) + pow(x, 2)", 15.0),
        ("asin(0) + acos(1) + atan(0) + cbrt(27) + log10(100)", 5.0),
        ("degrees(pi)/radians(180) + expm1(0) + log1p(0) + log2(8)", 180 / math.pi + 3.0),
        ("1e3 + .5 + 5.", 1005.5),
        ("10000000000*x", 3e10),
    ],
)
def test_values(right, value):
    assert rates_of(f"x' = {right} + 0*x", 3.0) == pytest.approx([value], rel=4e-16)


def test_names_of_the_plugins_own_may_be_used():
    """`p`, `state`, `rate` and the names of arguments stand for what the model says."""
    text = "p' = rate(after)*p + f(p) + np; after' = field; rate(x) = x^2*np; f(p) = 2*p; np = gamma"
    text += "\nfield = p + np; gamma = 3"
    assert rates_of(text, 2.0, 5.0) == [75.0 * 2 + 4 + 3, 5.0]


def test_functions_use_states_and_each_other():
    text = "x' = g(2); y' = h(x); g(u) = u*h(u) + t; h(v) = v*y + a; a = 10"
    assert rates_of(text, 3.0, 7.0, t=0.5) == [2 * (14 + 10) + 0.5, 31.0]


WRONG = {
    "": "line 1: there is no equation",
    "\nx' = a*x": "line 2: 'a' is not defined. As in a = 1.0",
    "x' = -x + alpha\nAlpha = 2": "line 1: 'alpha' is not defined. Did you mean 'Alpha'?",
    "x' = -x\n\nx' = 2": "line 3: 'x' is defined again; it is on line 1 already",
    "x' = -x; a = 1\na(u) = u": "line 2: 'a' is defined again; it is on line 1",
    "x' = -x\nlambda = 2": "line 2: the parameter 'lambda' has a name that is taken: it is a word",
    "x' = -x\nsin(u) = 2": "line 2: the function 'sin' has a name that is taken: it is a function",
    "stable' = 1": "line 1: the state 'stable' has a name that is taken: it is what contwalk calls",
    "t' = 1": "it is the time",
    "x' = sin(x, 2)": "line 1: sin takes 1 argument, and gets 2",
    "x' = f(x)\nf(u, v) = u*v": "line 1: f takes 2 arguments, and gets 1",
    "x' = a(x)\na = 1": "line 1: 'a' is a parameter and is used as a function. A product is a * (...)",
    "x' = f*x\nf(u) = u": "line 1: f is a function. Give its arguments: f(x)",
    "x' = sine(x)": "line 1: there is no function 'sine'. Did you mean 'sin'?",
    "x' = 2x": "line 1: column 7: 'x' is one too many. Products are written with *",
    "x' = (x": "line 1: column 8: the end of the line stands where ')' must",
    "x' = x ? 1": "line 1: column 8: '?' stands for nothing",
    "x' = 1 < x < 2": "two comparisons stand in a row",
    "x' = 1e999": "larger than floats are",
    "x' = x*a; a = 1/0": "The number cannot be computed: float division by zero",
    "x' = x*a; a = (-1)^0.5": "is no real number",
    "x' = x*a; a = 10^400": "cannot be computed",
    "x' = f(x); f(u) = g(u)\ng(u) = f(u)": "is defined by itself, by way of",
    "x' = a; a = a + x": "'a' is defined by itself",
    "x'' = -x": "a second derivative stands on the left. Give the first a name: x' = v",
    "x' = -x; y+ = 2": "of another kind than that on line 1",
    "x' = -x; period = x": "the period depends on the time or a state",
    "x' = -x; y(0) = 1": "'y' has a start, and no equation",
    "x' = -x; x(1) = 1": "a start is at time 0",
    "x' = -x; event e: x sinks": "'sinks' stands where 'falls' or 'rises' must. As in: event hit",
    "x' = -x; event e: x falls, y = 1": "the event sets 'y', which is no state",
    "x' = if(x > 1)then(2)": "The form is if(condition)then(value)else(value)",
    "x' = " + "(" * 5000 + "x": "more than 90 parentheses or signs stand inside each other",
    "x' = " + "-" * 5000 + "x": "more than 90 parentheses or signs stand inside each other",
    "x' = x" + "+x" * 5000: "more than 300 operations inside each other",
    "x" * 1_000_000: "has 1000000 characters. At most 262144 are read",
    "x' = __import__('os').getcwd()": "column 22: '.' stands for nothing",
    "x' = p.__class__": "'.' stands for nothing",
    "x' = 9^9^9^9^9": "OverflowError",
}


@pytest.mark.parametrize("text", WRONG, ids=lambda text: text[:30])
def test_what_is_refused(text):
    with pytest.raises(ContwalkError) as caught:
        cw.system_from_text(text)
    assert WRONG[text] in str(caught.value)
    assert str(caught.value).startswith("the equations")


def test_names_with_a_d_in_front_are_names():
    assert rates_of("dx/dt = d - dx; d = 3; dx = 2*x; dt = 1", 0.5) == [2.0]


def test_no_text_at_all():
    with pytest.raises(ContwalkError, match="a list, not a text"):
        cw.system_from_text(["x' = 1"])  # type: ignore[arg-type]


def test_a_whole_study_is_one_file(contwalk, tmp_path):
    """It can be shown, checked again and gone on with, and needs no trust: it is data."""
    (tmp_path / "study.yaml").write_text(
        """
system:
  equations: |
    x' = A - (B + 1)*x + x^2*y
    y' = B*x - x^2*y
    A = 1; B = 1.5
start: {state: {x: 1, y: 1.5}}
continue: {parameter: B, range: [1, 3]}
diagram: {follow: none}
"""
    )
    code, said = contwalk("continue", "study.yaml", "--quiet")
    assert code == 0, said
    (hopf,) = (p for p in cw.open_database("study.h5")["b1"].special_points if p.label == "HB")
    assert hopf.parameters["B"] == pytest.approx(2.0, abs=1e-12)
    code, said = contwalk("verify", "study.h5")
    assert (code, "agree" in said.lower()) == (0, True)
    assert contwalk("continue", "study.yaml", "--quiet", "--resume")[0] == 0
    (tmp_path / "study.yaml").write_text('system: {equations: "x\' = a"}\nstart: {state: {x: 1}}\n')
    code, said = contwalk("continue", "study.yaml", "--output", "other.h5")
    assert code == 2
    assert "study.yaml, line 1, key system: the equations, line 1: 'a' is not defined." in said
    assert not (tmp_path / "other.h5").exists()


@pytest.mark.parametrize("system", ["{equation: x}", "{equations: 3}", "{equations: x, name: y}", "[x]"])
def test_other_mappings_are_no_system(contwalk, tmp_path, system):
    (tmp_path / "study.yaml").write_text(f"system: {system}\nstart: {{state: {{x: 1}}}}\n")
    code, said = contwalk("continue", "study.yaml")
    assert code == 2
    assert "key system" in said


def test_a_stop_as_an_event(contwalk, tmp_path):
    """The forced oscillator with a rigid stop grazes at gap sqrt((1 - w^2)^2 + (2 zeta w)^2)."""
    (tmp_path / "stop.yaml").write_text(
        """
system:
  equations: |
    dq/dt = v
    v' = force*cos(omega*t) - 2*zeta*v - q
    zeta = 0.1; omega = 1.3; force = 0.3; gap = 1; restitution = 0.8
    period = 2*pi/omega
    event impact: gap - q falls, v = -restitution*v
start: {simulate: {state: {q: 0.0, v: 0.0}, until: settled}}
continue: {parameter: force, range: [0.1, 2.0]}
"""
    )
    assert contwalk("continue", "stop.yaml", "--quiet")[0] == 0
    (grazing,) = (p for p in cw.open_database("stop.h5")["b1"].special_points if p.label == "GR")
    exact = math.hypot(1 - 1.3**2, 2 * 0.1 * 1.3)
    assert grazing.parameters["force"] == pytest.approx(exact, rel=1e-8)


def test_import_of_text(contwalk, tmp_path):
    """Plugin and run file run as they are, and none is written over."""
    (tmp_path / "two words.txt").write_text(
        "# Bistable switch\nx' = a - x + x^3/3   # level\na = 0.1\nx(0) = 0.1\n"
    )
    code, said = contwalk("import", "two words.txt", "--run", "run.yaml")
    assert (code, "Wrote two_words.py and run.yaml" in said) == (0, True)
    assert 'State("x", start=0.1, about="level")' in (tmp_path / "two_words.py").read_text()
    code, said = contwalk("continue", "run.yaml", "--quiet")
    assert code == 0, said
    code, said = contwalk("import", "two words.txt", "-o", "other.py", "--run", "run.yaml")
    assert (code, "run.yaml exists" in said) == (2, True)
    assert not (tmp_path / "other.py").exists()
    (tmp_path / "bad.txt").write_text("x' = a - x\n")
    code, said = contwalk("import", "bad.txt")
    assert (code, "bad.txt, line 1: 'a' is not defined" in said) == (2, True)
    assert not (tmp_path / "bad.py").exists()
    for name in ("none.txt", ".", "run.yaml"):
        assert contwalk("import", name)[0] == 2
