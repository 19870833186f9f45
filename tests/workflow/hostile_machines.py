"""Small machines with events, each wrong in one way: a sound one with pieces of text replaced."""

from __future__ import annotations

from dataclasses import dataclass

# A mass that meets a spring with a lag behind a gap: its force is a state that exists in contact only.
CONTACT = """\
import math
import numpy as np
from contwalk.system import Condition, Conserved, Mode, Neutral, Observable, Parameter
from contwalk.system import State, Symmetry, System, Transition

X, Y, F = range(3)

def free(t, x, p, dx):
    dx[X] = x[Y]
    dx[Y] = p.r * math.cos(t) - 0.2 * x[Y] - x[X]

def pressed(t, x, p, dx):
    dx[X] = x[Y]
    dx[Y] = p.r * math.cos(t) - 0.2 * x[Y] - x[X] - x[F]
    dx[F] = (p.k * (x[X] - 0.5) - x[F]) / 0.1

def gap(t, x, p):
    return 0.5 - x[X]

def force(t, x, p):
    return x[F]

def touch(t, x, p, x_plus):
    x_plus[X] = x[X]
    x_plus[Y] = x[Y]
    x_plus[F] = 0.01

def leave(t, x, p, x_plus):
    x_plus[X] = x[X]
    x_plus[Y] = x[Y]

def period(p):
    return 2.0 * math.pi

SYSTEM = System(
    name="contact",
    states=(State("x"), State("y"), State("f")),
    parameters=(Parameter("r", 1.0), Parameter("k", 4.0)),
    modes=(Mode("free", free, states=("x", "y")), Mode("pressed", pressed)),
    transitions=(
        Transition("hit", "free", "pressed", gap, reset=touch),
        Transition("lift", "pressed", "free", force, reset=leave),
    ),
    period=period,
)
"""

# A thermostat: a heater that is switched on below 0.5 and off above 1, with an after-running mass.
RELAY = """\
import math
import numpy as np
from contwalk.system import Condition, Conserved, Mode, Neutral, Observable, Parameter
from contwalk.system import State, Symmetry, System, Transition

def heating(t, x, p, dx):
    dx[0] = p.r - x[0] + 0.3 * x[1]
    dx[1] = 0.7 * (x[0] - x[1])

def cooling(t, x, p, dx):
    dx[0] = -x[0] + 0.3 * x[1]
    dx[1] = 0.7 * (x[0] - x[1])

def hot(t, x, p):
    return 1.0 - x[0]

def cold(t, x, p):
    return x[0] - 0.5

SYSTEM = System(
    name="relay",
    states=(State("x"), State("y")),
    parameters=(Parameter("r", 2.0), Parameter("k", 1.0)),
    modes=(Mode("on", heating), Mode("off", cooling)),
    transitions=(
        Transition("warm", "on", "off", hot),
        Transition("cool", "off", "on", cold),
    ),
)
"""

# A ball on a table that is shaken: one mode, loses at each impact.
BALL = """\
import math
import numpy as np
from contwalk.system import Condition, Conserved, Mode, Neutral, Observable, Parameter
from contwalk.system import State, Symmetry, System, Transition

def fall(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = -0.5

def height(t, x, p):
    return x[0] - p.r * math.sin(t)

def bounce(t, x, p, x_plus):
    x_plus[0] = x[0]
    x_plus[1] = (1.0 + p.k) * p.r * math.cos(t) - p.k * x[1]

def period(p):
    return 2.0 * math.pi

SYSTEM = System(
    name="ball",
    states=(State("x"), State("y")),
    parameters=(Parameter("r", 0.8), Parameter("k", 0.4)),
    modes=(Mode("flight", fall),),
    transitions=(Transition("impact", "flight", "flight", height, reset=bounce),),
    period=period,
)
"""

# A mass between two stops, its own mirror image half a period later.
STOPS = """\
import math
import numpy as np
from contwalk.system import Condition, Conserved, Mode, Neutral, Observable, Parameter
from contwalk.system import State, Symmetry, System, Transition

def move(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = p.r * math.cos(t) - 0.2 * x[1] - 0.1 * x[0]

def right(t, x, p):
    return 1.0 - x[0]

def left(t, x, p):
    return 1.0 + x[0]

def rebound(t, x, p, x_plus):
    x_plus[0] = x[0]
    x_plus[1] = -0.6 * x[1]

def mirrored(t, x, p, image):
    image[0] = -x[0]
    image[1] = -x[1]

def period(p):
    return 2.0 * math.pi

SYSTEM = System(
    name="stops",
    states=(State("x"), State("y")),
    parameters=(Parameter("r", 1.0), Parameter("k", 1.0)),
    modes=(Mode("only", move),),
    transitions=(
        Transition("hit_right", "only", "only", right, reset=rebound),
        Transition("hit_left", "only", "only", left, reset=rebound),
    ),
    symmetries=(
        Symmetry("mirror", "spatial", mirrored, events={"hit_right": "hit_left", "hit_left": "hit_right"}),
    ),
    period=period,
)
"""

# A ball on an elastic floor without losses: its energy is conserved.
HOP = """\
import math
import numpy as np
from contwalk.system import Condition, Conserved, Mode, Neutral, Observable, Parameter
from contwalk.system import State, Symmetry, System, Transition

def fly(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = -p.r

def press(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = -p.r - p.k * x[0]

def height(t, x, p):
    return x[0]

def energy(t, x, p):
    return 0.5 * x[1] ** 2 + p.r * x[0]

def pressed(t, x, p):
    return 0.5 * x[1] ** 2 + p.r * x[0] + 0.5 * p.k * x[0] ** 2

SYSTEM = System(
    name="hop",
    states=(State("x"), State("y")),
    parameters=(Parameter("r", 1.0), Parameter("k", 40.0)),
    modes=(Mode("air", fly), Mode("ground", press)),
    transitions=(
        Transition("land", "air", "ground", height),
        Transition("off", "ground", "air", height, "rising"),
    ),
    conserved=(Conserved("energy", {"air": energy, "ground": pressed}),),
)
"""


# A block that dry friction holds until the floor shakes it too much: a level that is of time alone.
HELD = """\
import math
from contwalk.system import Mode, Parameter, State, System, Transition

def rests(t, x, p, dx):
    dx[0] = 0.0 * x[0]

def slides(t, x, p, dx):
    dx[0] = math.sin(t) - p.k

def speed(t, x, p):
    return x[0]

def pushed(t, x, p):
    return math.sin(t) - p.r

def stops(t, x, p, x_plus):
    x_plus[0] = 0.0 * x[0]

SYSTEM = System(
    name="held",
    states=(State("v"),),
    parameters=(Parameter("r", 0.5), Parameter("k", 0.4)),
    modes=(Mode("rest", rests), Mode("slide", slides)),
    transitions=(
        Transition("goes", "rest", "slide", pushed, "rising", level=True),
        Transition("stops", "slide", "rest", speed, reset=stops),
    ),
    period=lambda p: 2.0 * math.pi,
)
"""


# One energy for both modes: in the air it is that above the floor only.
HOP_IN_ONE = (
    HOP.replace(
        "+ p.r * x[0]\n\ndef pressed", "+ p.r * x[0] + 0.5 * p.k * min(x[0], 0.0) ** 2\n\ndef pressed"
    )
    .replace('{"air": energy, "ground": pressed}', "energy")
    .replace('"hop"', '"hop_in_one"')
)
# A push at the lowest point: the event goes on through its guard.
CLOCK_PUSH = RELAY.replace(
    '        Transition("warm", "on", "off", hot),\n        Transition("cool", "off", "on", cold),\n',
    '        Transition("push", "on", "on", lambda t, x, p: x[0], "rising", reset=push),\n',
)
CLOCK_PUSH = (
    CLOCK_PUSH.replace(
        "def cooling(", "def push(t, x, p, y):\n    y[0], y[1] = x[0], x[1] + p.r\n\ndef cooling("
    )
    .replace(
        "    dx[0] = p.r - x[0] + 0.3 * x[1]\n    dx[1] = 0.7 * (x[0] - x[1])",
        "    dx[0], dx[1] = x[1], -x[0] - 0.3 * x[1]",
        1,
    )
    .replace(', Mode("off", cooling)', "")
    .replace('"relay"', '"clock"')
)

# A rimless wheel with its place along the slope, which it passes on at each strike: any place is as good.
WHEEL = """\
import math
from contwalk.system import Mode, Neutral, Parameter, State, System, Transition

def roll(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = math.sin(x[0])
    dx[2] = x[1] * math.cos(x[0])

def foot(t, x, p):
    return p.r + 0.4 - x[0]

def strike(t, x, p, after):
    after[0] = x[0] - 0.8
    after[1] = 0.7 * x[1]
    after[2] = x[2] + 0.5

def along(t, x, p, v):
    v[0], v[1], v[2] = 0.0, 0.0, 1.0

SYSTEM = System(
    name="wheel",
    states=(State("theta"), State("u"), State("s")),
    parameters=(Parameter("r", 0.15), Parameter("k", 0.5)),
    modes=(Mode("rolling", roll),),
    transitions=(Transition("strike", "rolling", "rolling", foot, reset=strike),),
    neutral=(Neutral("slide", along),),
)
"""

# A rotor that is pushed once a turn: its angle is one.
ROTOR = """\
import math
from contwalk.system import Mode, Parameter, State, System, Transition

def turn(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = p.r - 0.1 * x[1] - math.sin(2.0 * x[0])

def top(t, x, p):
    return math.sin(x[0] - 1.0)

def push(t, x, p, after):
    after[0] = x[0]
    after[1] = 1.1 * x[1]

SYSTEM = System(
    name="rotor",
    states=(State("angle", period=2.0 * math.pi), State("rate")),
    parameters=(Parameter("r", 1.5),),
    modes=(Mode("turning", turn),),
    transitions=(Transition("push", "turning", "turning", top, "rising", reset=push),),
)
"""

SOUND = {
    "wheel": WHEEL,
    "contact": CONTACT,
    "relay": RELAY,
    "ball": BALL,
    "stops": STOPS,
    "hop": HOP,
    "held": HELD,
}
SOUND |= {"rotor": ROTOR, "hop_in_one": HOP_IN_ONE, "clock": CLOCK_PUSH}


@dataclass(frozen=True)
class Wrong:
    """A machine that is wrong in one way, and what is said of it.

    `changes`: pairs of a text in the plugin and the wrong one in its place. `level`: of the finding; `said`:
    a part of its sentence; `line`: a text on the line that it names. `refused`: whether runs refuse it when
    they load it, with the same sentence.
    """

    base: str
    changes: tuple[tuple[str, str], ...]
    level: str
    said: str
    line: str
    refused: bool

    @property
    def source(self) -> str:
        """The plugin."""
        text = self.base
        for old, new in self.changes:
            assert text.count(old) >= 1, old
            text = text.replace(old, new, 1)
        return text


def _refused(base: str, said: str, line: str, *changes: tuple[str, str]) -> Wrong:
    return Wrong(base, changes, "error", said, line, refused=True)


def _found(base: str, level: str, said: str, line: str, *changes: tuple[str, str]) -> Wrong:
    """What only the check finds."""
    return Wrong(base, changes, level, said, line, refused=False)


def _guard(text: str, said: str, line: str = "def gap") -> Wrong:
    """A guard of the mass that is refused."""
    return _refused(CONTACT, said, line, ("return 0.5 - x[X]", f"return {text}"))


def _tried(text: str, level: str, said: str, line: str = "def gap") -> Wrong:
    """A guard of the mass that only the check finds."""
    return _found(CONTACT, level, said, line, ("return 0.5 - x[X]", f"return {text}"))


def _touch(text: str, said: str, line: str = "def touch") -> Wrong:
    """A reset of the mass that is refused."""
    return _refused(CONTACT, said, line, ("x_plus[F] = 0.01", text))


WHOLE = "    x_plus[X] = x[X]\n    x_plus[Y] = x[Y]\n    x_plus[F] = 0.01\n"
MODES = 'Mode("on", heating), Mode("off", cooling)'
SPARE = 'Mode("on", heating), Mode("off", cooling), Mode("spare", cooling)'
WARM = 'Transition("warm", "on", "off", hot)'
COOL = 'Transition("cool", "off", "on", cold)'
KICK = "lambda t, x, p, y: (y.__setitem__(0, x[0]), y.__setitem__(1, x[1] + 0.1))[0]"
LOSS = "lambda t, x, p, y: (y.__setitem__(0, x[0]), y.__setitem__(1, 0.9 * x[1]))[0]"
CLOCK = f'height, reset=bounce), Transition("kick", "flight", "flight", {{}}, "rising", reset={KICK}{{}})'
IMAGES = '{"hit_right": "hit_left", "hit_left": "hit_right"}'
LEFT = 'Transition("hit_left", "only", "only", left, reset=rebound)'
NAME = '    name="relay",\n'
NEAR = "lambda t, x, p: 3.0 - x[0] if x[1] < 0.9 else x[0] - 3.0"
JUMPING = (
    '    conditions=(Condition("o", lambda t, x, p: 1.0 if {} else -1.0, at="hit_right", side="{}"),),\n'
    "    period=period,\n"
)
PERIOD = "    period=period,\n"
PEAK = 'Transition("peak", "on", "on", lambda t, x, p: x[1] - 0.7, role="watched")'


def _condition(name: str, function: str, at: str = "warm") -> tuple[str, str]:
    return NAME, f'{NAME}    conditions=(Condition("{name}", lambda t, x, p: {function}, at="{at}"),),\n'


WRONG: dict[str, Wrong] = {
    # -- declarations ------------------------------------------------------------------------------------
    "target that does not exist": _refused(
        RELAY, "refers to mode 'idle'", "SYSTEM", (WARM, WARM.replace('"off"', '"idle"'))
    ),
    "source is a declaration": _refused(
        RELAY,
        "refers to mode Mode('on', ...), which is not declared. Modes are referred to by their names",
        "SYSTEM",
        (WARM, WARM.replace('"on"', 'Mode("on", heating)')),
    ),
    "modes are functions": _refused(
        RELAY, "modes contains the function heating", "SYSTEM", ('Mode("on", heating)', "heating")
    ),
    "two transitions of one name": _refused(
        RELAY, "transitions has 'cool' twice", "SYSTEM", (COOL, f"{COOL}, {COOL.replace('cold', 'hot')}")
    ),
    "two modes of one name": _refused(RELAY, "modes has 'on' twice", "SYSTEM", ('Mode("off"', 'Mode("on"')),
    "direction up": _refused(RELAY, "has direction 'up'", "Transition(", (WARM, f'{WARM[:-1]}, "up")')),
    "direction is a function": _refused(
        RELAY, "has direction the function heating", 'Transition("warm"', (WARM, f"{WARM[:-1]}, heating)")
    ),
    "role misspelt": _refused(
        RELAY, "has role 'Hard'", 'Transition("warm"', (WARM, f'{WARM[:-1]}, role="Hard")')
    ),
    "level in both directions": _refused(
        RELAY, "no side of its guard", 'Transition("warm"', (WARM, f'{WARM[:-1]}, "both", level=True)')
    ),
    "level of a watched one": _refused(
        RELAY, "does not act", 'Transition("warm"', (WARM, f'{WARM[:-1]}, role="watched", level=True)')
    ),
    "level of time alone": _refused(
        BALL,
        "it depends on time alone",
        'Transition("kick"',
        ("height, reset=bounce)", CLOCK.format("lambda t, x, p: math.sin(t)", ", level=True")),
    ),
    "constant of a parameter's name": _refused(
        RELAY,
        "has the constant 'r', which is a parameter",
        "SYSTEM",
        ('"on", heating)', '"on", heating, constants={"r": 3.0})'),
    ),
    "constant of a state's name": _refused(
        RELAY,
        "has the constant 'x', which is a state",
        "SYSTEM",
        ('"on", heating)', '"on", heating, constants={"x": 3.0})'),
    ),
    "condition of a state's name": _refused(
        RELAY, "'x' is a state and a condition", "SYSTEM", _condition("x", "x[0]")
    ),
    "condition of a parameter's name": _refused(
        RELAY, "'k' is a parameter and a condition", "SYSTEM", _condition("k", "x[0]")
    ),
    "condition of a result's name": _refused(
        RELAY, "calls a condition 'stable'", "SYSTEM", _condition("stable", "x[0]")
    ),
    "condition of an observable's name": _refused(
        RELAY,
        "'o' is an observable and a condition",
        "SYSTEM",
        _condition("o", "x[0]"),
        (NAME, f'{NAME}    observables=(Observable("o", lambda t, x, p: x[:, 0].max()),),\n'),
    ),
    "watched transition of a parameter's name": _refused(
        RELAY,
        "'k' is a parameter and a watched transition",
        "SYSTEM",
        (COOL, f"{COOL}, {PEAK.replace('peak', 'k')}"),
    ),
    "condition at a watched transition": _refused(
        RELAY,
        "no transition that acts",
        "SYSTEM",
        (COOL, f"{COOL}, {PEAK}"),
        _condition("o", "x[0]", at="peak"),
    ),
    "condition that is true or false": _refused(
        RELAY, "True or False", 'Condition("o"', _condition("o", "x[0] > 0")
    ),
    "condition of all states": _refused(RELAY, "array of shape (2,)", 'Condition("o"', _condition("o", "x")),
    "mode with an unknown state": _refused(
        CONTACT,
        "has the state 'z', which is not declared",
        "SYSTEM",
        ('states=("x", "y")', 'states=("x", "z")'),
    ),
    "mode without states": _refused(
        CONTACT, "has no states: nothing moves in it", "SYSTEM", ('states=("x", "y")', "states=()")
    ),
    # -- guards ------------------------------------------------------------------------------------------
    "guard is an array": _guard("np.array([0.5 - x[0], 0.0])", "an array of shape (2,)"),
    "guard is an array of one": _guard("np.array([0.5 - x[0]])", "an array of shape (1,)"),
    "guard is true or false": _guard("x[0] < 0.5", "True or False"),
    "guard is made true or false": _guard("bool(x[0] < 0.5)", "so it never passes zero"),
    "guard is complex": _guard("0.5 - x[0] + 0.3j", "complex number"),
    "guard is text": _guard("'x'", "A number is needed here, and this is 'x'"),
    "guard is nothing on one side": _guard("0.5 - x[0] if x[0] < 0.5 else None", "It returns nothing"),
    "guard is constant": _guard("0.5", "so it never passes zero"),
    "guard is zero": _guard("x[0] - x[0]", "so it never passes zero"),
    "guard of a parameter": _guard("p.k - 1.0", "so it never passes zero"),
    "guard of a state that does not exist": _guard("0.5 - x[F]", "so it never passes zero"),
    "guard is a sign": _guard("np.sign(0.5 - x[0])", "so it never passes zero"),
    "guard is always positive": _guard("x[0] ** 2 + 1.0", "It is never negative"),
    "guard is a square": _guard("(x[0] - 0.5) ** 2", "It is never negative"),
    "guard is minus a square": _guard("-(x[0] - 0.5) * (x[0] - 0.5)", "It is never positive"),
    "guard is an absolute value": _guard("abs(x[0] - 0.5)", "It is never negative"),
    "guard is cut off": _guard("max(0.5 - x[0], 0.0)", "It is never negative"),
    "guard is a root": _guard("math.sqrt(0.5 - x[0])", "It is never negative"),
    "guard is a distance": _guard("np.hypot(x[0] - 0.5, x[1])", "It is never negative"),
    "guard is random": _guard("0.5 - x[0] + 0.01 * np.random.rand()", "Called again it gives other values"),
    "guard of the wall clock": _guard(
        "0.5 - x[0] + 1e-3 * __import__('time').time()", "Called again it gives other values"
    ),
    "guard counts": _refused(
        CONTACT,
        "Called again it gives other values",
        "def gap",
        ("def gap(t, x, p):\n", "COUNT = [0]\n\ndef gap(t, x, p):\n    COUNT[0] += 1\n"),
        ("return 0.5 - x[X]", "return 0.5 - x[X] + 0.001 * COUNT[0]"),
    ),
    "guard remembers": _refused(
        CONTACT,
        "depends on an earlier call",
        "def gap",
        ("def gap(t, x, p):\n", "LAST = {}\n\ndef gap(t, x, p):\n    LAST.setdefault('x', x[X])\n"),
        ("return 0.5 - x[X]", "return 0.5 - LAST['x']"),
    ),
    "guard of another period": _guard("0.5 - x[0] + 0.1 * math.sin(1.3 * t)", "does not repeat after"),
    "guard of time with another period": _refused(
        BALL,
        "does not repeat after",
        'Transition("kick"',
        ("height, reset=bounce)", CLOCK.format("lambda t, x, p: math.sin(1.5 * t)", "")),
    ),
    "guard of time that passes once": _refused(
        BALL,
        "does not repeat after",
        'Transition("kick"',
        ("height, reset=bounce)", CLOCK.format("lambda t, x, p: t - 3.0", "")),
    ),
    "two transitions with one guard": _refused(
        RELAY,
        "It is the same as that of 'cool'",
        "def cold",
        (MODES, SPARE),
        (COOL, f'{COOL}, Transition("chill", "off", "spare", cold)'),
    ),
    "two transitions with guards that are alike": _refused(
        RELAY,
        "It is the same as that of 'cool'",
        'Transition("chill"',
        (MODES, SPARE),
        (COOL, f'{COOL}, Transition("chill", "off", "spare", lambda t, x, p: x[0] - 0.5, "both")'),
    ),
    "two stops at one place": _refused(
        STOPS, "It is the same as that of 'hit_right'", "def left", ("return 1.0 + x[0]", "return 1.0 - x[0]")
    ),
    "guard without a value beyond": _tried(
        "0.5 - x[0] if x[0] < 0.5 else math.nan", "error", "beyond, it has no value"
    ),
    "guard jumps": _tried("0.5 - x[0] if x[0] < 0.45 else -1.0", "error", "It jumps through zero"),
    "guard with a pole": _tried(
        "1.0 / (0.5 - x[0])", "error", "It jumps through zero, or passes it at a pole"
    ),
    "guard is a cube": _tried("(0.5 - x[0]) ** 3", "error", "it only comes to it"),
    "condition that reads what does not exist": _found(
        CONTACT,
        "warning",
        "It reads x[2] (state f), which does not exist in mode 'free'",
        'Condition("o"',
        (
            '    name="contact",\n',
            '    name="contact",\n    conditions=(Condition("o", lambda t, x, p: x[F], "hit"),),\n',
        ),
    ),
    # -- resets ------------------------------------------------------------------------------------------
    "reset without a new state": _refused(
        CONTACT, "does not write x_plus[2] (state f)", "def touch", ("    x_plus[F] = 0.01\n", "")
    ),
    "reset writes too much": _touch(
        "x_plus[F] = 0.01\n    x_plus[3] = 0.0", "index 3 is out of bounds", "x_plus[3]"
    ),
    "reset of an unknown name": _touch("x_plus[G] = 0.01", "name 'G' is not defined", "x_plus[G]"),
    "reset by the name of a state": _touch('x_plus["f"] = 0.01', "IndexError", 'x_plus["f"]'),
    "reset by an attribute": _touch("x_plus.f = 0.01", "AttributeError", "x_plus.f"),
    "reset of what the target mode knows": _refused(
        CONTACT,
        "no parameter 'on'",
        "x_plus[F] = 0.01 * p.on",
        ('"pressed", pressed)', '"pressed", pressed, constants={"on": 1.0})'),
        ("x_plus[F] = 0.01", "x_plus[F] = 0.01 * p.on"),
    ),
    "reset returns the state": _refused(
        CONTACT, "does not write x_plus[0]", "def touch", (WHOLE, "    return [x[X], x[Y], 0.01]\n")
    ),
    "reset without its argument": _refused(
        CONTACT,
        "takes 3 positional arguments but 4 were given",
        "def touch",
        ("def touch(t, x, p, x_plus):\n" + WHOLE, "def touch(t, x, p):\n    return [x[X], x[Y], 0.01]\n"),
    ),
    "reset writes the state before": _refused(
        CONTACT, "does not write x_plus[0]", "def touch", (WHOLE, "    x[F] = 0.01\n")
    ),
    "reset makes another array": _refused(
        CONTACT,
        "does not write x_plus[0]",
        "def touch",
        (WHOLE, "    x_plus = x.copy()\n    x_plus[F] = 0.01\n"),
    ),
    "reset to nothing": _touch("x_plus[F] = None", "does not write x_plus[2]"),
    "reset is complex": _touch("x_plus[F] = 0.01 + 0.1j", "complex number"),
    "reset is no number": _touch("x_plus[F] = math.nan", "not finite at any state"),
    "reset is infinite": _found(
        CONTACT, "error", "not finite at any state", "def touch", ("x_plus[F] = 0.01", "x_plus[F] = math.inf")
    ),
    "reset without a value": _found(
        CONTACT,
        "error",
        "sqrt of",
        "math.sqrt",
        ("x_plus[F] = 0.01", "x_plus[F] = math.sqrt(-1.0 - x[X] ** 2)"),
    ),
    "reset of a singular matrix": _found(
        CONTACT,
        "error",
        "the matrix of 2 rows is singular",
        "np.linalg",
        ("x_plus[F] = 0.01", "x_plus[F] = np.linalg.solve(np.array([[1.0, 2.0], [2.0, 4.0]]), x[:2])[0]"),
    ),
    "reset reads what does not exist": _found(
        CONTACT, "warning", "It reads x[2] (state f)", "def touch", ("= 0.01", "= 0.01 + x[F]")
    ),
    "reset is random": _refused(
        BALL,
        "Called again it gives other values",
        "def bounce",
        ("- p.k * x[1]", "- np.random.rand() * x[1]"),
    ),
    "reset counts": _refused(
        BALL,
        "Called again it gives other values",
        "def bounce",
        ("def bounce(t, x, p, x_plus):\n", "HITS = [0]\n\ndef bounce(t, x, p, x_plus):\n    HITS[0] += 1\n"),
        ("- p.k * x[1]", "- p.k * x[1] / HITS[0]"),
    ),
    "reset raises for some": _found(
        BALL,
        "warning",
        "On one of its paths it raises ValueError: broken",
        "raise ValueError",
        (
            "    x_plus[0] = x[0]\n",
            '    if x[1] < -1.5:\n        raise ValueError("broken")\n    x_plus[0] = x[0]\n',
        ),
    ),
    "reset of the wrong sign": _found(
        STOPS,
        "warning",
        "or goes on through it, at every state",
        "def rebound",
        ("-0.6 * x[1]", "0.6 * x[1]"),
    ),
    "no reset at a stop": _refused(
        STOPS, "It changes nothing", "def right", ('"only", right, reset=rebound', '"only", right')
    ),
    "soft without a reset in its own mode": _refused(
        STOPS, "It changes nothing", "def right", ("right, reset=rebound", 'right, role="soft"')
    ),
    "reset that takes the rate": _found(
        BALL,
        "error",
        "does not leave its guard behind",
        "def bounce",
        ("(1.0 + p.k) * p.r * math.cos(t) - p.k * x[1]", "p.r * math.cos(t)"),
    ),
    "reset that jumps at its own event": _refused(
        STOPS,
        "It jumps here (sign) at every state of its own event that was tried",
        "-0.6 * x[1]",
        ("-0.6 * x[1]", "-0.6 * x[1] + 0.1 * np.sign(x[0] - 1.0)"),
    ),
    "reset that compares what its guard compares": _refused(
        BALL,
        "It jumps here (a comparison) at every state of its own event that was tried",
        "if x[0] >",
        ("- p.k * x[1]", "- (p.k if x[0] > p.r * math.sin(t) else 0.0) * x[1]"),
    ),
    "reset to where the guard is": _refused(
        BALL,
        "It changes nothing: wherever its guard is zero",
        "def bounce",
        ("x_plus[0] = x[0]", "x_plus[0] = p.r * math.sin(t)"),
        ("(1.0 + p.k) * p.r * math.cos(t) - p.k * x[1]", "x[1]"),
    ),
    "reset that adds its guard": _refused(
        STOPS,
        "It changes nothing: wherever its guard is zero",
        "def rebound",
        ("-0.6 * x[1]", "x[1] + p.k * (1.0 - x[0])"),
        (f", events={IMAGES}", ""),
    ),
    # -- soft transitions --------------------------------------------------------------------------------
    "soft where the field jumps": _refused(
        RELAY,
        "It is soft, but the field jumps there: dx[0] (state x)",
        "def hot",
        (WARM, f'{WARM[:-1]}, role="soft")'),
    ),
    "soft where the state jumps": _refused(
        RELAY,
        "The transition is soft, but its reset changes y",
        'Transition("warm"',
        (WARM, f'{WARM[:-1]}, reset={LOSS}, role="soft")'),
    ),
    "soft between modes of other states": _refused(
        CONTACT,
        "do not have the same states (f)",
        "def gap",
        ("gap, reset=touch", 'gap, reset=touch, role="soft"'),
    ),
    # -- what follows what -------------------------------------------------------------------------------
    "transitions for ever": _found(
        RELAY,
        "error",
        "More than 100 transitions follow each other",
        "def hot",
        ("x[0] - 0.5", "x[0] - 1.5"),
        (WARM, f"{WARM[:-1]}, level=True)"),
        (COOL, f"{COOL[:-1]}, level=True)"),
    ),
    "relay without hysteresis": _found(
        RELAY,
        "error",
        "More than 100 transitions follow each other",
        "def hot",
        (COOL, COOL.replace("cold", 'hot, "rising"')),
    ),
    "relay of one threshold": _found(
        RELAY,
        "error",
        "More than 100 transitions follow each other",
        "def cold",
        ("x[0] - 0.5", "x[0] - 1.0"),
    ),
    "reset into the next event": _found(
        CONTACT,
        "error",
        "More than 100 transitions follow each other",
        "def leave",
        ("x_plus[F] = 0.01", "x_plus[F] = -0.5"),
        ("force, reset=leave", "force, reset=leave, level=True"),
    ),
    "hysteresis the other way round": _found(
        RELAY,
        "warning",
        "After it no transition out of mode 'off' can happen any more",
        "def hot",
        ("x[0] - 0.5", "x[0] - 1.5"),
    ),
    "hysteresis that is passed the other way": _found(
        RELAY, "warning", "It passes zero the other way at all", "def hot", (WARM, f'{WARM[:-1]}, "rising")')
    ),
    "mode that no transition leads to": _found(
        RELAY, "warning", "No transition that acts leads to it", "def cooling", (MODES, SPARE)
    ),
    "event that is only watched": _found(
        RELAY,
        "warning",
        "No transition that acts leads to it",
        "def cooling",
        (WARM, f'{WARM[:-1]}, role="watched")'),
    ),
    "no way back": _found(RELAY, "warning", "never come round", "def hot", (f"{COOL},\n", "\n")),
    "source and target exchanged": _found(
        CONTACT,
        "warning",
        "never come round",
        "def gap",
        ('"hit", "free", "pressed"', '"hit", "pressed", "free"'),
    ),
    # -- time --------------------------------------------------------------------------------------------
    "guard of time without a period": _found(
        RELAY,
        "error",
        "It depends on t, but the system declares no period",
        'Transition("kick"',
        (COOL, f'{COOL}, Transition("kick", "off", "off", lambda t, x, p: t - 3.0, "rising", reset={KICK})'),
    ),
    "reset of time without a period": _found(
        RELAY,
        "error",
        "It depends on t, but the system declares no period",
        'Transition("cool"',
        (COOL, f"{COOL[:-1]}, reset={KICK.replace('0.1', '0.1 * math.sin(t)')})"),
    ),
    # -- fields ------------------------------------------------------------------------------------------
    "field leaves out a state of its mode": _refused(
        CONTACT, "does not write dx[2] (state f)", "def pressed", ("    dx[F] = (p.k", "    unused = (p.k")
    ),
    "field reads what does not exist": _found(
        CONTACT, "warning", "It reads x[2] (state f)", "def free", ("- x[X]\n\n", "- x[X] - x[F]\n\n")
    ),
    "field of one mode with a singular matrix": _found(
        CONTACT,
        "error",
        "the matrix of 2 rows is singular",
        "np.linalg",
        ("dx[F] = (", "dx[F] = np.linalg.solve(np.array([[1.0, 2.0], [2.0, 4.0]]), x[:2])[0] + ("),
    ),
    "field raises for some": _found(
        BALL,
        "warning",
        "On one of its paths it raises ValueError: too fast",
        "raise ValueError",
        (
            "    dx[0] = x[1]\n",
            '    if x[1] > 1.2:\n        raise ValueError("too fast")\n    dx[0] = x[1]\n',
        ),
    ),
    "field with numba that counts": _refused(
        BALL,
        "Called again it gives other values",
        "def fall",
        (
            "def fall(",
            "import numba\nSEEN = np.zeros(1)\n\n@numba.njit\ndef count(v):\n    SEEN[0] += 1.0\n"
            "    return v * SEEN[0]\n\ndef fall(",
        ),
        ("dx[1] = -0.5", "dx[1] = -count(0.5 + 0.0 * x[0])"),
    ),
    # -- symmetries, conserved quantities ----------------------------------------------------------------
    "mirror without events": _found(
        STOPS,
        "warning",
        "declare events={'hit_right': 'hit_left', ...}",
        "def mirrored",
        (f", events={IMAGES}", ""),
    ),
    "mirror of half the events": _found(
        STOPS,
        "warning",
        "It does not take transition 'hit_left' to itself",
        "def mirrored",
        (IMAGES, '{"hit_right": "hit_left"}'),
    ),
    "mirror of an unknown event": _refused(
        STOPS, "names the transition 'hit'", "SYSTEM", (IMAGES, '{"hit_right": "hit"}')
    ),
    "mirror of other resets": _found(
        STOPS,
        "warning",
        "It does not take transition 'hit_right' to 'hit_left'",
        "def mirrored",
        (LEFT, LEFT.replace("rebound", LOSS.replace("0.9", "-0.5"))),
    ),
    "mirror of modes with other fields": _refused(
        RELAY,
        "It does not hold in mode 'on'",
        'Symmetry("same"',
        (
            NAME,
            f'{NAME}    symmetries=(Symmetry("same", "spatial", {LOSS.replace("0.9 * ", "")}, '
            'modes={"on": "off", "off": "on"}),),\n',
        ),
    ),
    "relabelled by a mirror": _refused(
        STOPS,
        "which is no symmetry of role 'relabel'",
        "SYSTEM",
        (LEFT, f'{LEFT[:-1]}, relabel="mirror")'),
    ),
    "names that do not come back": _refused(
        STOPS,
        "Applied twice it does not give the state back",
        'Symmetry("swap"',
        ("    symmetries=(\n", f'    symmetries=(\n        Symmetry("swap", "relabel", {LOSS}),\n'),
        (LEFT, f'{LEFT[:-1]}, relabel="swap")'),
    ),
    "energy that a reset takes": _refused(
        HOP,
        "Transition 'land' does not keep it",
        'Transition("land"',
        ('"ground", height)', f'"ground", height, reset={LOSS})'),
    ),
    "energy that the field takes": _refused(
        HOP,
        "It is not conserved in mode 'air'",
        "def energy",
        ("dx[1] = -p.r\n", "dx[1] = -p.r - 0.1 * x[1]\n"),
    ),
    "energy of another mode": _refused(
        HOP, "It is not conserved in mode", "def pressed", ('"air": energy', '"air": pressed')
    ),
    "energy that is a constant": _refused(
        HOP,
        "It depends on no state in mode 'air'",
        'Conserved("energy"',
        ('{"air": energy, "ground": pressed}', "lambda t, x, p: 1.0"),
    ),
    "energy of one mode only": _refused(
        HOP, "has no function for mode 'ground'", "SYSTEM", (', "ground": pressed', "")
    ),
    "energy of a state's name": _refused(
        HOP, "'x' is a state and a conserved quantity", "SYSTEM", ('Conserved("energy"', 'Conserved("x"')
    ),
    # -- neutral directions ------------------------------------------------------------------------------
    "neutral direction that a reset breaks": _found(
        WHEEL,
        "warning",
        "Transition 'strike' does not keep it: s moves by 0.9 after it",
        "def strike",
        ("x[2] + 0.5", "0.9 * x[2]"),
    ),
    "neutral direction that a guard breaks": _found(
        WHEEL,
        "warning",
        "Transition 'strike' does not keep it: its guard changes along it",
        "def foot",
        ("0.4 - x[0]", "0.4 - x[0] + 0.1 * math.sin(x[2])"),
    ),
    "neutral direction that moves another state after an event": _found(
        WHEEL,
        "warning",
        "Transition 'strike' does not keep it: u moves by 0.01",
        "def strike",
        ("0.7 * x[1]", "0.7 * x[1] + 0.01 * x[2]"),
    ),
    "neutral direction of the wrong state": _refused(
        WHEEL,
        "It is neutral nowhere: moved along it, dx[0] (state theta) changes in mode 'rolling'",
        "def along",
        ("0.0, 0.0, 1.0", "0.0, 1.0, 0.0"),
    ),
    "neutral direction that is none": _refused(
        WHEEL, "It is zero everywhere", "def along", ("0.0, 0.0, 1.0", "0.0, 0.0, 0.0")
    ),
    "neutral direction of time": _refused(
        WHEEL, "It depends on t", "def along", ("0.0, 0.0, 1.0", "0.0, 0.0, math.cos(t)")
    ),
    # -- conditions that jump ----------------------------------------------------------------------------
    "condition that jumps through zero": _found(
        STOPS,
        "warning",
        "It jumps through zero here (a comparison), at states where 'hit_right' happens",
        "Condition(",
        (PERIOD, JUMPING.format("x[1] < 0.9", "before")),
    ),
    "condition that jumps through zero after its event": _found(
        STOPS,
        "warning",
        "It jumps through zero here (a comparison), at states where 'hit_right' happens",
        "Condition(",
        (PERIOD, JUMPING.format("x[1] > -0.54", "after")),
    ),
    "watched guard that jumps through zero at an event": _found(
        STOPS,
        "warning",
        "It jumps through zero here (a comparison), at states where 'hit_right' happens",
        'Transition("near"',
        (LEFT, f'{LEFT}, Transition("near", "only", "only", {NEAR}, role="watched")'),
    ),
    # -- observables -------------------------------------------------------------------------------------
    "observable with a pole at an event": _found(
        STOPS,
        "warning",
        "It is not finite, or has a pole, at",
        "Observable(",
        (
            PERIOD,
            f'    observables=(Observable("o", lambda t, x, p: (1 / (x[:, 0] - 1.0)).max()),),\n{PERIOD}',
        ),
    ),
    "observable with a pole after an event": _found(
        RELAY,
        "warning",
        "states before 'cool'",
        "Observable(",
        (
            NAME,
            f'{NAME}    observables=(Observable("o", lambda t, x, p: np.mean((x[:, 0] - 0.5) ** -2.0)),),\n',
        ),
    ),
    # -- periods of angles -------------------------------------------------------------------------------
    "angle of a period that the field does not have": _refused(
        ROTOR,
        "The field of mode 'turning' is another one a period of 6.283185307 later: dx[1] (state rate)",
        "def turn",
        ("math.sin(2.0 * x[0])", "math.sin(0.5 * x[0])"),
    ),
    "angle with a spring": _refused(
        ROTOR,
        "The field of mode 'turning' is another one a period",
        "def turn",
        ("math.sin(2.0 * x[0])", "2.0 * x[0]"),
    ),
    "angle whose period is in degrees": _refused(
        ROTOR,
        "The field of mode 'turning' is another one a period of 360 later",
        "def turn",
        ("period=2.0 * math.pi", "period=360.0"),
    ),
    "angle whose period was typed": _refused(
        ROTOR,
        "It is the same after 2 * math.pi: write period=2 * math.pi, with all digits.",
        "def turn",
        ("period=2.0 * math.pi", "period=6.283"),
    ),
    "angle whose period of half a turn was typed": _refused(
        ROTOR,
        "It is the same after math.pi: write period=math.pi, with all digits.",
        "def turn",
        ("period=2.0 * math.pi", "period=3.1415927"),
    ),
    "angle whose period was typed with ten digits": _refused(
        ROTOR,
        "dx[1] (state rate) is 0.819451169 at angle = 1.288 and 0.819451168 a period later",
        "def turn",
        ("period=2.0 * math.pi", "period=6.283185307"),
    ),
    "angle of a guard that happens once": _found(
        ROTOR,
        "warning",
        "It is another one a period of 'angle' (6.283185307) later: its value",
        "def top",
        ("math.sin(x[0] - 1.0)", "x[0] - 1.0"),
    ),
    "angle of a reset that takes a part of it": _found(
        ROTOR,
        "warning",
        "It is another one a period of 'angle' (6.283185307) later: x_plus[0] (state angle)",
        "def push",
        ("after[0] = x[0]", "after[0] = 0.5 * x[0]"),
    ),
}
