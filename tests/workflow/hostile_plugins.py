"""Small plugins, each wrong in one way: `SMOOTH` and `HYBRID` with a piece of text replaced."""

from __future__ import annotations

SMOOTH = """\
import math
import numpy as np
from contwalk.system import Mode, Neutral, Observable, Parameter, Start, State, Symmetry, System

def field(t, x, p, dx):
    dx[0] = p.r - x[0] ** 2
    dx[1] = -x[1]

SYSTEM = System(
    name="small",
    states=(State("x"), State("y")),
    parameters=(Parameter("r", 1.0), Parameter("k", 2.0)),
    modes=(Mode("only", field),),
)
"""

# A mass on a spring, pushed evenly round, that hits a stop.
HYBRID = """\
import math
import numpy as np
from contwalk.system import Mode, Observable, Parameter, State, System, Transition

def field(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = p.r * math.cos(t) - 0.2 * x[1] - x[0]

def gap(t, x, p):
    return 1.0 - x[0]

def rebound(t, x, p, x_plus):
    x_plus[0] = x[0]
    x_plus[1] = -0.8 * x[1]

def period(p):
    return 2.0 * math.pi

SYSTEM = System(
    name="small",
    states=(State("x"), State("y")),
    parameters=(Parameter("r", 1.0), Parameter("k", 2.0)),
    modes=(Mode("only", field),),
    transitions=(Transition("hit", source="only", target="only", guard=gap, reset=rebound),),
    period=period,
)
"""

_FIELD = "    dx[0] = p.r - x[0] ** 2\n    dx[1] = -x[1]\n"
_PERIOD = '    modes=(Mode("only", field),),\n'


def _field(text: str) -> tuple[str, str, str]:
    lines = "".join(f"    {line}\n" for line in text.splitlines())
    return SMOOTH, _FIELD, lines


def _more(text: str) -> tuple[str, str, str]:
    return SMOOTH, _PERIOD, f"{_PERIOD}    {text}\n"


def _hybrid(old: str, new: str) -> tuple[str, str, str]:
    return HYBRID, old, new


# name: the plugin, the text that is replaced, and the wrong text in its place
HOSTILE: dict[str, tuple[str, str, str]] = {
    "syntax error": (SMOOTH, "def field(", "def field(("),
    "import error": (SMOOTH, "import math", "import no_such_module_anywhere"),
    "exit at import": (SMOOTH, "import math", "import sys\nsys.exit()"),
    "exit in the field": (SMOOTH, _FIELD, "    raise SystemExit\n"),
    "exit in an observable": _more('observables=(Observable("o", lambda t, x, p: exit()),),'),
    "interrupt at import": (SMOOTH, "import math", "raise KeyboardInterrupt"),
    "no SYSTEM": (SMOOTH, "SYSTEM = ", "system = "),
    "SYSTEM is something else": (SMOOTH, "SYSTEM = System(", "SYSTEM = dict("),
    "too few arguments": (SMOOTH, "def field(t, x, p, dx):", "def field(t, x, p):\n    dx = np.zeros(2)"),
    "too many arguments": (SMOOTH, "def field(t, x, p, dx):", "def field(t, x, p, dx, more):"),
    "returns its value": _field("return [p.r - x[0] ** 2, -x[1]]"),
    "rebinds its result": _field("dx = np.array([p.r - x[0] ** 2, -x[1]])"),
    "assigns a row": _field("dx[0] = x\ndx[1] = -x[1]"),
    "text as a rate": _field("dx[0] = 'fast'\ndx[1] = -x[1]"),
    "None as a rate": _field("dx[0] = None\ndx[1] = -x[1]"),
    "a complex rate": _field("dx[0] = p.r - x[0] ** 2 + 1j\ndx[1] = -x[1]"),
    "a condition as a rate": _field("dx[0] = x[0] < 1.0\ndx[1] = -x[1]"),
    "an entry left out": _field("dx[0] = p.r - x[0] ** 2"),
    "an entry left out on a path": _field("dx[0] = p.r - x[0] ** 2\nif x[0] > 0:\n    dx[1] = -x[1]"),
    "an entry too many": _field("dx[0] = p.r - x[0] ** 2\ndx[1] = -x[1]\ndx[2] = 0.0"),
    "a state too many": _field("dx[0] = p.r - x[2] ** 2\ndx[1] = -x[1]"),
    "indexed by a state": _field("dx[0] = [1.0, 2.0][x[0]]\ndx[1] = -x[1]"),
    "whole number of a state": _field("dx[0] = p.r - int(x[0])\ndx[1] = -x[1]"),
    "unknown parameter": _field("dx[0] = p.rr - x[0] ** 2\ndx[1] = -x[1]"),
    "unknown name": _field("dx[0] = p.r - unknown(x[0])\ndx[1] = -x[1]"),
    "recursion": (SMOOTH, _FIELD, "    field(t, x, p, dx)\n"),
    "endless loop over a state": _field("v = x[0]\nwhile v > 1e-3:\n    v = v / 2\ndx[0] = v\ndx[1] = -x[1]"),
    "too many paths": _field(
        "s = 0.0\nfor k in range(20):\n    s = s + (1.0 if x[0] > k * x[1] else 2.0)\n"
        "dx[0] = s\ndx[1] = -x[1]"
    ),
    "raises": _field("raise ValueError('not here')"),
    "division by zero at the start": _field("dx[0] = p.r / (x[1] - x[1]) - x[0] ** 2\ndx[1] = -x[1]"),
    "constant division by zero": _field("dx[0] = p.r - 1.0 / 0.0\ndx[1] = -x[1]"),
    "NaN as a constant": _field("dx[0] = p.r - x[0] ** 2 + math.nan\ndx[1] = -x[1]"),
    "infinity as a constant": _field("dx[0] = p.r * math.inf - x[0] ** 2\ndx[1] = -x[1]"),
    "changes the state": _field("x[0] = x[0] + 1.0\ndx[0] = p.r - x[0] ** 2\ndx[1] = -x[1]"),
    "changes a parameter": _field("p.r = 2.0\ndx[0] = p.r - x[0] ** 2\ndx[1] = -x[1]"),
    "adds a parameter": _field("p.rate = p.r\ndx[0] = p.rate - x[0] ** 2\ndx[1] = -x[1]"),
    "random": _field("dx[0] = p.r - x[0] ** 2 + 0.1 * np.random.rand()\ndx[1] = -x[1]"),
    "random of a generator": (
        SMOOTH,
        f"def field(t, x, p, dx):\n{_FIELD}",
        "RANDOM = np.random.default_rng()\ndef field(t, x, p, dx):\n"
        "    dx[0] = p.r - x[0] ** 2 + 0.1 * RANDOM.standard_normal()\n    dx[1] = -x[1]\n",
    ),
    "a clock": _field("import time\ndx[0] = p.r - x[0] ** 2 + time.perf_counter()\ndx[1] = -x[1]"),
    "remembers its calls": (
        SMOOTH,
        f"def field(t, x, p, dx):\n{_FIELD}",
        "CALLS = [0]\ndef field(t, x, p, dx):\n    CALLS[0] += 1\n"
        "    dx[0] = p.r - x[0] ** 2 + 0.1 * CALLS[0]\n    dx[1] = -x[1]\n",
    ),
    "accumulates into its result": _field("dx[0] += p.r - x[0] ** 2\ndx[1] = -x[1]"),
    "time without a period": _field("dx[0] = p.r - x[0] ** 2 + math.cos(t)\ndx[1] = -x[1]"),
    "period that is none": (
        SMOOTH,
        SMOOTH[SMOOTH.index(_FIELD) :],
        SMOOTH[SMOOTH.index(_FIELD) :]
        .replace("x[0] ** 2\n", "x[0] ** 2 + math.cos(2 * t)\n")
        .replace(_PERIOD, f"{_PERIOD}    period=lambda p: 2.0,\n"),
    ),
    "period zero": _more("period=lambda p: 0.0,"),
    "period negative": _more("period=lambda p: -1.0,"),
    "period NaN": _more("period=lambda p: math.nan,"),
    "period is a number": _more("period=2.0,"),
    "period raises": _more("period=lambda p: p.omega,"),
    "period gives nothing": _more("period=lambda p: None,"),
    "wrong symmetry": (
        SMOOTH,
        "SYSTEM = System(",
        "def mirror(t, x, p, x_image):\n    x_image[0] = -x[0]\n    x_image[1] = -x[1]\n\nSYSTEM = System(\n"
        '    symmetries=(Symmetry("mirror", "spatial", mirror),),',
    ),
    "symmetry with an entry left out": (
        SMOOTH,
        "SYSTEM = System(",
        "def mirror(t, x, p, x_image):\n    x_image[0] = x[0]\n\nSYSTEM = System(\n"
        '    symmetries=(Symmetry("mirror", "spatial", mirror),),',
    ),
    "neutral direction that is nothing": (
        SMOOTH,
        "SYSTEM = System(",
        'def along(t, x, p, v):\n    v[0] = x\n\nSYSTEM = System(\n    neutral=(Neutral("along", along),),',
    ),
    "observable changes the state": _more(
        'observables=(Observable("o", lambda t, x, p: x.fill(1.0) or 1.0),),'
    ),
    "observable of the wrong shape": _more('observables=(Observable("o", lambda t, x, p: x),),'),
    "observable gives text": _more("observables=(Observable('o', lambda t, x, p: 'high'),),"),
    "observable is NaN": _more("observables=(Observable('o', lambda t, x, p: math.nan),),"),
    "observable raises": _more("observables=(Observable('o', lambda t, x, p: x[0, 9]),),"),
    "observable is called stable": _more("observables=(Observable('stable', lambda t, x, p: x[0, 0]),),"),
    "observable is called max_re": _more("observables=(Observable('max_re', lambda t, x, p: x[0, 0]),),"),
    "state is called period": (SMOOTH, 'State("y")', 'State("period")'),
    "parameter is called special": (SMOOTH, 'Parameter("k", 2.0)', 'Parameter("special", 2.0)'),
    "state and parameter of one name": (SMOOTH, 'Parameter("k", 2.0)', 'Parameter("x", 2.0)'),
    "observable and state of one name": _more("observables=(Observable('x', lambda t, x, p: x[0, 0]),),"),
    "observable and parameter of one name": _more("observables=(Observable('r', lambda t, x, p: x[0, 0]),),"),
    "two states of one name": (SMOOTH, 'State("y")', 'State("x")'),
    "two parameters of one name": (SMOOTH, 'Parameter("k", 2.0)', 'Parameter("r", 2.0)'),
    "state with a space": (SMOOTH, 'State("y")', 'State("y dot")'),
    "state named by a number": (SMOOTH, 'State("y")', "State(2)"),
    "state named by a keyword": (SMOOTH, 'State("y")', 'State("lambda")'),
    "state without a name": (SMOOTH, 'State("y")', 'State("")'),
    "state with a sign that Python reads as another one": (SMOOTH, 'State("y")', 'State("\u00b5")'),
    "meaning None": (SMOOTH, 'State("y")', 'State("y", about=None)'),
    "unit is a number": (SMOOTH, 'State("y")', 'State("y", unit=1)'),
    "reference None": _more("reference=None,"),
    "states of a mode are a word": (SMOOTH, 'Mode("only", field)', 'Mode("only", field, states="x")'),
    "constants of a mode are a list": (SMOOTH, 'Mode("only", field)', 'Mode("only", field, constants=[1])'),
    "default beyond floats": (SMOOTH, 'Parameter("k", 2.0)', 'Parameter("k", 10**400)'),
    "parameters by number": _field("dx[0] = p[0] - x[0] ** 2\ndx[1] = -x[1]"),
    "a generator": _field("dx[0] = p.r - x[0] ** 2\nyield -x[1]"),
    "waits for input": _field("input()\ndx[0] = p.r - x[0] ** 2\ndx[1] = -x[1]"),
    "writes into a global array": (
        SMOOTH,
        f"def field(t, x, p, dx):\n{_FIELD}",
        "WORK = np.zeros(2)\ndef field(t, x, p, dx):\n    WORK[0] = x[0]\n"
        "    dx[0] = p.r - WORK[0] ** 2\n    dx[1] = -x[1]\n",
    ),
    "asserts what holds": _field("assert x[0] > -9\ndx[0] = p.r - x[0] ** 2\ndx[1] = -x[1]"),
    "NaN on a side that is not taken": _field(
        "dx[0] = np.where(x[0] < 5, p.r - x[0] ** 2, np.nan)\ndx[1] = -x[1] if x[0] < 5 else -math.inf"
    ),
    "no words": (SMOOTH, SMOOTH, "\n"),
    "null bytes": (SMOOTH, "import math", "import math\0"),
    "exit in a family": (
        SMOOTH,
        "SYSTEM = System(",
        "def build(n):\n    raise SystemExit\n\nfrom contwalk.system import Choice, Family\n"
        "SYSTEM = Family(name='many', choices=(Choice('n', 2, minimum=1),), build=build)\nsystem = System(",
    ),
    "scale zero": (SMOOTH, 'State("y")', 'State("y", scale=0.0)'),
    "scale NaN": (SMOOTH, 'State("y")', 'State("y", scale=math.nan)'),
    "scale is text": (SMOOTH, 'State("y")', 'State("y", scale="large")'),
    "default NaN": (SMOOTH, 'Parameter("k", 2.0)', 'Parameter("k", math.nan)'),
    "default infinite": (SMOOTH, 'Parameter("k", 2.0)', 'Parameter("k", math.inf)'),
    "default is text": (SMOOTH, 'Parameter("k", 2.0)', 'Parameter("k", "2")'),
    "bounds reversed": (SMOOTH, 'Parameter("k", 2.0)', 'Parameter("k", 2.0, bounds=(3.0, 1.0))'),
    "bounds are one number": (SMOOTH, 'Parameter("k", 2.0)', 'Parameter("k", 2.0, bounds=3.0)'),
    "bounds are text": (SMOOTH, 'Parameter("k", 2.0)', 'Parameter("k", 2.0, bounds=("a", "b"))'),
    "bounds NaN": (SMOOTH, 'Parameter("k", 2.0)', 'Parameter("k", 2.0, bounds=(math.nan, 5.0))'),
    "default outside its bounds": (SMOOTH, 'Parameter("k", 2.0)', 'Parameter("k", 2.0, bounds=(3.0, 5.0))'),
    "no states": (SMOOTH, 'states=(State("x"), State("y")),', "states=(),"),
    "no parameters": (SMOOTH, 'parameters=(Parameter("r", 1.0), Parameter("k", 2.0)),', "parameters=(),"),
    "no modes": (SMOOTH, 'modes=(Mode("only", field),),', "modes=(),"),
    "states are words": (SMOOTH, 'states=(State("x"), State("y")),', 'states=("x", "y"),'),
    "states are one word": (SMOOTH, 'states=(State("x"), State("y")),', 'states="xy",'),
    "states are None": (SMOOTH, 'states=(State("x"), State("y")),', "states=None,"),
    "field is no function": (SMOOTH, 'Mode("only", field)', 'Mode("only", 3.0)'),
    "field is called": (SMOOTH, 'Mode("only", field)', 'Mode("only", field(0, [0, 0], None, [0, 0]))'),
    "presets are a list": _more('presets=["fast"],'),
    "preset of an unknown parameter": _more('presets={"fast": {"q": 1.0}},'),
    "preset is text": _more('presets={"fast": {"k": "high"}},'),
    "unknown keyword": _more("colour='red',"),
    "start of the wrong length": _more('starts=(Start("zero", lambda p: [[0.0]]),),'),
    "start raises": _more('starts=(Start("zero", lambda p: 1 / 0),),'),
    "start gives None": _more('starts=(Start("zero", lambda p: None),),'),
    "start gives one number": _more('starts=(Start("zero", lambda p: 1.0),),'),
    "guard of the parameters": _hybrid("return 1.0 - x[0]", "return p.k - 1.0"),
    "exit in the reset": _hybrid("    x_plus[0] = x[0]\n", "    exit(0)\n"),
    "reset is a number": _hybrid("reset=rebound", "reset=3"),
    "condition that raises": _hybrid(
        "    period=period,\n",
        "    period=period,\n    conditions=(__import__('contwalk.system').system.Condition(\n"
        "        'push', lambda t, x, p: 1 / 0, at='hit'),),\n",
    ),
    "condition at no transition": _hybrid(
        "    period=period,\n",
        "    period=period,\n    conditions=(__import__('contwalk.system').system.Condition(\n"
        "        'push', lambda t, x, p: x[1], at='miss'),),\n",
    ),
    "guard with another period": _hybrid("return 1.0 - x[0]", "return 1.0 + 0.1 * math.sin(1.5 * t) - x[0]"),
    "reset with another period": _hybrid("-0.8 * x[1]", "-(0.8 + 0.1 * math.sin(1.5 * t)) * x[1]"),
    "array of whole numbers": _hybrid(
        "    x_plus[0] = x[0]\n", "    kept = np.array([0, 0])\n    kept[0] = x[0]\n    x_plus[0] = kept[0]\n"
    ),
    "state of a mode twice": _hybrid('Mode("only", field)', 'Mode("only", field, states=("x", "x"))'),
    "no reset and no other mode": _hybrid("guard=gap, reset=rebound", "guard=gap"),
    "guard that stays zero": _hybrid("return 1.0 - x[0]", "return max(1.0 - x[0], 0.0)"),
    "complex guard": _hybrid("return 1.0 - x[0]", "return 1.0 - x[0] + 1j * x[1]"),
    "matrix of the wrong shape": _hybrid(
        "    x_plus[0] = x[0]\n", "    x_plus[0] = np.linalg.solve(np.ones((2, 3)) * x[0], x)[0]\n"
    ),
    "singular matrix": _hybrid(
        "    x_plus[0] = x[0]\n",
        "    x_plus[0] = x[0] + np.linalg.solve(np.array([[p.k, 4.0], [1.0, 2.0]]), x)[0]\n",
    ),
    "eigenvalues": _hybrid("-0.8 * x[1]", "np.linalg.eigvals(np.diag(x))[0] * x[1]"),
    "constant guard": _hybrid("return 1.0 - x[0]", "return 1.0"),
    "guard gives nothing": _hybrid("return 1.0 - x[0]", "1.0 - x[0]"),
    "guard gives True or False": _hybrid("return 1.0 - x[0]", "return x[0] < 1.0"),
    "guard gives a pair": _hybrid("return 1.0 - x[0]", "return 1.0 - x[0], 1.0"),
    "guard gives an array": _hybrid("return 1.0 - x[0]", "return 1.0 - x"),
    "guard raises": _hybrid("return 1.0 - x[0]", "return 1.0 - x[9]"),
    "guard is NaN": _hybrid("return 1.0 - x[0]", "return math.nan * x[0]"),
    "guard is random": _hybrid("return 1.0 - x[0]", "return 1.0 - x[0] + 0.01 * np.random.rand()"),
    "guard writes to the parameters": _hybrid("return 1.0 - x[0]", "p.r = 0.0\n    return 1.0 - x[0]"),
    "guard takes too much": _hybrid("def gap(t, x, p):", "def gap(t, x, p, more):"),
    "reset raises": _hybrid("    x_plus[0] = x[0]\n", '    raise ValueError("broken stop")\n'),
    "reset of an unknown parameter": _hybrid("-0.8 * x[1]", "-p.restitution * x[1]"),
    "reset leaves an entry out": _hybrid("    x_plus[0] = x[0]\n", ""),
    "reset gives NaN": _hybrid("-0.8 * x[1]", "math.nan * x[1]"),
    "reset divides by zero": _hybrid("-0.8 * x[1]", "-0.8 * x[1] / (1.0 - 1.0)"),
    "reset changes the state it gets": _hybrid(
        "    x_plus[0] = x[0]\n", "    x[1] = 0.0\n    x_plus[0] = x[0]\n"
    ),
    "reset is random": _hybrid("-0.8 * x[1]", "-np.random.rand() * x[1]"),
    "guard that goes on": _hybrid("-0.8 * x[1]", "0.8 * x[1]"),
    "unknown target": _hybrid('target="only"', 'target="other"'),
    "unknown source": _hybrid('source="only"', 'source="other"'),
    "unknown direction": _hybrid("guard=gap,", 'guard=gap, direction="down",'),
    "unknown role": _hybrid("guard=gap,", 'guard=gap, role="firm",'),
    "unknown relabelling": _hybrid("guard=gap,", 'guard=gap, relabel="swap",'),
    "soft with a jump": _hybrid("guard=gap,", 'guard=gap, role="soft",'),
    "time without a period, with impacts": _hybrid("    period=period,\n", ""),
    "period that is none, with impacts": _hybrid("return 2.0 * math.pi", "return 3.0"),
}


def plugin(name: str) -> str:
    """The text of a wrong plugin."""
    source, old, new = HOSTILE[name]
    assert source.count(old) >= 1, (name, old)
    return source.replace(old, new, 1)
