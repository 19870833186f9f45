"""The page on machines that scuff: its machine runs as it stands, and does what the page says."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from code_blocks import blocks, commands, run_command
from scipy.integrate import solve_ivp

import contwalk as cw

PAGE = "docs/howto/scuffing.md"


@pytest.fixture(scope="module")
def walked(tmp_path_factory):
    """The folder after all commands of the page, and their outputs."""
    where = tmp_path_factory.mktemp("scuffing")
    (plugin,), (study,) = blocks(PAGE, "python"), blocks(PAGE, "yaml")
    (where / "compass.py").write_text(plugin, encoding="utf-8")
    (where / "compass.yaml").write_text(study, encoding="utf-8")
    return where, {line: run_command(line, where) for line in commands(PAGE)}


def test_the_plugin_passes_the_check(walked):
    assert "0 warnings, 0 errors" in walked[1]["contwalk systems check compass.py"]


def test_the_compass_gait_doubles_where_it_is_known_to(walked):
    gait, limping = cw.open_database(walked[0] / "compass.h5").branches()
    (point,) = [p for p in gait.special_points if p.label == "PD"]
    # Computed independently, to 2e-10.
    assert abs(point.parameters["slope"] - 0.0766356315556) <= point.error + 2e-10
    assert point.criticality == "supercritical"
    assert limping.info.signature.count("heel_strike") == 2
    # Both angles at heel strike leave that of the gait, to either side of it.
    first, second = limping["stance"], limping["stance@2"]
    at = gait["stance"][point.index]
    away = limping["slope"] > point.parameters["slope"] + 1e-6
    assert away.sum() > 5
    assert np.all(np.abs(first - second)[away] > 1e-4)
    assert np.abs(first[~away] - at).max() < 1e-3


def lowest(plugin: dict, point) -> float:
    """How far the foot clears the slope at its lowest in a step, by SciPy."""
    p = SimpleNamespace(**point.parameters)
    before, start = np.array(list(point.state.values())), np.empty(4)
    plugin["lands"](0.0, before, p, start)

    def field(t, x):
        dx = np.empty(4)
        plugin["walking"](t, x, p, dx)
        return dx

    def legs_pass(t, x):
        return plugin["passing"](t, x, p)

    legs_pass.terminal, legs_pass.direction = True, -1.0
    step = solve_ivp(
        field, (0.0, 2.0), start, method="DOP853", rtol=1e-12, atol=1e-13, events=legs_pass, dense_output=True
    )
    times = np.linspace(0.0, step.t[-1], 4001)
    clear = plugin["clearance"](0.0, step.sol(times), p)
    k = int(np.argmin(clear))
    assert 0 < k < len(times) - 1
    bottom = np.polynomial.Polynomial.fit(times[k - 1 : k + 2], clear[k - 1 : k + 2], 2)
    return float(bottom(bottom.deriv().roots()[0]))


def test_the_foot_touches_the_slope_where_it_is_told(walked):
    gait, _ = cw.open_database(walked[0] / "compass.h5").branches()
    (point,) = [q for q in gait.special_points if q.label == "GR"]
    assert point.parameters["slope"] == pytest.approx(0.0619, abs=5e-5)  # as the page says
    plugin: dict = {"__name__": "compass"}
    exec((walked[0] / "compass.py").read_text(encoding="utf-8"), plugin)
    clear = lowest(plugin, point)
    # The clearance falls with the slope, at this rate.
    rate = np.polyfit(gait["slope"], gait["scuffs"], 3)
    slope = abs(float(np.polyval(np.polyder(rate), point.parameters["slope"])))
    assert abs(clear) <= slope * point.error + 1e-11
    beyond = gait["slope"] > point.parameters["slope"]
    assert np.array_equal(gait["admissible"], ~beyond)
    assert np.all(np.diff(gait["scuffs"][np.argsort(gait["slope"])]) < 0.0)
