"""`contwalk examples`: what is listed and what is copied."""

from __future__ import annotations

from importlib.resources import files

import pytest

from contwalk.workflow.examples import Example, examples, with_what_it_needs
from contwalk.workflow.run_file.reading import read_run_file

INSTALLED = sorted(
    path.name for path in files("contwalk_systems.runs").iterdir() if path.name.endswith(".yaml")
)


def test_all_that_is_installed_is_listed_with_a_line(contwalk):
    listed = contwalk("examples").out
    assert len(INSTALLED) >= 60
    for name in INSTALLED:
        (row,) = [row for row in listed.splitlines() if row.startswith(f"{name.removesuffix('.yaml')} ")]
        assert len(row.split()) >= 6  # the name, and a sentence


def test_a_copy_runs_as_it_is(contwalk, folder):
    done = contwalk("examples", "autobalancer_load")
    assert (done.code, "contwalk continue autobalancer_load.yaml" in done.out) == (0, True)
    assert read_run_file("autobalancer_load.yaml").free == "m"
    assert contwalk("continue", "autobalancer_load.yaml", "--quiet").code == 0
    assert (folder / "autobalancer_load_bifurcation_diagram.png").exists()


def test_what_it_begins_at_is_copied_first(contwalk, folder):
    told = contwalk("examples", "autobalancer_chaos.yaml").out.splitlines()
    assert [line.strip() for line in told[1:]] == [
        "contwalk continue autobalancer_cascade.yaml",
        "contwalk simulate autobalancer_chaos.yaml",
    ]
    assert (folder / "autobalancer_cascade.yaml").exists()
    assert [example.name for example in with_what_it_needs("walker3d_knee_region")] == [
        "walker3d_no_overlap_stiffer_ground",
        "walker3d_stiffer_ground_knee_damping",
        "walker3d_stiffer_ground_knee_stiffness",
        "walker3d_stiffer_ground_soft_knee_damping",
        "walker3d_knee_region",
    ]


def test_whatever_is_begun_at_is_an_example_too():
    known = examples().values()
    outputs = {example.output for example in known}
    for example in known:
        assert set(example.begins_at) <= outputs
        assert example.commands


def test_nothing_is_replaced_unless_one_says_so(contwalk, folder):
    (folder / "autobalancer_chaos.yaml").write_text("mine")
    done = contwalk("examples", "autobalancer_chaos")
    assert (done.code, "autobalancer_chaos.yaml exists" in done.err) == (2, True)
    assert not (folder / "autobalancer_cascade.yaml").exists()
    assert contwalk("examples", "autobalancer_chaos", "--force").code == 0
    assert (folder / "autobalancer_chaos.yaml").read_text() != "mine"


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["autobalancer_laod"], "Did you mean 'autobalancer_load'? See all: contwalk examples"),
        (["../secrets"], "There is no example '../secrets'."),
        ([""], "There is no example ''."),
        (["--force"], "--force belongs to a NAME."),
    ],
)
def test_what_is_not_there_is_told(contwalk, arguments, said):
    done = contwalk("examples", *arguments)
    assert (done.code, said in done.err) == (2, True)


def test_the_line_is_the_first_sentence():
    text = "# Paper 1, Fig. 8: what 3.5 kg do\n# to it. More is said here.\ncontwalk: 1\n# not this\n"
    assert Example("load", text).about == "Paper 1, Fig. 8: what 3.5 kg do to it."
    assert Example("bare", "contwalk: 1\n").about == ""
