"""Contacts by Hertz: `systems check` warns of powers that begin at zero, and not of the remedy."""

import pytest
from checked_plugins import checked

PLUGIN = """
import numpy as np
from contwalk.system import Mode, Parameter, State, System, Transition

def free(t, x, p, dx):
    dx[0] = x[1]
    dx[1] = -1.0 - 0.1 * x[1]

def contact(t, x, p, dx):
    depth = -x[0]
    dx[0] = x[1]
    dx[1] = -1.0 - 0.1 * x[1] + p.k * FORCE

def gap(t, x, p):
    return x[0]

SYSTEM = System(
    name="ball",
    states=(State("height"), State("speed")),
    parameters=(Parameter("k", 100.0),),
    modes=(Mode("free", free), Mode("contact", contact)),
    transitions=(
        Transition("touch", "free", "contact", gap, "falling", role="soft"),
        Transition("leave", "contact", "free", gap, "rising", role="soft"),
    ),
)
"""


def told(tmp_path, force):
    return [f for f in checked(tmp_path, PLUGIN.replace("FORCE", force)) if "cut at zero" in f.sentence]


@pytest.mark.parametrize(
    ("force", "what"),
    [
        ("np.maximum(depth, 0.0)**1.5", "power 1.5 of what is cut at zero has no bound of its second"),
        ("(depth**1.5 if depth > 0.0 else 0.0)", "power 1.5"),
        ("max(-x[0], 0)**1.5", "power 1.5"),
        ("np.sqrt(np.maximum(depth, 0.0))", "power 0.5 of what is cut at zero has no bound of its slope"),
    ],
)
def test_powers_below_the_second_of_what_is_cut_at_zero_are_warned_of(tmp_path, force, what):
    (found,) = told(tmp_path, force)
    assert found.level == "warning"
    assert what in found.sentence
    assert "max(..., 1e-12)" in found.sentence
    assert found.line == 9


@pytest.mark.parametrize(
    "force", ["np.maximum(depth, 1e-12)**1.5", "np.maximum(depth, 0.0)**2.5", "abs(depth)"]
)
def test_others_are_not(tmp_path, force):
    assert told(tmp_path, force) == []
