"""`contwalk plot`: every kind of figure, in every format, and what cannot be drawn."""

from __future__ import annotations

import pytest

MAGIC = {"png": b"\x89PNG", "svg": b"<?xml", "pdf": b"%PDF"}


@pytest.fixture
def database(contwalk):
    assert contwalk("continue", "run.yaml", "--quiet", "--set", "diagram={follow: [BP]}").code == 0
    return "fork.h5"


@pytest.mark.parametrize("suffix", MAGIC)
def test_formats(contwalk, database, folder, suffix):
    done = contwalk("plot", database, "-o", f"figure.{suffix}")
    assert (done.code, done.out) == (0, f"Wrote figure.{suffix}.\n")
    assert (folder / f"figure.{suffix}").read_bytes().startswith(MAGIC[suffix])


def test_axes_with_units(contwalk, database, folder):
    contwalk("plot", database, "-x", "x", "-y", "r", "-o", "figure.svg")
    text = (folder / "figure.svg").read_text(encoding="utf-8")
    assert "<!-- x (m) -->" in text
    assert "<!-- r (N) -->" in text
    (folder / "fork.py").unlink()  # they are stored
    assert contwalk("plot", database, "-x", "x", "-y", "r", "-o", "figure.svg", "--force").code == 0
    assert "<!-- x (m) -->" in (folder / "figure.svg").read_text(encoding="utf-8")


def test_a_file_that_exists_is_replaced_only_with_force(contwalk, database, folder):
    (folder / "mine.png").write_bytes(b"mine")
    done = contwalk("plot", database, "-o", "mine.png")
    assert (done.code, done.err) == (
        2,
        "error: mine.png exists. Replace it with --force, or choose another output.\n",
    )
    assert (folder / "mine.png").read_bytes() == b"mine"
    assert contwalk("plot", database, "-o", "mine.png", "--force").code == 0
    assert (folder / "mine.png").read_bytes().startswith(MAGIC["png"])


def test_chosen_branches(contwalk, database, folder):
    contwalk("plot", database, "-o", "all.svg")
    contwalk("plot", database, "-o", "one.svg", "--branch", "b2", "--branch", "b2")
    everything = (folder / "all.svg").read_text(encoding="utf-8")
    one = (folder / "one.svg").read_text(encoding="utf-8")
    assert 'id="b1-' in everything
    assert 'id="b2-' in everything
    assert 'id="b1-' not in one
    assert 'id="b2-' in one


def test_eigenvalues(contwalk, database, folder):
    assert contwalk("plot", database, "--kind", "eigenvalues", "-o", "e.svg").code == 0
    assert "imaginary-axis" in (folder / "e.svg").read_text(encoding="utf-8")


def test_machine(contwalk, database, folder):
    for name in ("b1/BP1", "b1/3"):
        assert (
            contwalk(
                "plot", "--trust", "--force", database, "--kind", "machine", "--point", name, "-o", "m.svg"
            ).code
            == 0
        )
        assert f"<!-- {name}: r = " in (folder / "m.svg").read_text(encoding="utf-8")
    assert contwalk("plot", "--trust", "--force", database, "--kind", "machine", "-o", "start.png").code == 0
    (folder / "fork.py").unlink()
    done = contwalk("plot", "--trust", "--force", database, "--kind", "machine", "-o", "m.png")
    assert done.code == 2
    assert "cannot be loaded" in done.err


def test_stability_map_finds_the_swept_parameter(contwalk, folder):
    sweep = ("--set", "sweep={a: [0.5, 0.75, 1.0]}", "--output", "swept.h5")
    assert contwalk("continue", "run.yaml", "--quiet", *sweep).code == 0
    assert contwalk("plot", "swept.h5", "--kind", "stability_map", "-o", "map.svg").code == 0
    text = (folder / "map.svg").read_text(encoding="utf-8")
    assert "<!-- r (N) -->" in text
    assert "<!-- a -->" in text


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("-o", "x.gif"), ".png, .svg, .pdf"),
        (("-o", "nowhere/x.png"), "the directory nowhere does not exist"),
        (("-o", "x.png", "-y", "heigt"), "Did you mean 'height'?"),
        (("-o", "x.png", "--branch", "b9"), "has no branch 'b9'"),
        (("-o", "x.png", "--kind", "multipliers"), "No branch has multipliers"),
        (("-o", "x.png", "--kind", "stability_map"), "name it with -y"),
        (("-o", "x.png", "--kind", "pie"), "bifurcation_diagram"),
        (("-o", "x.png", "--point", "b1/BP1"), "--kind machine"),
        (("-o", "x.png", "--kind", "machine", "--point", "b1/XX1"), "has no special point 'XX1'"),
        (("-o", "x.png", "--kind", "machine", "--point", "b1"), "has no special point ''"),
        (("-o", "x.png", "--kind", "eigenvalues", "-x", "r"), "has no -x and -y"),
        ((), "Missing option '-o'"),
    ],
)
def test_what_cannot_be_drawn(contwalk, database, folder, options, said):
    before = {path.name for path in folder.iterdir()}
    done = contwalk("plot", database, *options)
    assert done.code == 2
    assert said in done.err
    assert {path.name for path in folder.iterdir()} == before
