"""The 3D walkers in the inclination: all special points of the straight gaits, and where the gaits end."""

from __future__ import annotations

import json
from itertools import chain
from pathlib import Path

import numpy as np
import pytest
from autobalancer_figures import RUNS, figure_run

from contwalk.branch import Branch, SpecialPoint
from contwalk.workflow.run_file.reading import read_run_file

# The longest studies of all tests: what CI asks of the 3D walkers is in `test_walker3d_gaits`.
pytestmark = [pytest.mark.thesis, pytest.mark.slow, pytest.mark.long]

REFERENCE = json.loads((Path(__file__).parent / "walker3d_reference.json").read_text(encoding="utf-8"))
# What the independent implementation is known to; of the ends it has orbits beside them.
KNOWN, BESIDE = 1e-8, 1e-6
STUDIES = ("overlap", "no_overlap")
# The torso of the walker that can be built is balanced: its pitch is neutral.
PINS = {"overlap": ["across", "along"], "no_overlap": ["across", "along", "pitch"]}


def study(name: str) -> tuple[Branch, ...]:
    """The straight gait of a walker, both ways from the printed one."""
    return figure_run(f"walker3d_{name}_inclination", "diagram.follow=none")


def points(name: str) -> list[SpecialPoint]:
    return list(chain.from_iterable(branch.special_points for branch in study(name)))


def expected() -> list:
    return [
        pytest.param(name, entry, id=f"{name} {entry['label']} {entry['alpha']:.6f}")
        for name in STUDIES
        for entry in REFERENCE[name]
    ]


@pytest.mark.parametrize(("name", "entry"), expected())
def test_special_point(name, entry):
    found = [
        point
        for point in points(name)
        if point.label == entry["label"] and abs(point.parameters["alpha"] / entry["alpha"] - 1.0) < KNOWN
    ]
    assert found, [(point.label, point.parameters["alpha"]) for point in points(name)]
    for point in found:
        assert point.status == "located"
        assert point.error < KNOWN * entry["alpha"]
        assert point.period == pytest.approx(entry["half_period"], rel=1e-6)


def test_there_are_enough_of_them():
    assert [len(REFERENCE[name]) for name in STUDIES] == [9, 4]


@pytest.mark.parametrize("entry", REFERENCE["overlap_ends"], ids=lambda entry: f"{entry['alpha']:.6f}")
def test_end(entry):
    """A toe comes down, or lifts off, without speed: beyond it there is no such gait."""
    found = [
        point
        for point in points("overlap")
        if (point.label, point.kind) == ("GR", "terminal")
        and abs(point.parameters["alpha"] / entry["alpha"] - 1.0) < BESIDE
    ]
    assert len(found) == 1
    assert found[0].period == pytest.approx(entry["half_period"], rel=1e-4)
    assert any(
        point.kind == "grazing" and point.parameters == found[0].parameters
        for branch in study("overlap")
        for point in branch.special_points
        if point.label == "EP"
    )


def test_both_folds_and_no_other():
    """The gait of the walker with overlapping feet is one curve between its two ends."""
    assert sorted(round(p.parameters["alpha"], 6) for p in points("overlap") if p.label == "LP") == [
        0.064192,
        0.112333,
    ]


def test_the_walker_that_can_be_built_has_no_fold():
    assert not [p for p in points("no_overlap") if p.label == "LP"]


def test_the_pitchfork_of_the_walker_that_can_be_built_is_subcritical():
    (found,) = [p for p in points("no_overlap") if p.label == "BP" and p.parameters["alpha"] < 0.086]
    assert (found.kind, found.criticality) == ("symmetry-breaking", "subcritical")
    assert (found.unstable_before, found.unstable_after) == (2, 3)


@pytest.mark.parametrize("name", STUDIES)
def test_all_of_it_is_half_a_stride(name):
    for branch in study(name):
        assert branch.info.closure == "mirror"
        assert branch.info.settings["pins"] == PINS[name]
        assert not any(event.endswith("loads") for event in branch.info.signature)
        regular = branch.points[~branch.points["special"]]
        assert np.all(np.isfinite(regular["spectrum"][:, 0]))


# They need the databases of other run files, which they name.
BEGIN_ELSEWHERE = (
    "walker3d_ground_region",
    "walker3d_knee_region",
    "walker3d_stiffer_ground_knee_damping",
    "walker3d_stiffer_ground_knee_stiffness",
    "walker3d_stiffer_ground_soft_knee_damping",
)


# They have nothing to continue.
MOTIONS = ("walker3d_standing",)


def test_run_files_are_in_the_table():
    for path in sorted(RUNS.glob("walker3d_*.yaml")):
        assert f"| `{path.stem}` |" in (RUNS / "README.md").read_text(encoding="utf-8")
        if path.stem not in (*BEGIN_ELSEWHERE, *MOTIONS):
            assert read_run_file(path).output.name == f"{path.stem}.h5"
