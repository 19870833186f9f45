"""A direction that is neutral where a path begins, and not along it: orbits are not isolated there."""

from __future__ import annotations

from pathlib import Path

import pytest

from contwalk.system import load_system
from contwalk.workflow.run_file.reading import read_run_file
from contwalk.workflow.runner import run

RUNS = Path(__file__).parents[2] / "runs"


def run_with(tmp_path, path: str):
    """The printed gait of the walker with a balanced torso, along a path."""
    text = (RUNS / "walker3d_no_overlap_inclination.yaml").read_text(encoding="utf-8")
    kept = [line for line in text.splitlines() if not line.startswith(("figures", "  - "))]
    (tmp_path / "run.yaml").write_text("\n".join(kept), encoding="utf-8")
    overrides = (f"path={path}", "continue={max_points: 3}", "diagram.follow=none")
    return run(read_run_file(tmp_path / "run.yaml", overrides, str(tmp_path / "out.h5")), figures=False)


@pytest.mark.slow
def test_it_is_said(tmp_path):
    (branch,) = run_with(tmp_path, "{from: no_overlap, to: overlap}").branches
    assert branch.outcome.status == "failed"
    assert "'pitch' is neutral where the branch begins, and not along 'path'" in branch.outcome.message
    assert "other end" in branch.outcome.message


@pytest.mark.slow
@pytest.mark.long
def test_it_stays_pinned_where_it_stays_neutral(tmp_path):
    values = load_system("walker3d").presets["no_overlap"]
    (branch,) = run_with(tmp_path, f"{{from: no_overlap, to: {{k_y: {1.01 * values['k_y']}}}}}").branches
    assert branch.info.settings["pins"] == ["across", "along", "pitch"]
    assert len(branch.points) == 3
    assert branch.points["period"][0] == pytest.approx(0.643498591322, rel=1e-6)
