"""The README: its code runs as written, and what it promises is there."""

from __future__ import annotations

import json
import re

import pytest
from code_blocks import ROOT, blocks, commands, run_command, run_python

README = "README.md"


def test_plugin_example_finds_the_hopf_point_it_names(tmp_path):
    plugin, *_ = blocks(README, "python")
    (run_file,) = blocks(README, "yaml")
    (tmp_path / "my_model.py").write_text(plugin, encoding="utf-8")
    (tmp_path / "my_run.yaml").write_text(run_file, encoding="utf-8")
    outputs = [run_command(line, tmp_path) for line in commands(README)]
    assert len(outputs) == 3
    assert "0 errors" in outputs[0]
    assert "supercritical" in outputs[-1]
    shown = json.loads(run_command("contwalk show my_run.h5 --json", tmp_path))
    (point,) = [p for p in shown["branches"][0]["special_points"] if p["label"] == "HB"]
    assert [b["problem"] for b in shown["branches"]] == ["equilibrium", "periodic_orbit"]
    assert shown["branches"][1]["parent"] == "b1/HB1"
    # closed form: B = 1 + A^2; refined points are right to the last bit or two of a double
    assert abs(point["parameters"]["B"] - 2.0) <= 4.5e-16
    assert (tmp_path / "my_run_bifurcation_diagram.png").stat().st_size > 0


# Those that take long as they stand, and what they are tried with instead.
LONG = {
    "contwalk sample runs/autobalancer_monte_carlo_system1.yaml": " --set sample.count=8",
    "contwalk continue runs/planar_slope.yaml": None,
    "contwalk animate planar_slope.h5 b1/GR4 -o gait.gif": None,
    "contwalk tradeoff runs/autobalancer_cascade.yaml": None,
}


def test_rows_of_the_table_run_as_they_stand(tmp_path):
    """One after the other, in a folder that has what a clone has, and the files of the example."""
    text = (ROOT / README).read_text(encoding="utf-8")
    table = text[text.index("## What it does") : text.index("## From Python")]
    rows = [row for row in re.findall(r"`(contwalk [^`]*)`", table) if "_source" not in row]
    assert len(rows) >= 14
    assert set(LONG) <= set(rows)
    for name in ("runs", "tests"):
        (tmp_path / name).symlink_to(ROOT / name)
    for name, language in (("my_model.py", "python"), ("my_run.yaml", "yaml")):
        (tmp_path / name).write_text(blocks(README, language)[0], encoding="utf-8")
    run_command("contwalk continue my_run.yaml --quiet --no-figures", tmp_path)
    for row in rows:
        more = LONG.get(row, "")
        if more is None:
            assert row.split()[2] == "planar_slope.h5" or (ROOT / row.split()[2]).exists()
        elif row.startswith("contwalk diff"):
            with pytest.raises(AssertionError):  # they differ: exit code 1
                run_command(row, tmp_path)
        else:
            run_command(f"{row}{more}", tmp_path)
    for name in ("multipliers.png", "impact_oscillator_basin_margins.h5", "lorenz.py", "autobalancer.yaml"):
        assert (tmp_path / name).exists()


def test_python_example(tmp_path):
    _, short, example = blocks(README, "python")
    run_python(short, tmp_path)
    assert (tmp_path / "brusselator.png").stat().st_size > 0
    assert len([line for line in example.splitlines() if line.strip()]) <= 10
    output = run_python(example, tmp_path)
    assert re.search(r"BP1 pitchfork 0\.02 supercritical", output)
    assert (tmp_path / "autobalancer.png").stat().st_size > 0


@pytest.mark.parametrize("picture", ["autobalancer_load", "autobalancer_cascade"])
def test_pictures_are_shown_and_small_enough_to_keep_in_the_repository(picture):
    path = f"docs/images/{picture}.png"
    assert f"]({path})" in (ROOT / README).read_text(encoding="utf-8")
    assert (ROOT / path).stat().st_size < 150_000


def test_run_files_that_the_readme_names_exist():
    named = re.findall(r"runs/\w+\.yaml", (ROOT / README).read_text(encoding="utf-8"))
    assert len(named) >= 3
    assert [name for name in named if not (ROOT / name).exists()] == []


@pytest.mark.parametrize("target", ["demo", "test"])
def test_commands_of_the_readme_are_targets(target):
    assert re.search(rf"^    make {target}$", (ROOT / README).read_text(encoding="utf-8"), re.MULTILINE)
    assert re.search(rf"^{target}:", (ROOT / "Makefile").read_text(encoding="utf-8"), re.MULTILINE)
