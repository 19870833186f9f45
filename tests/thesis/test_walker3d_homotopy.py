"""Paper 8, Figure 7: both ends of the straight line between the walkers, each to the torus that it comes to.

The end that can be built is computed from its own printed state, back along the line: another start and other
steps than those by which the run file reaches it.
"""

from __future__ import annotations

import pytest
from autobalancer_figures import RUNS, figure_run

from contwalk.branch import SpecialPoint
from contwalk.workflow.run_file.reading import read_run_file

pytestmark = [pytest.mark.thesis, pytest.mark.slow, pytest.mark.long]

ENDS = ("overlap", "no_overlap")
# The largest moduli as section 2.3 prints them, to the digits printed.
PRINTED = {"overlap": 0.937, "no_overlap": 0.942}
# Where the gait loses its stability, in parts of the line from the end, as docs/studies/thesis.md tells.
TORUS = {"overlap": 0.20659300, "no_overlap": 1.0 - 0.99658167}
AS_TOLD = 5e-9
# A part of the line that reaches a little beyond.
AS_FAR = {"overlap": 0.21, "no_overlap": 0.004}
# Of the numbers at two accuracies, 1e-8 and 1e-10.
NEAR = 1e-8
# The independent implementation's leading multiplier of the walker that can be built.
KNOWN = 0.942481026024


def from_end(name: str, accuracy: str) -> list[SpecialPoint]:
    """The special points of the gait near one end of the line."""
    overrides = [
        f"continue.range=[0, {AS_FAR[name]}]",
        "diagram=none",
        f"accuracy={accuracy}",
    ]
    if name == "no_overlap":
        start = read_run_file(RUNS / "walker3d_no_overlap_inclination.yaml").starts[0]
        assert start.state is not None
        names = read_run_file(RUNS / "walker3d_no_overlap_inclination.yaml").system.state_names
        state = ", ".join(f"{key}: {value!r}" for key, value in zip(names, start.state.tolist(), strict=True))
        overrides += [
            "path={from: no_overlap, to: overlap}",
            "preset=no_overlap",
            f"start={{simulate: {{state: {{{state}}}, mode: {start.mode}, until: 0}}}}",
            "report_at={section: {q7: 0.3}, direction: falling}",
        ]
    (branch,) = figure_run("walker3d_homotopy", *overrides)
    assert branch.info.closure == "mirror"
    assert branch.info.settings["pins"] == ["across", "along", "pitch"]
    return branch.special_points


def leading(points: list[SpecialPoint]) -> float:
    """The largest modulus of a whole stride's multipliers at the end of the line."""
    (end,) = [point for point in points if point.label == "EP" and point.parameters["path"] == 0.0]
    assert end.spectrum_full is not None
    return float(abs(end.spectrum_full[0]))


def torus(points: list[SpecialPoint]) -> SpecialPoint:
    (found,) = [point for point in points if point.label == "NS"]
    assert found.status == "located"
    assert found.error < NEAR
    return found


@pytest.mark.parametrize("name", ENDS)
def test_the_ends_are_as_stable_as_printed(name):
    assert leading(from_end(name, "1e-8")) == pytest.approx(PRINTED[name], abs=5e-4)


def test_the_end_that_can_be_built_is_the_independent_implementations():
    assert leading(from_end("no_overlap", "1e-10")) == pytest.approx(KNOWN, abs=NEAR)


@pytest.mark.parametrize("name", ENDS)
def test_both_accuracies_tell_the_same(name):
    coarse, fine = from_end(name, "1e-8"), from_end(name, "1e-10")
    assert leading(coarse) == pytest.approx(leading(fine), abs=NEAR)
    assert torus(coarse).parameters["path"] == pytest.approx(torus(fine).parameters["path"], abs=NEAR)
    assert torus(fine).parameters["path"] == pytest.approx(TORUS[name], abs=AS_TOLD + NEAR)
