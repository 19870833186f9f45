"""Machines whose modes a state tells that stands still between events, as a text of equations has them."""

import pytest

import contwalk as cw

# Two rooms; a heater in the first is put on and off by its temperature.
ROOMS = """
x' = -a*(x - Ta) + P*h + c*(y - x)
y' = -a*(y - Ta) + c*(x - y)
h' = 0
a = 0.3; Ta = 10; P = 10; c = 0.5; lo = 19; hi = 21
event off: x - hi rises, h = 0
event on: x - lo falls, h = 1
"""


def test_a_rest_on_a_guard_is_where_the_period_runs_off():
    """The heater cannot be put off where both rooms are at rest at `hi`: the flag has no rate, and equilibria
    with all its values stand in a row.
    """
    start = {"simulate": {"state": {"x": 20.0, "y": 18.0, "h": 1.0}, "until": "settled"}}
    found = cw.diagram(cw.system_from_text(ROOMS), "P", (3.2, 10.5), start=start)
    outcome = found["b1"].outcome
    assert (outcome.status, outcome.reason) == ("stopped", "homoclinic"), outcome.message
    assert "x = 21, y = 16.875, h = 1" in outcome.message
    # a (x - Ta) + c (x - y) = P at rest, where y - Ta = c / (a + c) (x - Ta)
    value = float(outcome.message.split(" at P = ")[1].split(" +- ")[0])
    assert value == pytest.approx(11.0 * (0.8 - 0.25 / 0.8), abs=1e-9)
