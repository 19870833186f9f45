"""The how-to page on curves in two parameters: its commands from the page alone, and what they find."""

from __future__ import annotations

import json

import pytest
from code_blocks import blocks, commands, run_command, run_python

pytestmark = pytest.mark.slow

PAGE = "docs/howto/two_parameters.md"
# Found with mpmath from the characteristic polynomial; MatCont's tutorial prints the first digits.
BT = {"alpha": 0.45362432777812945522, "delta": 0.17512759295021742421}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """The page's files, and its commands run in their order."""
    folder = tmp_path_factory.mktemp("two_parameters")
    plugin, _, _ = blocks(PAGE, "python")
    one, two, every, stop = blocks(PAGE, "yaml")
    for name, text in (
        ("bazykin.py", plugin),
        ("one.yaml", one),
        ("two.yaml", two),
        ("all.yaml", every),
        ("stop.yaml", stop),
    ):
        (folder / name).write_text(text, encoding="utf-8")
    for line in commands(PAGE):
        run_command(line, folder)
    return folder


def curves(folder, database):
    """The curves of a database."""
    told = json.loads(run_command(f"contwalk show {database} --json", folder))
    return [branch for branch in told["branches"] if branch["problem"] == "locus"]


@pytest.mark.parametrize("run", ["two", "all"])
def test_both_curves_meet_in_a_point_that_is_known(folder, run):
    found = curves(folder, f"{run}.h5")
    through = {
        curve["of"]
        for curve in found
        for point in curve["special_points"]
        if point["label"] == "BT"
        and all(abs(point["parameters"][name] - BT[name]) <= point["errors"][name] for name in BT)
    }
    assert through == {"LP", "HB"}


def test_show_says_of_which_points_a_curve_is(folder):
    shown = run_command("contwalk show two.h5", folder)
    assert "b1  locus of HB, alpha from 0.0112275 to 0.955472, delta from 0.001 to " in shown


def test_the_figure_is_drawn(folder):
    for name in ("two.png", "chart.png"):
        assert (folder / name).read_bytes().startswith(b"\x89PNG")


def test_the_script_tells_the_points_of_the_curve(folder):
    _, script, _ = blocks(PAGE, "python")
    assert "BT1" in run_python(script, folder)


def test_curves_of_orbits_with_impacts(folder):
    found = {curve["of"]: curve for curve in curves(folder, "stop.h5")}
    assert set(found) == {"GR", "PD"}
    labels = {of: [point["label"] for point in curve["special_points"]] for of, curve in found.items()}
    assert labels == {"GR": ["EP", "EP"], "PD": ["EP", "GPD", "EP"]}
    assert (folder / "stop_locus.png").read_bytes().startswith(b"\x89PNG")


def test_the_grazing_curve_is_the_function_of_the_page(folder):
    _, _, script = blocks(PAGE, "python")
    assert float(run_python(script, folder)) < 1e-7


def test_the_page_of_a_point_tells_what_the_curve_holds(folder):
    doubling = next(curve for curve in curves(folder, "stop.h5") if curve["of"] == "PD")
    shown = run_command(f"contwalk show stop.h5 {doubling['name']}/GPD1", folder)
    (held,) = [line.split() for line in shown.splitlines() if line.split()[:1] == ["-1.0"]]
    assert held == ["-1.0", "0.0", "1.0"]  # real, imaginary, modulus
    assert "multipliers: real" in shown
