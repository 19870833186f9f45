"""What `make docs` puts together before Sphinx reads it, and how dead links are told."""

from __future__ import annotations

import re

import pytest
from code_blocks import ROOT

from tools.site.links import broken
from tools.site.staging import CHAPTERS, contents, staged


@pytest.fixture(scope="module")
def source(tmp_path_factory):
    where = tmp_path_factory.mktemp("site") / "source"
    return where, staged(where)


def test_every_page_is_in_one_chapter(source):
    _, pages = source
    listed = re.findall(r"^(\w[\w/]*)$", contents([*pages, "reference/api"]), re.MULTILINE)
    assert sorted(listed) == sorted({*pages, "reference/api"} - {"index"})
    assert len(pages) == len(list(ROOT.glob("docs/**/*.md"))) + 3


def test_a_page_of_no_chapter_is_told(source, monkeypatch):
    monkeypatch.delitem(CHAPTERS, "Coming from")
    with pytest.raises(SystemExit, match="coming_from/auto"):
        contents(source[1])


def test_what_is_no_page_becomes_a_file_of_the_site(source):
    where, _ = source
    text = (where / "overview.md").read_text(encoding="utf-8")
    assert (where / "files/runs/impact_oscillator_basin.yaml").is_file() == ("basin.yaml)" in text)
    assert "](images/planar_slope.png)" in text
    text = (where / "studies/run_files.md").read_text(encoding="utf-8")
    assert "(../reference/run_file.md)" in text


def test_links_of_the_source_lead_somewhere(source):
    where, pages = source
    for page in pages:
        file = where / f"{page}.md"
        text = re.sub(r"^```.*?^```$|`[^`\n]*`", "", file.read_text(encoding="utf-8"), flags=re.S | re.M)
        for target in re.findall(r"\]\(([^)\s#]+)[^)\s]*\)", text):
            assert "://" in target or (file.parent / target).exists(), (page, target)


def test_dead_links_of_the_site_are_told(tmp_path):
    (tmp_path / "a.html").write_text(
        '<a href="b.html#x">1</a><a href="c.html">2</a><a href="http://e.org">3</a>'
    )
    (tmp_path / "b.html").write_text(
        '<p id="y">here</p><a href="a.html">1</a><img src="https://e.org/x.png">'
    )
    assert broken(tmp_path) == [
        "a.html: b.html#x has no such place",
        "a.html: c.html is not there",
        "b.html: https://e.org/x.png is fetched from a network",
    ]


def test_no_line_of_a_page_is_a_comment(source):
    """To MyST what follows a percent sign at the start of a line is not for the reader."""
    for page in source[0].rglob("*.md"):
        text = re.sub(r"^```.*?^```", "", page.read_text(encoding="utf-8"), flags=re.DOTALL | re.MULTILINE)
        assert not re.search(r"^ {0,3}%", text, flags=re.MULTILINE), page.name
