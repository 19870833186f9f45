"""Commands that stand indented in a page, without a fence: run here, or by what is named beside them."""

from __future__ import annotations

import re
import subprocess
import sys

import pytest
from code_blocks import ROOT, environment, run_command

LINE = re.compile(r"^    (?:[A-Z_]+=\S+ )?((?:contwalk|python3?|pip|make|export|\.) [^#\n]*)", re.MULTILINE)
PAGES = sorted(str(path.relative_to(ROOT)) for path in [*ROOT.glob("*.md"), *ROOT.glob("docs/**/*.md")])
# Pages whose lines that call contwalk are run here.
HERE = ("README.md", "docs/howto/machines.md")
# What runs the others: by their beginnings, and a file of the repository with the words that it runs.
ELSEWHERE = {
    "make demo": ("Makefile", "demo:"),
    "make test": (".ci/run", "make test"),
    "make check": (".ci/run", "make slow"),
    "make dist": ("Makefile", "wheel: dist"),
    "make wheel": (".ci/run", "make wheel"),
    "make bench": ("Makefile", "bench:"),
    "pip install contwalk-": ("tools/wheel.py", '"install"'),
    "pip install pytest-cov": ("docs/mutants.md", "measure"),
    "contwalk examples autobalancer_load": ("tools/wheel.py", "contwalk examples autobalancer_load"),
    "contwalk continue autobalancer_load.yaml": (
        "tools/wheel.py",
        "contwalk continue autobalancer_load.yaml",
    ),
    "python3 -m venv": ("tools/wheel.py", '"venv"'),
    ". .venv/bin/activate": ("tools/wheel.py", "PATH"),
    "export PYTHONPATH=tests": ("tests/docs/test_commands_in_text.py", "PYTHONPATH"),
    "python benchmarks/": ("tests/test_benchmarks.py", "benchmarks"),
    "python -m tools.mutants": ("tools/mutants/__main__.py", "measure"),
    "python tests/pairs/run_pairs.py": ("tests/pairs/test_pairs.py", "run_pairs"),
    "python tests/peers/table.py": ("tests/peers/test_page.py", "table"),
    "python tests/random_systems/run_random_systems.py": (
        "tests/random_systems/test_random_systems.py",
        "random_systems",
    ),
    # A form, with values of nobody's run file.
    "contwalk continue run.yaml --set": ("tests/cli/test_continue.py", "--set"),
    "contwalk continue runs/": ("tests/thesis/test_every_run_file.py", "glob"),
}


def lines(page):
    return [found.strip() for found in LINE.findall((ROOT / page).read_text(encoding="utf-8"))]


@pytest.mark.parametrize("page", PAGES)
def test_every_line_is_run_here_or_elsewhere(page):
    left = [line for line in lines(page) if not (page in HERE and line.startswith("contwalk "))]
    assert [line for line in left if not line.startswith(tuple(ELSEWHERE))] == []


def test_what_is_named_is_there_and_no_more():
    every = [line for page in PAGES for line in lines(page)]
    for beginning, (file, words) in ELSEWHERE.items():
        assert words in (ROOT / file).read_text(encoding="utf-8"), beginning
        assert any(line.startswith(beginning) for line in every), beginning


@pytest.fixture
def opened(monkeypatch):
    found = []
    monkeypatch.setattr("webbrowser.open", found.append)
    return found


def run_lines(page, folder):
    for line in lines(page):
        for command in line.split(" && "):
            if command.startswith("contwalk "):
                run_command(command, folder)


def test_two_commands_of_the_readme(tmp_path, opened):
    run_lines("README.md", tmp_path)
    assert opened == [(tmp_path / "autobalancer_load.html").resolve().as_uri()]


def test_two_diagrams_of_machines_with_events(tmp_path):
    (tmp_path / "docs/images").mkdir(parents=True)
    (made,) = [line for line in lines("docs/howto/machines.md") if line.startswith("python ")]
    words = made.replace("tests/", f"{ROOT}/tests/").split()[1:]
    subprocess.run([sys.executable, *words], cwd=tmp_path, env=environment(), check=True, capture_output=True)
    run_lines("docs/howto/machines.md", tmp_path)
    assert len(list((tmp_path / "docs/images").glob("machines_*.png"))) == 2
