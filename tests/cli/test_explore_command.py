"""`contwalk explore`: what is written, from what, and what is refused."""

from __future__ import annotations

import html
import json
import re

import drawn_circle
import pytest
from explorer_pages import blocks

import contwalk as cw
from contwalk.number_words import exact

CIRCLE = drawn_circle.PLUGIN.replace(
    'gid="arm")', 'label="<b>arm</b>")\n    axes.text(x[0], x[1], "</script><b>&")'
)
TURNS = drawn_circle.STUDY + 'description: "<script>alert(1)</script>"\n'


@pytest.fixture
def circle(kept_study_of):
    """An equilibrium, and circles of period 2 pi."""
    return kept_study_of("circle", CIRCLE, TURNS)


def test_every_stored_point_is_told_and_moves(contwalk, circle, folder):
    done = contwalk("explore", circle, "-o", "page.html", "--trust")
    assert (done.code, done.err) == (0, "")
    page = (folder / "page.html").read_text(encoding="utf-8")
    found = blocks(page)
    shown = json.loads(contwalk("show", circle, "--json", "--points").out)
    for branch in shown["branches"]:
        words, _ = found[f"words {branch['name']}"]
        assert len(words["rows"]) == branch["n_points"]
        assert list(words["points"]) == [point["name"] for point in branch["special_points"]]
        for row, point in zip(words["rows"], branch["points"], strict=True):
            cells = {cell for _, rows, _ in row[2] for cells in rows for cell in cells}
            assert {exact(value) for value in (*point["free"], *point["state"].values())} <= cells
    header, _ = found["motions b2"]
    # An orbit that has no extent yet has no motion.
    assert header["rows"] == list(range(1, shown["branches"][1]["n_points"]))
    assert header["periods"] == pytest.approx([6.283185307] * len(header["rows"]), rel=1e-7)
    assert len(header["machine"]["tracks"]) == shown["branches"][1]["n_points"]
    # At rest there is one picture; at an orbit as many as its motion asks for.
    assert {len(times) for times in found["motions b1"][0]["frames"]} == {1}


def test_the_same_database_gives_the_same_page(contwalk, circle, folder):
    for name in ("one", "two"):
        assert contwalk("explore", circle, "-o", f"{name}.html", "--trust", "--quiet").code == 0
    page = (folder / "one.html").read_bytes()
    assert page == (folder / "two.html").read_bytes()
    assert cw.explore(circle, trust=True).encode("utf-8") == page


def test_nothing_of_a_database_acts(contwalk, circle, folder):
    contwalk("explore", circle, "-o", "page.html", "--trust")
    page = (folder / "page.html").read_text(encoding="utf-8")
    assert "alert(1)" not in page
    assert "<b>" not in page
    policy = html.unescape(re.search(r'Content-Security-Policy" content="([^"]*)"', page)[1])
    assert "default-src 'none'" in policy
    assert "unsafe" not in policy
    assert not re.search(r"https?://(?!www\.w3\.org/2000/svg)", page)


def test_a_plugin_that_is_not_trusted_is_not_run(contwalk, circle, folder):
    done = contwalk("explore", circle, "-o", "page.html")
    assert done.code == 0
    assert "Not shown: the motions" in done.err
    assert "--trust" in done.err
    found = blocks((folder / "page.html").read_text(encoding="utf-8"))
    assert "motions b2" not in found
    assert any("--trust" in sentence for sentence in found["head"][0]["missing"])


def test_what_is_there_is_not_replaced(contwalk, circle, folder):
    (folder / "page.html").write_text("mine", encoding="utf-8")
    done = contwalk("explore", circle, "-o", "page.html")
    assert done.code == 2
    assert "--force" in done.err
    assert (folder / "page.html").read_text(encoding="utf-8") == "mine"
    assert contwalk("explore", circle, "-o", "page.html", "--force").code == 0


def test_what_is_no_database_is_refused(contwalk, folder):
    assert contwalk("explore", "missing.h5", "-o", "page.html").code == 2
    assert not (folder / "page.html").exists()
    done = contwalk("explore", "fork.py", "-o", "page.html")
    assert (done.code, "Traceback" in done.err) == (2, False)


def test_the_page_is_named_as_the_database(contwalk, circle, folder):
    assert contwalk("explore", circle).code == 0
    assert (folder / "circle.html").exists()


def test_a_draw_that_fails_is_told(contwalk, study_of, folder):
    name = study_of(
        "circle2", CIRCLE.replace("axes.text(x[0]", "axes.text(1 / 0"), TURNS.replace("circle", "circle2")
    )
    done = contwalk("explore", name, "-o", "page.html", "--trust")
    assert done.code == 0
    assert "ZeroDivisionError" in done.err
    assert "circle2.py" in done.err


def test_a_run_file_is_computed_and_its_page_opened(contwalk, folder, monkeypatch):
    opened = []
    monkeypatch.setattr("webbrowser.open", opened.append)
    done = contwalk("explore", "run.yaml", "-o", "page.html", "--quiet")
    assert (done.code, done.err) == (0, "")
    assert opened == [(folder / "page.html").resolve().as_uri()]
    # What has just been run is run again without being asked.
    assert "motions b1" in blocks((folder / "page.html").read_text(encoding="utf-8"))


@pytest.mark.parametrize(
    "given", [("--watch", "-o", "page.html"), ("--port", "8000"), ("--watch", "--port", "0")]
)
def test_options_that_do_not_fit_are_refused(contwalk, folder, given):
    done = contwalk("explore", "missing.h5", *given)
    assert done.code == 2
    assert "Traceback" not in done.err
