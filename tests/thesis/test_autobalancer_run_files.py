"""Every run file of the autobalancer is named in the table, and draws the figures it asks for."""

import pytest
from autobalancer_figures import RUNS, figure_run

from contwalk.workflow.figures import draw_figure
from contwalk.workflow.run_file.reading import read_run_file

pytestmark = [pytest.mark.thesis, pytest.mark.slow]

# Of the maps, a few rows: those that other tests of this folder compute as well.
ROWS = {
    "autobalancer_damping_map": "sweep.delta={from: 0.001, to: 0.005, count: 3}",
    "autobalancer_border": "sweep.delta={from: 0.002, to: 0.014, count: 3}",
    "autobalancer_load_drag_map": "sweep.delta={from: 0.0002, to: 0.0011, count: 3}",
    "three_masses_damped_map": "sweep.m={from: 0.0025, to: 0.0205, count: 3}",
    "three_masses_stability_map": "sweep.m={from: 0.0025, to: 0.0205, count: 3}",
}
NAMES = sorted(
    path.stem
    for path in RUNS.glob("*.yaml")
    if path.stem.startswith(("autobalancer", "three_masses"))
    and "monte_carlo" not in path.stem
    and path.stem != "autobalancer_chaos"  # a motion
)

# Studies that other tests of this folder compute and look at closely, most of them in `make test`; figures of
# their kinds are drawn of others here.
ELSEWHERE = {
    "autobalancer_heavy_masses",
    "autobalancer_load",
    "autobalancer_load_unstable",
    "autobalancer_omega",
    "autobalancer_omega_light_damping",
    "three_masses_damped_map",
    "three_masses_load",
    "three_masses_stability_chart",
    "three_masses_stability_map",
}
# Of the kinds of others: charts of `autobalancer_border_chart` and of `three_masses_stability_chart`, maps of
# `autobalancer_border`, and branches of `autobalancer_anisotropic`.
ALIKE = {
    "autobalancer_anisotropic_fig19",
    "autobalancer_anisotropic_fig20",
    "autobalancer_anisotropic_fig21",
    "autobalancer_damping_chart",
    "autobalancer_damping_map",
    "autobalancer_load_drag_chart",
    "three_masses_damped_chart",
}


def test_there_are_run_files():
    assert len(NAMES) >= 12
    assert set(ROWS) <= set(NAMES)
    assert set(NAMES) > ELSEWHERE | ALIKE


@pytest.mark.parametrize("name", NAMES)
def test_table_and_output_have_the_name_of_the_run_file(name):
    assert f"| `{name}` |" in (RUNS / "README.md").read_text()
    run_file = read_run_file(RUNS / f"{name}.yaml")
    assert run_file.output.name == f"{name}.h5"
    assert run_file.text.startswith("# Thesis, Paper ")
    assert run_file.figures


@pytest.mark.parametrize(
    "name",
    [pytest.param(name, marks=[pytest.mark.long] if name in ELSEWHERE | ALIKE else []) for name in NAMES],
)
def test_run_completes_and_draws_its_figures(name, tmp_path):
    overrides = (ROWS[name],) if name in ROWS else ()
    branches = figure_run(name, *overrides)
    assert {branch.outcome.status for branch in branches} == {"complete"}
    run_file = read_run_file(RUNS / f"{name}.yaml", overrides)
    for number, figure in enumerate(run_file.figures):
        path = tmp_path / f"{name}_{number}.png"
        draw_figure(figure.name, branches, run_file.system, path, figure.options)
        assert path.stat().st_size > 10_000  # not an empty page
