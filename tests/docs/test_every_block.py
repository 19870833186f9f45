"""Every block of the pages that a reader may copy is run by a test, or is in a list with the reason."""

from __future__ import annotations

import re

import pytest
from code_blocks import ROOT

# The test that runs all blocks of a page, those of each language in their order.
RUN = {
    "docs/coming_from/auto.md": "docs/test_coming_from.py",
    "docs/coming_from/bifpy.md": "docs/test_coming_from.py",
    "docs/coming_from/bifurcationkit.md": "docs/test_coming_from.py",
    "docs/coming_from/coco.md": "docs/test_coming_from.py",
    "docs/coming_from/matcont.md": "docs/test_coming_from.py",
    "docs/coming_from/pydstool.md": "docs/test_coming_from.py",
    "docs/coming_from/xppaut.md": "docs/test_coming_from.py",
    "docs/gallery.md": "docs/test_gallery.py",
    "docs/howto/clocks.md": "docs/test_howto_events.py",
    "docs/howto/conserved_energy.md": "docs/test_conserved_energy.py",
    "docs/howto/cookbook.md": "docs/test_cookbook.py",
    "docs/howto/discretizations.md": "docs/test_discretizations.py",
    "docs/howto/friction.md": "docs/test_howto_events.py",
    "docs/howto/many_runs.md": "docs/test_many_runs.py",
    "docs/howto/margins.md": "docs/test_margins_page.py",
    "docs/howto/mass_matrices.md": "docs/test_mass_matrices.py",
    "docs/howto/point_types.md": "docs/test_point_types.py",
    "docs/howto/two_parameters.md": "docs/test_two_parameters.py",
    "docs/howto/relays.md": "docs/test_howto_events.py",
    "docs/howto/scuffing.md": "docs/test_scuffing.py",
    "docs/howto/storage_backends.md": "page_backend.py",
    "docs/overview.md": "docs/test_readme.py",
    "docs/reference/equations.md": "docs/test_equations_page.py",
    "docs/reference/plugin.md": "docs/test_tutorials.py",
    "docs/start.md": "docs/test_coming_from.py",
    "docs/tutorials/first_chart.md": "docs/test_first_chart.py",
    "docs/tutorials/first_orbit.md": "docs/test_tutorials.py",
    "docs/tutorials/first_plugin.md": "docs/test_tutorials.py",
    "docs/tutorials/impact_oscillator.md": "docs/test_tutorials.py",
}
# Blocks that no test runs, by page and first line. The list may only shrink.
STUDY = "a study of minutes, whose run file tests/thesis/test_autobalancer_cascade.py follows"
PART = "a part of a program: it takes branches, a system or files that the reader has"
FORMS = "forms of commands, with names to fill in"
NOISE = "any run file: tests/numerics/test_noise.py and the comparison under two seeds run some"
NOT_RUN = {
    ("docs/howto/accuracy.md", "contwalk continue runs/autobalancer_cascade.yaml"): STUDY,
    ("docs/howto/accuracy.md", "contwalk tradeoff runs/autobalancer_cascade.yaml"): STUDY,
    ("docs/howto/accuracy.md", "from contwalk.diagram.reopening import reopened"): PART,
    ("docs/howto/accuracy.md", "$ contwalk continue my_run.yaml"): NOISE,
    ("docs/reference/cli.md", "contwalk examples [NAME] [--force]"): FORMS,
    ("docs/reference/cli.md", "contwalk systems list"): FORMS,
    (
        "docs/reference/figures.md",
        "from contwalk.plotting import plot_bifurcation_diagram, save, units_of",
    ): PART,
    ("docs/reference/figures.md", "from matplotlib.figure import Figure"): PART,
    ("docs/reference/interface.md", "import contwalk as cw"): PART,
    ("docs/reference/interface.md", 'db = cw.open_database("autobalancer_cascade.h5")'): PART,
    ("docs/reference/run_file.md", "contwalk: 1"): "read by tests/workflow/test_run_file_docs.py, not run",
}
PAGES = sorted(str(path.relative_to(ROOT)) for path in [ROOT / "README.md", *ROOT.glob("docs/**/*.md")])


def copied(text: str) -> list[str]:
    """First lines, without comments, of the blocks of a page that a reader may copy.

    They are in Python, in YAML or for a console; without a language, those that begin with contwalk.
    """
    found = re.findall(r"^ *```(\w*)[^\n]*\n(.*?)^ *```", text, flags=re.DOTALL | re.MULTILINE)
    known = ("python", "yaml", "yml", "console", "bash", "sh", "shell", "pycon")
    return [
        body.split("\n")[0].split("  #")[0].strip()
        for language, body in found
        if language in known or (not language and body.startswith(("contwalk ", "$ ")))
    ]


def not_accounted_for(page: str, text: str) -> list[str]:
    """First lines of blocks that no test runs, and that are not in the list of these."""
    return [] if page in RUN else [line for line in copied(text) if (page, line) not in NOT_RUN]


@pytest.mark.parametrize("page", PAGES)
def test_every_block_is_run_or_is_known_not_to_be(page):
    assert not_accounted_for(page, (ROOT / page).read_text(encoding="utf-8")) == []


@pytest.mark.parametrize(("page", "test"), RUN.items())
def test_the_test_that_runs_a_page_names_it_and_reads_its_blocks(page, test):
    text = (ROOT / "tests" / test).read_text(encoding="utf-8")
    assert page.rsplit("/", 1)[-1] in text
    assert "blocks(" in text or "findall" in text


@pytest.mark.parametrize("page", RUN)
def test_a_page_that_is_run_has_no_language_that_its_test_does_not_read(page):
    text = (ROOT / page).read_text(encoding="utf-8")
    test = (ROOT / "tests" / RUN[page]).read_text(encoding="utf-8")
    for language in set(re.findall(r"^ *```(python|yaml|console)", text, flags=re.MULTILINE)):
        asked = ("commands(",) if language == "console" else (f'"{language}"', f"```{language}")
        assert any(word in test for word in asked), language


def test_the_list_of_what_is_not_run_has_no_block_that_is_gone_or_run():
    there = {(page, line) for page in PAGES for line in copied((ROOT / page).read_text(encoding="utf-8"))}
    assert [entry for entry in NOT_RUN if entry not in there or entry[0] in RUN] == []


def test_a_block_that_nobody_runs_is_found():
    """The check itself."""
    page = "text\n\n```python\nx = 1  # one\n```\n\n```\ncontwalk show a.h5\n```\n\n```\noutput\n```\n"
    assert not_accounted_for("docs/new.md", page) == ["x = 1", "contwalk show a.h5"]
