"""The planar walker over slope and foot radius: doublings and a dip of the hind foot meet in one point."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import contwalk as cw

pytestmark = pytest.mark.thesis

SLOPE = """
system: planar_walker
parameters: {alpha: 0.09}
accuracy: 1e-9
start:
  simulate:
    state: {q1: -0.5196, q2: 0.1528388, u1: -1.933, u2: -2.037}
    at: heel_strike
    until: settled
continue: {parameter: alpha, range: [0.085, 0.105]}
diagram: none
events: {GR: ignore, OC: stop, AZ: ignore}
output: slope.h5
"""
CURVES = """
system: planar_walker
accuracy: 1e-9
start: [{from: slope.h5, point: b1/PD1}, {from: slope.h5, point: b1/GR1}]
continue: {parameters: [alpha, rf], range: {alpha: [0.05, 0.15], rf: [0.105, 0.13]}}
engine: {max_share: 0.1, max_step: 0.3}
events: {GR: ignore, OC: stop, AZ: ignore}
output: curves.h5
"""
# Recomputed with 40 digits at rf = 0.12; scuffing is ignored.
PD, DIP = 0.0982189400857467, 0.096080028655


def run(folder: Path, name: str, text: str, *overrides: str, output: str = "") -> list[cw.Branch]:
    (folder / f"{name}.yaml").write_text(text)
    path = cw.run(
        cw.read_run_file(folder / f"{name}.yaml", overrides, str(folder / (output or f"{name}.h5")))
    ).path
    with cw.open_database(path) as db:
        return db.branches()


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("planar")
    (branch,) = run(folder, "slope", SLOPE)
    assert branch.special("PD1").parameters["alpha"] == pytest.approx(PD, rel=1e-9)
    assert branch.special("GR1").parameters["alpha"] == pytest.approx(DIP, rel=1e-9)
    return folder


@pytest.fixture(scope="module")
def curves(folder) -> list[cw.Branch]:
    return run(folder, "curves", CURVES)


def test_the_point_is_found_from_both_of_its_curves(curves) -> None:
    doublings, dips = curves
    one, other = (curve.special("GRPD1") for curve in (doublings, dips))
    assert (one.kind, other.kind) == ("interior", "interior")
    for name in ("alpha", "rf"):
        error = one.errors[name] + other.errors[name]
        assert abs(one.parameters[name] - other.parameters[name]) <= error < 1e-8


def test_one_parameter_cuts_beside_it_confirm_it(folder, curves) -> None:
    """On one side of the point the gait doubles before the foot touches, on the other it touches first."""
    point = curves[0].special("GRPD1")
    order = []
    for k, rf in enumerate((point.parameters["rf"] - 1e-3, point.parameters["rf"] + 1e-3)):
        (branch,) = run(folder, "slope", SLOPE, f"parameters.rf={rf!r}", output=f"cut{k}.h5")
        found = {label: branch.special(f"{label}1").parameters["alpha"] for label in ("PD", "GR")}
        for label, curve in zip(("PD", "GR"), curves, strict=True):
            near = np.argsort(np.abs(curve["rf"] - rf))[:4]
            on_curve = np.polyval(np.polyfit(curve["rf"][near] - rf, curve["alpha"][near], 3), 0.0)
            assert on_curve == pytest.approx(found[label], rel=1e-5)
        order.append(found["PD"] < found["GR"])
    assert order in ([True, False], [False, True])
