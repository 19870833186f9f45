"""Curves of folds and Hopf points of the autobalancer's masses on the line, in speed and damping."""

from __future__ import annotations

import pytest

import contwalk as cw

# With 40 digits from conditions on the characteristic polynomial (omega, c); else the values of Table 1.
BT = {"omega": 1.099980514393239348, "c": 0.12925308868730382471}
RANGES = {"omega": (0.5, 2.0), "c": (0.01, 1.0)}


@pytest.mark.drawn(1)
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


# The least delta at which the balanced state is stable (Fig. 12), and the frequency there, by c; 40 digits:
# omega = 5, Table 1 but for m.
BORDER = {
    0.25: (1.68643356563978e-5, 0.186312694065227),
    2.5: (1.85378371435317e-4, 0.188755092885458),
    20.0: (3.07715678952989e-3, 0.0966365607414619),
}


def test_the_border_of_stability_over_damping_and_its_bautin_points() -> None:
    system = cw.load_system("autobalancer")
    values = {**system.presets["table1"], "omega": 5.0, "m": 0.019, "c": 1.0, "delta": 0.005}
    parameters = system.all_parameters(values)
    state = system.named_states("balanced", parameters)[0]
    branch = cw.continue_branch(
        cw.Equilibrium(system, parameters, "delta"), state.tolist(), range=(1e-6, 0.1)
    )
    ranges = {"c": (0.2, 21.0), "delta": (1e-8, 1.0)}
    border = cw.continue_locus(system, branch, "HB1", ranges, marks={"c": list(BORDER)})
    marked = {p.parameters["c"]: p for p in border.special_points if p.label == "UZ"}
    assert sorted(marked) == sorted(BORDER)
    for c, (delta, frequency) in BORDER.items():
        assert marked[c].parameters["delta"] == pytest.approx(delta, rel=1e-12)
        square = border["frequency_squared"][marked[c].index]
        assert square**0.5 == pytest.approx(frequency, rel=1e-12)
    # The first Lyapunov coefficient changes its sign along the border.
    bautin = [p for p in border.special_points if p.label == "GH"]
    assert [p.status for p in bautin] == ["located"] * 3
    assert [p.parameters["c"] for p in bautin] == pytest.approx([1.31515192838, 4.83698433115, 17.0174667076])
