"""README and overview: code runs as written, what is promised is there, numbers are those of docs/."""

from __future__ import annotations

import json
import re

import pytest
from code_blocks import ROOT, blocks, commands, run_command, run_python

README, OVERVIEW = "README.md", "docs/overview.md"
# A screen has some fifty lines; a picture takes a third of one.
TWO_SCREENS = 100


def test_plugin_example_finds_the_hopf_point_it_names(tmp_path):
    plugin, *_ = blocks(OVERVIEW, "python")
    (run_file,) = blocks(OVERVIEW, "yaml")
    (tmp_path / "my_model.py").write_text(plugin, encoding="utf-8")
    (tmp_path / "my_run.yaml").write_text(run_file, encoding="utf-8")
    outputs = [run_command(line, tmp_path) for line in commands(OVERVIEW)]
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
    text = (ROOT / OVERVIEW).read_text(encoding="utf-8")
    table = text[text.index("## Commands") : text.index("## From Python")]
    rows = [row for row in re.findall(r"`(contwalk [^`]*)`", table) if "_source" not in row]
    assert len(rows) >= 14
    assert set(LONG) <= set(rows)
    for name in ("runs", "tests"):
        (tmp_path / name).symlink_to(ROOT / name)
    for name, language in (("my_model.py", "python"), ("my_run.yaml", "yaml")):
        (tmp_path / name).write_text(blocks(OVERVIEW, language)[0], encoding="utf-8")
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
    _, short, example = blocks(OVERVIEW, "python")
    run_python(short, tmp_path)
    assert (tmp_path / "brusselator.png").stat().st_size > 0
    assert len([line for line in example.splitlines() if line.strip()]) <= 10
    output = run_python(example, tmp_path)
    assert re.search(r"BP1 pitchfork 0\.02 supercritical", output)
    assert (tmp_path / "autobalancer.png").stat().st_size > 0


@pytest.mark.parametrize(
    ("page", "picture"),
    [(OVERVIEW, "autobalancer_load"), (OVERVIEW, "autobalancer_cascade"), (README, "planar_slope")],
)
def test_pictures_are_shown_and_small_enough_to_keep_in_the_repository(page, picture):
    path = f"images/{picture}.png"
    assert path in (ROOT / page).read_text(encoding="utf-8")
    assert (ROOT / "docs" / path).stat().st_size < 250_000


def test_run_files_that_the_overview_names_exist():
    named = re.findall(r"runs/\w+\.yaml", (ROOT / OVERVIEW).read_text(encoding="utf-8"))
    assert len(named) >= 3
    assert [name for name in named if not (ROOT / name).exists()] == []


def test_the_readme_is_two_screens_and_has_a_picture():
    lines = (ROOT / README).read_text(encoding="utf-8").splitlines()
    assert len(lines) + sum(len(line) // 200 for line in lines) <= TWO_SCREENS
    assert sum(line.startswith("![") for line in lines) == 1


def test_numbers_of_the_readme_are_those_of_the_pages_it_names():
    text = (ROOT / README).read_text(encoding="utf-8")
    peers = (ROOT / "docs/peers.md").read_text(encoding="utf-8")
    rows = re.findall(
        r"^\| [^|]+ \| (\d+) \| (\d+) \| (\d+) \| (\d+) \| ([\d.e+-]+) \| yes \|", peers, re.MULTILINE
    )
    listed, found, missed, extra = (sum(int(row[k]) for row in rows) for k in range(4))
    assert f"[{len(rows)} published problems]" in text
    assert f"{found} of {listed} known special points, none besides" in text
    assert missed == extra == 0
    assert f"within {max(float(row[4]) for row in rows)!r} of" in text
    benchmarks = (ROOT / "docs/benchmarks.md").read_text(encoding="utf-8")
    assert "4.6 times at its most careful setting, 9 times" in benchmarks
    assert "[4.6 to 9 times]" in text
    assert "26 to 111 times as fast" in benchmarks
    assert "26 to 111 times as fast as SciPy" in text
    assert "| 0.3, on all branches | 5, 295 | 7.3 |" in benchmarks
    assert "295 points of 5 branches: [7.3 s]" in text
    assert "A point costs five to seven times a point of that loop" in benchmarks


@pytest.mark.parametrize("target", ["demo", "test"])
def test_commands_of_the_readme_are_targets(target):
    assert re.search(rf"^    make {target}$", (ROOT / README).read_text(encoding="utf-8"), re.MULTILINE)
    assert re.search(rf"^{target}:", (ROOT / "Makefile").read_text(encoding="utf-8"), re.MULTILINE)
