"""`contwalk systems slide`: the text that it prints, pasted into the plugin, is the mode that was meant."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from contwalk.flow.hybrid.motion_segment import Control
from contwalk.flow.hybrid.motions import hybrid_machine, motion_segments
from contwalk.system import Mode, System, Transition
from contwalk.system.declarations import ParameterValues

DECLARED = """
from contwalk.system import Mode, Parameter, State, System, Transition
SYSTEM = System("sliding", states=({states}), parameters=({parameters}),
    modes=(Mode("plus", plus), Mode("minus", minus)),
    transitions=({transitions}),
)
"""
BOTH = (
    'Transition("down", "plus", "minus", {guard}, "falling"), '
    'Transition("up", "minus", "plus", {guard}, "rising")'
)


def plugin(functions: str, n: int, parameters: dict[str, float], transitions: str = "") -> str:
    declared = DECLARED.format(
        states=", ".join(f'State("x{i + 1}")' for i in range(n)) + ",",
        parameters="".join(f'Parameter("{name}", {value!r}), ' for name, value in parameters.items()),
        transitions=transitions or BOTH.format(guard="surface"),
    )
    return f"import math\nimport numpy as np\n{functions}{declared}"


# Third-order relay feedback (di Bernardo, Johansson and Vasca 2001); its sliding field is known.
RELAY = plugin(
    """
def plant(x, p, dx, u):
    dx[0] = -(2.0 * p.zeta + 1.0) * x[0] + x[1] + u
    dx[1] = -(2.0 * p.zeta + 1.0) * x[0] + x[2] - 2.0 * u
    dx[2] = -x[0] + u

def plus(t, x, p, dx):
    plant(x, p, dx, -1.0)

def minus(t, x, p, dx):
    plant(x, p, dx, 1.0)

def surface(t, x, p):
    return x[0]
""",
    3,
    {"zeta": 0.5},
)
# Coulomb friction on a belt whose speed swings: the guard depends on the time.
BELT = plugin(
    """
def speed(t):
    return 0.2 + 0.1 * math.sin(t)

def force(x, p):
    return -x[0] - (p.c * x[1] if x[1] > 0.0 else 0.0)

def plus(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = force(x, p) - p.f

def minus(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = force(x, p) + p.f

def surface(t, x, p):
    return x[1] - speed(t)
""",
    2,
    {"c": 0.1, "f": 0.7},
)
# A curved surface, a matrix, choices and functions of all kinds.
CURVED = plugin(
    """
def pulled(t, x, p, dx, u):
    M = np.array([[2.0, np.cos(x[0])], [np.cos(x[0]), 1.0 + p.m]])
    b = np.where((x[0] > 0.1) & ~(x[1] > 2.0), x[0] ** 3, -x[1])
    a = np.linalg.solve(M, np.array([u - b, np.arctan2(x[1], 3.0)]))
    dx[0] = a[0] + abs(x[1]) ** 1.5
    dx[1] = a[1] - max(x[2], 0.1) / (1.0 + x[2] ** 2) + np.exp(-x[0]) * (x[0] - (x[1] - x[2]))
    dx[2] = -x[2] + np.sign(x[0]) * np.tanh(x[1])

def plus(t, x, p, dx):
    pulled(t, x, p, dx, -2.0 - x[2] ** 2)

def minus(t, x, p, dx):
    pulled(t, x, p, dx, 3.0)
    dx[2] = dx[2] + 0.5 * math.sin(t)

def surface(t, x, p):
    return p.m * x[0] ** 2 + math.sin(x[0]) + x[2] * x[1] - 0.3
""",
    3,
    {"m": 0.7},
)


def slid(contwalk: Any, folder: Path, text: str, *more: str) -> str:
    (folder / "machine.py").write_text(text)
    done = contwalk("systems", "slide", "./machine.py", *more)
    assert done.code == 0, done.err
    return done.out


def pasted(text: str, printed: str) -> tuple[dict[str, Any], System]:
    """The plugin's names with the printed functions, and the system with the printed declarations."""
    names: dict[str, Any] = {}
    exec(text, names)
    exec(printed, names)
    own: System = names["SYSTEM"]
    declared = [
        line.removeprefix("#     ").rstrip(",") for line in printed.splitlines() if line.startswith("#     ")
    ]
    values = [eval(line, names) for line in declared]
    modes = [value for value in values if isinstance(value, Mode)]
    transitions = [value for value in values if isinstance(value, Transition)]
    assert (len(modes), len(transitions)) == (1, 4)
    return names, System(
        "pasted", own.states, own.parameters, modes=(*own.modes, *modes), transitions=transitions
    )


@pytest.mark.parametrize("text", [RELAY, BELT, CURVED], ids=["relay", "belt", "curved"])
def test_the_field_is_the_mean_that_keeps_the_guard(contwalk, folder, text):
    """Against (L2 f1 - L1 f2) / (L2 - L1) with gradients from differences."""
    names, system = pasted(text, slid(contwalk, folder, text))
    n, random = len(system.states), np.random.default_rng(3)
    p = ParameterValues(**system.defaults())

    def rate(field, t, x):
        dx = np.zeros(n)
        field(t, x, p, dx)
        return dx

    for _ in range(20):
        t, x = random.uniform(0.0, 5.0), random.standard_normal(n)
        guard, h = names["surface"], 1e-6
        for _ in range(60):  # onto the surface: where the guard is made of one state that is held exactly
            slope = np.array(
                [(guard(t, x + h * e, p) - guard(t, x - h * e, p)) / (2.0 * h) for e in np.eye(n)]
            )
            x = x - guard(t, x, p) * slope / (slope @ slope)
        by_time = (guard(t + h, x, p) - guard(t - h, x, p)) / (2.0 * h)
        above, below = rate(names["plus"], t, x), rate(names["minus"], t, x)
        up, down = slope @ above + by_time, slope @ below + by_time
        assert names["slide_up"](t, x, p) == pytest.approx(up, abs=1e-6)
        assert names["slide_down"](t, x, p) == pytest.approx(down, abs=1e-6)
        mean = (down * above - up * below) / (down - up)
        assert rate(names["slide_field"], t, x) == pytest.approx(mean, rel=1e-5, abs=1e-5)


def motion(system: System, state: list[float], mode: str, until: float) -> tuple[list[str], np.ndarray]:
    machine = hybrid_machine(system, system.defaults())
    control = Control(1e-11, np.ones(len(state)), "dop853")
    arcs = list(motion_segments(machine, 0.0, np.array(state), mode, until, control, None))
    assert arcs[-1].status == "ok"
    return [arc.mode for arc in arcs], arcs[-1].states[-1]


def test_the_relay_moves_as_with_the_mode_that_is_known(contwalk, folder):
    _, system = pasted(RELAY, slid(contwalk, folder, RELAY))
    by_hand: dict[str, Any] = {}
    exec(RELAY, by_hand)

    def slides(t, x, p, dx):
        by_hand["plant"](x, p, dx, -x[1])

    known = System(
        "known",
        system.states,
        system.parameters,
        modes=(*system.modes[:2], Mode("slide", slides)),
        transitions=(
            *system.transitions[:2],
            Transition("leaves_up", "slide", "plus", lambda t, x, p: x[1] - 1.0, "rising", level=True),
            Transition("leaves_down", "slide", "minus", lambda t, x, p: x[1] + 1.0, "falling", level=True),
        ),
    )
    found, expected = (motion(each, [0.5, 0.0, 0.5], "plus", 30.0) for each in (system, known))
    assert found[0] == expected[0]
    assert "slide" in found[0]
    assert len(found[0]) > 8
    np.testing.assert_allclose(found[1], expected[1], rtol=0.0, atol=1e-9)


def test_a_block_sticks_to_a_belt_whose_speed_swings(contwalk, folder):
    """It moves with the belt as long as friction suffices for that."""
    _, system = pasted(BELT, slid(contwalk, folder, BELT))
    modes, x = motion(system, [0.0, 0.0], "minus", 2.0)
    assert modes == ["minus", "slide"]
    assert x[1] == pytest.approx(0.2 + 0.1 * math.sin(2.0), abs=1e-9)
    modes, _ = motion(system, [0.0, 0.0], "minus", 8.0)
    assert modes[:3] == ["minus", "slide", "minus"]


def test_a_choice_of_surface_and_of_a_name(contwalk, folder):
    one = BOTH.format(guard="surface")
    two = 'Transition("far", "plus", "minus", lambda t, x, p: x[1] - 3.0, "falling")'
    text = plugin(RELAY.split("SYSTEM")[0].split("from contwalk")[0], 3, {"zeta": 0.5}, f"{one}, {two}")
    (folder / "machine.py").write_text(text)
    refused = contwalk("systems", "slide", "./machine.py")
    assert refused.code == 2
    assert "2 switching surfaces" in refused.err
    assert "--at" in refused.err
    printed = slid(contwalk, folder, text, "--at", "far", "--name", "held")
    assert 'Transition("far", "plus", "held", held_guard, "falling")' in printed
    assert "No transition out of 'minus' leads over the surface" in printed
    assert "does not end 'held' until it is declared" in printed
    assert contwalk("systems", "slide", "./machine.py", "--at", "near").code == 2


def test_a_file_is_written_and_not_replaced(contwalk, folder):
    (folder / "machine.py").write_text(RELAY)
    assert contwalk("systems", "slide", "./machine.py", "-o", "slide.py").code == 0
    assert "def slide_field" in (folder / "slide.py").read_text()
    assert "exists" in contwalk("systems", "slide", "./machine.py", "-o", "slide.py").err


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (RELAY.replace("- 2.0 * u", "- 2.0").replace("x[1] + u", "x[1]"), "at one rate in both modes"),
        (RELAY.replace('"falling")', '"falling", reset=moved)').replace('"rising")', '"rising", reset=moved)')
         .replace("def surface", "def moved(t, x, p, x_plus):\n    x_plus[:] = 0.9 * x\n\ndef surface"),
         "no switching surface"),
        (RELAY.replace('"falling"', '"both"').replace('"rising"', '"both"'), "no switching surface"),
        (BELT.replace("p.f", "np.interp(x[0], [0.0, 1.0, 3.0], [0.7, 0.8, 0.9])"), "by hand"),
    ],
    ids=["rate", "reset", "both", "table"],
)  # fmt: skip
def test_what_has_no_sliding_mode_is_refused(contwalk, folder, text, said):
    (folder / "machine.py").write_text(text)
    refused = contwalk("systems", "slide", "./machine.py")
    assert refused.code == 2
    assert said in refused.err
