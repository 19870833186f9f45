"""`contwalk plot`: every kind of figure, in every format, and what cannot be drawn."""

from __future__ import annotations

import re

import pytest

MAGIC = {"png": b"\x89PNG", "svg": b"<?xml", "pdf": b"%PDF"}


@pytest.mark.parametrize("suffix", MAGIC)
def test_formats(contwalk, fork_with_branches, folder, suffix):
    done = contwalk("plot", fork_with_branches, "-o", f"figure.{suffix}")
    assert (done.code, done.out) == (0, f"Wrote figure.{suffix}.\n")
    assert (folder / f"figure.{suffix}").read_bytes().startswith(MAGIC[suffix])


def test_axes_with_units(contwalk, folder):
    assert contwalk("continue", "run.yaml", "--quiet").code == 0
    contwalk("plot", "fork.h5", "-x", "x", "-y", "r", "-o", "figure.svg")
    text = (folder / "figure.svg").read_text(encoding="utf-8")
    assert "x (m) -->" in text
    assert "r (N) -->" in text
    (folder / "fork.py").unlink()  # they are stored
    assert contwalk("plot", "fork.h5", "-x", "x", "-y", "r", "-o", "figure.svg", "--force").code == 0
    assert "x (m) -->" in (folder / "figure.svg").read_text(encoding="utf-8")


def test_a_file_that_exists_is_replaced_only_with_force(contwalk, fork_with_branches, folder):
    (folder / "mine.png").write_bytes(b"mine")
    done = contwalk("plot", fork_with_branches, "-o", "mine.png")
    assert (done.code, done.err) == (
        2,
        "error: mine.png exists. Replace it with --force, or choose another output.\n",
    )
    assert (folder / "mine.png").read_bytes() == b"mine"
    assert contwalk("plot", fork_with_branches, "-o", "mine.png", "--force").code == 0
    assert (folder / "mine.png").read_bytes().startswith(MAGIC["png"])


def test_chosen_branches(contwalk, fork_with_branches, folder):
    contwalk("plot", fork_with_branches, "-o", "all.svg")
    contwalk("plot", fork_with_branches, "-o", "one.svg", "--branch", "b2", "--branch", "b2")
    everything = (folder / "all.svg").read_text(encoding="utf-8")
    one = (folder / "one.svg").read_text(encoding="utf-8")
    assert 'id="b1-' in everything
    assert 'id="b2-' in everything
    assert 'id="b1-' not in one
    assert 'id="b2-' in one


def test_eigenvalues(contwalk, fork_with_branches, folder):
    assert contwalk("plot", fork_with_branches, "--kind", "eigenvalues", "-o", "e.svg").code == 0
    assert "imaginary-axis" in (folder / "e.svg").read_text(encoding="utf-8")


def test_machine(contwalk, folder):
    assert contwalk("continue", "run.yaml", "--quiet").code == 0
    for name in ("b1/BP1", "b1/3"):
        assert (
            contwalk(
                "plot", "--trust", "--force", "fork.h5", "--kind", "machine", "--point", name, "-o", "m.svg"
            ).code
            == 0
        )
        assert f"<!-- {name}: r = " in (folder / "m.svg").read_text(encoding="utf-8")
    assert contwalk("plot", "--trust", "--force", "fork.h5", "--kind", "machine", "-o", "start.png").code == 0
    (folder / "fork.py").unlink()
    done = contwalk("plot", "--trust", "--force", "fork.h5", "--kind", "machine", "-o", "m.png")
    assert done.code == 2
    assert "cannot be loaded" in done.err


def test_stability_map_finds_the_swept_parameter(contwalk, folder):
    sweep = ("--set", "sweep={a: [0.5, 0.75, 1.0]}", "--output", "swept.h5")
    assert contwalk("continue", "run.yaml", "--quiet", *sweep).code == 0
    assert contwalk("plot", "swept.h5", "--kind", "stability_map", "-o", "map.svg").code == 0
    text = (folder / "map.svg").read_text(encoding="utf-8")
    assert "r (N) -->" in text
    assert " a -->" in text


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("-o", "x.gif"), ".png, .svg, .pdf, .pgf"),
        (("-o", "nowhere/x.png"), "the directory nowhere does not exist"),
        (("-o", "x.png", "-y", "heigt"), "Did you mean 'height'?"),
        (("-o", "x.png", "--branch", "b9"), "has no branch 'b9'"),
        (("-o", "x.png", "--kind", "multipliers"), "No branch has multipliers"),
        (("-o", "x.png", "--full"), "--full belongs to --kind multipliers, not to bifurcation_diagram"),
        (("-o", "x.png", "--kind", "stability_map"), "name it with -y"),
        (("-o", "x.png", "--kind", "pie"), "bifurcation_diagram"),
        (("-o", "x.png", "--point", "b1/BP1"), "--kind machine"),
        (("-o", "x.png", "--kind", "machine", "--point", "b1/XX1"), "has no special point 'XX1'"),
        (("-o", "x.png", "--kind", "machine", "--point", "b1"), "has no special point ''"),
        (("-o", "x.png", "--kind", "eigenvalues", "-x", "r"), "has no -x and -y"),
        ((), "Missing option '-o'"),
    ],
)
def test_what_cannot_be_drawn(contwalk, fork_with_branches, folder, options, said):
    before = {path.name for path in folder.iterdir()}
    done = contwalk("plot", fork_with_branches, *options)
    assert done.code == 2
    assert said in done.err
    assert {path.name for path in folder.iterdir()} == before


CIRCLE = """
from contwalk.system import Mode, Parameter, State, System

def field(t, x, p, dx):
    growth = p.mu - x[0] ** 2 - x[1] ** 2
    dx[0] = growth * x[0] - x[1]
    dx[1] = x[0] + growth * x[1]

SYSTEM = System(
    "circle", (State("x", "m"), State("y", "m")), (Parameter("mu", 0.5, "m2"),), (Mode("only", field),)
)
"""
STUDY = """
contwalk: 1
system: ./circle.py
start: {state: {x: 0.0, y: 0.0}, parameters: {mu: -0.2}}
continue: {parameter: mu, range: [-0.2, 0.8]}
mark: {"max:x": [0.5], "amp:y": [0.6]}
output: circle.h5
figures: [bifurcation_diagram, {bifurcation_diagram: {y: "min:y", file: low.svg}}]
"""


def test_extremes_of_orbits_are_marked_drawn_shown_and_exported(contwalk, folder):
    (folder / "circle.py").write_text(CIRCLE, encoding="utf-8")
    (folder / "circle.yaml").write_text(
        STUDY.replace("bifurcation_diagram,", "{bifurcation_diagram: {file: all.svg}},")
    )
    done = contwalk("continue", "circle.yaml", "--quiet")
    assert done.code == 0, done.err
    # Without a name a state of cycles is drawn by both extremes, next to the equilibria's own value.
    assert "<!-- x, largest and least (m) -->" in (folder / "all.svg").read_text(encoding="utf-8")
    assert "<!-- min:y (m) -->" in (folder / "low.svg").read_text(encoding="utf-8")
    shown = contwalk("show", "circle.h5", "b2/UZ1").out
    assert "over the orbit" in shown
    (mu,) = re.findall(r"mu = (\S+) m2", shown)
    assert float(mu) == pytest.approx(0.25, rel=1e-8)  # the accuracy that is asked for by default
    assert contwalk("verify", "circle.h5", "--trust").code == 0
    assert contwalk("export", "circle.h5", "--csv", "tables").code == 0
    assert "max:x" in (folder / "tables" / "b2.csv").read_text(encoding="utf-8").splitlines()[0]
    done = contwalk("plot", "circle.h5", "-y", "max:z", "-o", "none.svg")
    assert done.code == 2
    assert "Did you mean 'max:y'" in done.err
    bad = contwalk("continue", "circle.yaml", "--set", "mark={x: [0.5]}")
    assert bad.code == 2
    assert "max:x, min:x, amp:x" in bad.err
