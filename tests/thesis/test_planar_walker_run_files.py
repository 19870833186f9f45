"""Every run file of the planar walker is in the table and draws its figures; the walks of Figs 4 and 6."""

from __future__ import annotations

import numpy as np
import pytest
from autobalancer_figures import RUNS, figure_run
from planar_walker_figures import FEET, GAIT, numbers

from contwalk.cli.entry import run as command
from contwalk.storage.trajectory import read_trajectory
from contwalk.workflow.figures import draw_figure
from contwalk.workflow.run_file.reading import read_run_file

pytestmark = pytest.mark.thesis

NAMES = sorted(path.stem for path in RUNS.glob("planar_*.yaml") if not path.stem.endswith("_basin"))
# The study of the slope with less of it: other tests compute the whole.
_LITTLE = ("continue.range=[0.085, 0.1]", "diagram=none")
NARROWED = {
    "planar_negative_feet": ("continue.range=[-0.01, 0.01]",),
    "planar_slope": _LITTLE,
    "planar_foot_radius_curves": (*_LITTLE, "loci.range=[0.115, 0.125]"),
    "planar_inertia_curves": (*_LITTLE, "loci.range=[0.0, 0.001]"),
}
# What `make long` draws: of the kinds of `planar_slope`, `planar_gait` and `planar_foot_radius_curves`.
ALIKE = {"planar_feet", "planar_gait_small_feet", "planar_inertia_curves"}
WALKS = {
    "planar_gait": (GAIT["x"], GAIT["T_step"], GAIT["multipliers"][0]),
    "planar_gait_small_feet": (FEET["points"][-1]["x"], FEET["points"][-1]["T"], None),
}


def test_there_are_run_files():
    assert {"planar_slope", "planar_feet", *WALKS} <= set(NAMES)


@pytest.mark.parametrize("name", NAMES)
def test_table_and_output_have_the_name_of_the_run_file(name):
    assert f"| `{name}` |" in (RUNS / "README.md").read_text(encoding="utf-8")
    run_file = read_run_file(RUNS / f"{name}.yaml")
    assert run_file.output.name == f"{name}.h5"
    assert run_file.text.startswith("# Thesis, Paper 3, ")
    assert run_file.figures


@pytest.mark.slow
@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=[pytest.mark.long] if name in ALIKE else []) for name in NAMES]
)
def test_run_ends_well_and_draws_its_figures(name, tmp_path):
    overrides = NARROWED.get(name, ())
    branches = figure_run(name, *overrides)
    assert {branch.outcome.status for branch in branches} <= {"complete", "stopped"}
    run_file = read_run_file(RUNS / f"{name}.yaml", overrides)
    for number, figure in enumerate(run_file.figures):
        path = tmp_path / f"{name}_{number}.png"
        draw_figure(figure.name, branches, run_file.system, path, figure.options)
        assert path.stat().st_size > 10_000  # not an empty page


@pytest.mark.parametrize("name", WALKS)
def test_seven_steps(name, tmp_path, monkeypatch, capsys):
    """From the printed state the walk goes to the gait: what is off shrinks from step to step."""
    monkeypatch.chdir(tmp_path)
    assert command(["simulate", str(RUNS / f"{name}.yaml"), "--quiet"]) == 0
    assert capsys.readouterr().err == ""
    stored = read_trajectory(tmp_path / f"{name}_trajectory.h5")
    strikes = [i for i, event in enumerate(stored.event_names) if event == "heel_strike"]
    assert len(strikes) == 8  # the first is the start
    assert len(stored.event_names) == 15
    x, period, leading = WALKS[name]
    expected = numbers(x)
    found = np.array([stored.event_before[i] for i in strikes])[:, [0, 4, 5]]
    off = np.abs(found - expected).max(axis=1)
    assert off[-1] < 1e-3 * off[0] or off[-1] < 2e-4
    assert np.diff(stored.event_times[strikes])[-1] == pytest.approx(float(period), rel=1e-5)
    if leading is not None:
        # A step multiplies what is left by the leading multiplier, once the others have died.
        errors = found[:, 0] - expected[0]
        assert errors[6] / errors[5] == pytest.approx(float(leading), rel=0.02)
    assert (tmp_path / f"{name}_time_series.png").is_file()
