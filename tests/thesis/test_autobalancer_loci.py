"""Curves of folds and Hopf points of the autobalancer's masses on the line, in speed and damping."""

from __future__ import annotations

import pytest

import contwalk as cw

# With 40 digits from conditions on the characteristic polynomial (omega, c); else the values of Table 1.
BT = {"omega": 1.099980514393239348, "c": 0.12925308868730382471}
RANGES = {"omega": (0.5, 2.0), "c": (0.01, 1.0)}


@pytest.mark.parametrize("which", ["LP1", "HB1"])
def test_both_curves_pass_the_bogdanov_takens_point(which) -> None:
    system = cw.load_system("autobalancer")
    parameters = system.all_parameters({**system.presets["table1"], "c": 0.1, "omega": 1.3})
    state = system.named_states("together", parameters)[0]
    branch = cw.continue_branch(
        cw.Equilibrium(system, parameters, "omega"), state.tolist(), range=RANGES["omega"]
    )
    found = cw.continue_locus(system, branch, which, RANGES)
    assert found.outcome.reason == "bound"
    (point,) = (p for p in found.special_points if p.label != "EP")
    assert (point.label, point.status) == ("BT", "located")
    for name, value in BT.items():
        error = abs(point.parameters[name] - value)
        assert error <= point.errors[name] + 2.0**-53 * value
        assert error <= 1e-14 * value
