"""The page of a file of margins: each push with its border, and the machine at the instant."""

from __future__ import annotations

import pytest
from explorer_pages import MARGINS, blocks

import contwalk as cw
from contwalk.explorer import margins_page
from contwalk.storage.trajectory import write_margins


@pytest.fixture
def path(tmp_path):
    return write_margins(tmp_path / "x_margins.h5", MARGINS)


def test_each_push_is_told(path):
    page, missing = margins_page(path)
    head = blocks(page)["head"][0]
    rows = head["margins"]["rows"]
    assert [(row["state"], row["up"], row["text"]) for row in rows] == [
        ("q", False, "\u2192"),
        ("q", True, "0.25"),
        ("v", True, "0.5"),
    ]
    assert rows[0]["facts"][0] == "no border up to 4.0 m"
    assert rows[1]["facts"] == [
        "border at 0.25 m",
        "survival begins again further out",
        "beyond it: did_not_return",
        "7 simulations",
    ]
    # Bars are as long as borders of one unit compare.
    assert [row["share"] for row in rows] == [1.0, 1.0, 1.0]
    assert head["margins"]["instants"][0]["states"] == [["q", "0.125", "m"], ["v", "-0.5", "m/s"]]
    assert head["basin"]["labels"] == [0, 1]
    assert head["basin"]["names"] == ["b1/0", "not known"]
    assert cw.explore(path) == page
    # The system of such a file without a run cannot be had by name and hash: that is said, not guessed.
    assert all("machine" in sentence for sentence in missing)
