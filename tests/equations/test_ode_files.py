"""Files in the style of XPPAUT's, each against its equations by hand at random states."""

from __future__ import annotations

import math
import re
from pathlib import Path

import numpy as np
import pytest
from by_hand import CLOSE, largest_difference
from mutated import mutated

import contwalk as cw
from contwalk.errors import ContwalkError, SystemDefinitionError
from contwalk.python_functions import plain
from contwalk.system.declarations import ParameterValues
from contwalk.workflow.importing import imported

FOLDER = Path(__file__).parent / "ode"


def brusselator(t, p, x, y):
    return (p.a, -(p.b + 1) * x, x * x * y), (p.b * x, -x * x * y)


def lorenz(t, p, x, y, z):
    return (p.s * (y - x),), (p.r * x, -y, -x * z), (-p.b * z, x * y)


def fitzhugh(t, p, v, w):
    return (p.i0, v * (1 - v) * (v - p.a), -w), (p.eps * v, -p.eps * p.gam * w)


def hodgkin(t, p, v, m, h, n):
    am = 0.1 * (v + 40) / (1 - math.exp(-(v + 40) / 10))
    ah, bh = 0.07 * math.exp(-(v + 65) / 20), 1 / (1 + math.exp(-(v + 35) / 10))
    an, bn = 0.01 * (v + 55) / (1 - math.exp(-(v + 55) / 10)), 0.125 * math.exp(-(v + 65) / 80)
    currents = -p.gna * h * (v - p.vna) * m**3, -p.gk * (v - p.vk) * n**4, -p.gl * (v - p.vl)
    return (
        tuple(current / p.c for current in (p.i0, *currents)),
        (p.phi * am * (1 - m), -p.phi * 4 * math.exp(-(v + 65) / 18) * m),
        (p.phi * ah * (1 - h), -p.phi * bh * h),
        (p.phi * an * (1 - n), -p.phi * bn * n),
    )


def morris(t, p, v, w):
    ica = p.gca * (0.5 + 0.5 * math.tanh((v - p.v1) / p.v2)) * (v - 1)
    rate = p.phi * math.cosh((v - p.v3) / (2 * p.v4))
    to = 0.5 * (1 + math.tanh((v - p.v3) / p.v4))
    return (p.iapp, p.gl * (p.vl - v), p.gk * w * (p.vk - v), -ica), (rate * to, -rate * w)


def wilson(t, p, u, v):
    def f(x):
        return 1 / (1 + math.exp(-x))

    second = f(p.aei * u - p.aii * v - p.ti)
    return (-u, f(p.aee * u - p.aie * v - p.te)), (-v / p.tau, second / p.tau)


def duffing(t, p, x, y):
    return (y,), (-p.delta * y, x, -(x**3), p.gamma * math.cos(p.omega * t))


def vanderpol(t, p, x, y):
    return (y,), (-x, p.MU * y, -p.MU * x * x * y)


def prey(t, p, x, y):
    eaten = p.a * x / (1 + p.a * p.h * x) * y
    return (p.r * x, -p.r * x * x / p.k, -eaten), (p.e * eaten, -p.d * y)


def fire(t, p, v, u):
    return (-v, p.i, -u), (-u / p.tau,)


def ring(t, p, *x):
    return [(p.a * x[j] * (1 - x[j]), -p.d * x[j], p.d * x[j - 1]) for j in range(3)]


def bell(t, p, x):
    at = [-2 + 0.1 * k for k in range(41)]
    return ((-x, p.g * np.interp(x - 1, at, [math.exp(-a * a) for a in at])),)


def measured(t, p, x):
    beyond = (0.8 - 1.2) * max(2 * x - 4, 0)
    return ((-x, p.g * (np.interp(2 * x, range(5), [0, 1, 1.5, 1.2, 0.8]) + beyond)),)


def tight(t, p, x, y, z):
    return (-x, p.a, x > 1), (p.a * (x > p.b), -y), (-z * z, 8.0**x, 1.0)


def pieces(t, p, x, y):
    beyond = math.log(x) if x >= p.b and y > 0 else math.sqrt(x)
    first = x**2 if x < p.a else beyond
    step = math.copysign(1, p.b - y) if x >= p.a else 0.0
    return (first,), (step, (x + y) % p.a, -math.floor(3 * y), max(x, y) * min(x, 1), not x > p.b)


def stimulus(t, p, x, y):
    angle = 2 * math.pi * p.freq * t
    return (-x, p.ie0, p.ie1 * math.sin(angle + p.phase), p.b * y), (x, -(y**3) * math.cos(angle))


def longline(t, p, x):
    return ((-x, p.a * math.sin(x), p.b * math.exp(-x * x)),)


def taken(t, p, period, state):
    return (-p.lambda_ * period, math.tanh(state) * p.gamma), (p.path_, -state * math.sin(period))


def kick(t, p, th, w):
    return (w,), (-math.sin(th), -p.b * w)


def block(t, p, u1, v1, u2, v2, u3, v3, u0):
    found = []
    for j, (u, v) in enumerate(((u1, v1), (u2, v2), (u3, v3)), 1):
        found += [(-u, p.s * math.tanh(u0 * j + v)), ((2 * j - 1) * u, -v / (1 + j))]
    return [*found, (1.0, -u0, -u1 * u2 * u3)]


MODELS = {name: globals()[name] for name in (path.stem for path in FOLDER.glob("*.ode"))}


def test_there_are_twenty():
    assert len(MODELS) == 20


@pytest.mark.parametrize("name", sorted(MODELS))
def test_rates_are_those_by_hand(name):
    system = imported(FOLDER / f"{name}.ode").system
    assert largest_difference(system, MODELS[name]) < CLOSE


def test_what_else_a_file_says():
    lorenz_, morris_, fire_, kick_ = (
        imported(FOLDER / f"{name}.ode") for name in ("lorenz", "morris", "fire", "kick")
    )
    assert [state.start for state in lorenz_.system.states] == [-7.5, -3.6, 30.0]
    assert (lorenz_.system.about, lorenz_.model.until) == ("the famous Lorenz equations", 40.0)
    assert morris_.system.presets["hopf"] == {"v3": 0.0, "v4": 0.3, "gca": 1.1, "phi": 0.2}
    assert [signal.name for signal in morris_.system.signals] == ["ica", "ik"]
    assert (morris_.system.study.parameter, morris_.system.study.range) == ("iapp", (-0.2, 0.5))
    after = np.zeros(2)
    p = ParameterValues(**fire_.system.defaults())
    plain(fire_.system.transitions[0].reset)(0.0, np.array([1.0, 0.5]), p, after)
    assert (after.tolist(), fire_.system.transitions[0].direction) == ([0.0, 0.9], "rising")
    p = ParameterValues(**kick_.system.defaults())
    plain(kick_.system.transitions[0].reset)(0.0, np.array([1.0, 0.1]), p, after)
    assert after.tolist() == pytest.approx([0.7, 0.1 + 0.5 * 0.7], rel=1e-15)
    assert any("out_put of the event is left out" in note for note in kick_.model.notes)


@pytest.mark.parametrize(("name", "period"), [("duffing", 2 * math.pi / 1.2), ("stimulus", 4.0)])
def test_the_period_of_a_forcing_is_found(name, period):
    system = imported(FOLDER / f"{name}.ode").system
    assert system.period(ParameterValues(**system.defaults())) == pytest.approx(period, rel=1e-15)


def test_the_plugin_reads(tmp_path):
    text = imported(FOLDER / "fitzhugh.ode").plugin
    assert (
        """\
def f(v, p):
    return v * (1.0 - v) * (v - p.a)


def field(t, state, p, rate):
    \"\"\"Write the rates of the states.\"\"\"
    v, w = state
    rate[0] = p.i0 + f(v, p) - w
    rate[1] = p.eps * (v - p.gam * w)
"""
        in text
    )
    assert re.search(r"sha256 [0-9a-f]{64}", text)


def test_a_file_runs_as_it_is(contwalk, tmp_path):
    """From an .ode file to its Hopf point in two commands."""
    (tmp_path / "brusselator.ode").write_text((FOLDER / "brusselator.ode").read_text())
    code, said = contwalk("import", "brusselator.ode", "--run", "run.yaml")
    assert code == 0, said
    assert "simulate: {until: 50.0" in (tmp_path / "run.yaml").read_text()
    assert contwalk("continue", "run.yaml", "--quiet", "--set", "diagram.follow=none")[0] == 0
    (hopf,) = (p for p in cw.open_database("run.h5")["b1"].special_points if p.label == "HB")
    assert hopf.parameters["a"] == pytest.approx(math.sqrt(0.5), rel=1e-12)


REFUSED = {
    "x'=-x+w\nwiener w": "line 2: a Wiener process moves by chance",
    "x'=-x+z\nmarkov z 2\n{0} {1}": "line 2: a Markov variable jumps by chance",
    "\nx'=-delay(x,tau)\npar tau=1": "line 2: delay(...) is the past of a state",
    "x'=-x+ran(1)": "line 1: ran(...) is a random number",
    "x'=-x+int{exp(-t)#x}": "line 1: int(...) is an integral over all that was before",
    "0=x+y\nx'=y": "line 1: an algebraic equation",
    "x'=y\ny=2*x\npar a=b": "line 3: 'a=b' is not a name with a number",
    "x'=-x*a\npar a=1/3": "line 2: 'a=1/3' is not a name with a number",
    "x'=-x*a": "line 1: 'a' is not defined",
    "x'=-f(x,1)\nf(u)=u": "line 1: f takes 1 argument, and gets 2",
    "x'=-x\nx'=1": "line 2: 'x' is defined again; it is on line 1 already",
    "x'=-x\nglobal 0 t-1 {x=0}": "line 2: an event at zero alone has no direction",
    "x'=-x\nglobal 1 x-1 x=0": "line 2: the event has not the form of one. As in global 1 v-1 {v=0}",
    "x'=-x*a\npar a=1\nglobal 1 x-1 {a=0}": "line 3: the event changes the parameter a. Make it a state",
    "x'=-x\ny'=1\nf(u)=u*x\nglobal 1 x-1 {x=0;y=f(2)}": "line 4: y is set by a function of x",
    "x'=-w(x)\ntable w % 3 -1 1 a*t\npar a=1": "line 2: the table depends on more than t",
    "x'=-w(x)\ntable w none.tab": "line 2: the file none.tab cannot be read",
    "x'=-w(x)\ntable w ../none.tab": "line 2: '../none.tab' is no name of a file beside the model",
    "x[0..2]'=-x[j-1]": "line 1: the index [j-1] is -1 at j = 0",
    "x[5..2]'=-x[j]": "line 1: [5..2] stands for no lines",
    "x[0..99999]'=-x[j]": "line 1: the ranges stand for many lines",
    "%[1..3]\nx[j]'=1": "line 1: the block has no end",
    "x'=x)": "line 1: column",
    "done\nx'=1": "there is no equation",
    "x'=y\ny'=" + "(" * 1000 + "x": "more than 90 parentheses",
    "special k=conv(even,2,3,w,x)\nx'=k(0)": "line 1: a network of convolutions",
}


@pytest.mark.parametrize("text", REFUSED, ids=lambda text: text[:25])
def test_what_is_refused(tmp_path, text):
    path = tmp_path / "model.ode"
    path.write_text(text)
    with pytest.raises(ContwalkError) as caught:
        imported(path)
    assert REFUSED[text] in str(caught.value)
    assert str(caught.value).startswith(str(path))


TEXT = """# A driven cell
V' = I - i_na - gk*(V - EK)
dm/dt = (1 - m)*rate(V) - m*if(V > 0 & !(V == 1))then(exp(-V^2/2))else(heav(V)*-V)
i_na = gna*m**3*(V - ENa); gna = 1.2
gk = 0.36; EK = -7.7e-1; ENa = .5; I = 1; k = 2
rate(u) = 1/(1 + exp(-u/k))
period = 2*pi*k
event hit: V - 3*m falls, m = -m/2
"""


@pytest.mark.parametrize("suffix", [".ode", ".txt"])
def test_mutated_files_are_models_or_refused(tmp_path, monkeypatch, suffix):
    """Ten thousands of them were tried once, under other seeds."""
    monkeypatch.chdir(tmp_path)
    texts = [path.read_text() for path in FOLDER.glob("*.ode")] if suffix == ".ode" else [TEXT]
    models, path = 0, tmp_path / f"model{suffix}"
    for text in mutated(sorted(texts), 200, seed=1):
        path.write_text(text, encoding="utf-8", errors="replace")
        try:
            imported(path)
            models += 1
        except SystemDefinitionError:
            pass
    assert 10 < models < 190
    assert [entry.name for entry in tmp_path.iterdir()] == [path.name]
