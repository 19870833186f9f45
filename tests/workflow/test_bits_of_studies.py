"""A study is the same to the last bit whatever was computed before it, and on any number of threads."""

from __future__ import annotations

import os
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import pytest
from killed_runs import assert_same, compute

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parents[2]


@dataclass(frozen=True)
class Study:
    """A run file, made short, and the same at other settings, which leaves its own traces in a process."""

    file: str
    short: tuple[str, ...]
    other: tuple[str, ...]

    def into(self, output: Path, other: bool = False) -> None:
        compute(ROOT / "runs" / self.file, (*self.short, *(self.other if other else ())), output)


STUDIES = {
    "smooth": Study("autobalancer_cascade.yaml", ("continue.max_points=12",), ("accuracy=1e-8",)),
    "hybrid": Study("planar_slope.yaml", ("continue.max_points=6",), ("continue.max_points=9",)),
    "soft": Study(
        "walker3d_figure9.yaml",
        ("continue.max_points=4", "diagram.depth=0"),
        ("continue.direction=backward", "engine.max_share=0.02"),
    ),
}


@pytest.mark.parametrize(
    "name", ["smooth", *(pytest.param(name, marks=pytest.mark.long) for name in ("hybrid", "soft"))]
)
def test_two_histories_and_two_numbers_of_threads_give_the_same_database(name, tmp_path):
    study = STUDIES[name]
    study.into(tmp_path / "first.h5")
    study.into(tmp_path / "other.h5", other=True)
    study.into(tmp_path / "second.h5")
    assert_same(tmp_path / "first.h5", tmp_path / "second.h5")
    for threads in (1, 2):
        alone = tmp_path / f"{threads}.h5"
        in_a_process(name, alone, threads)
        assert_same(tmp_path / "first.h5", alone)


def in_a_process(name: str, output: Path, threads: int) -> None:
    """A study in a Python that has computed nothing before, whose linear algebra may take so many threads."""
    code = (
        "import pathlib, test_bits_of_studies as own\n"
        f"own.STUDIES[{name!r}].into(pathlib.Path({str(output)!r}))"
    )
    counts = {f"{library}_NUM_THREADS": str(threads) for library in ("OPENBLAS", "MKL", "OMP")}
    paths = os.pathsep.join([str(ROOT / "tests" / "workflow"), str(ROOT / "tests")])
    subprocess.run(
        [sys.executable, "-c", code], env={**os.environ, **counts, "PYTHONPATH": paths}, check=True
    )
