"""The page on machines with events lists what its folder has, and each machine has its paragraph."""

from __future__ import annotations

import re

from peers.page import HEADINGS, LISTED, PAGE, listed, stored_rows
from peers.running import machines

MACHINES = machines()


def test_every_listed_value_of_every_machine_has_its_row():
    """If this fails: `python tests/peers/table.py MACHINE --page` writes the rows of a machine."""
    known = [
        listed(peer, study, value)
        for peer in MACHINES.values()
        for study in peer.studies
        for value in study.values
    ]
    assert [tuple(row[k] for k in LISTED) for row in stored_rows()] == known


def test_every_row_says_that_its_difference_is_covered():
    doubts = [v.doubt for peer in MACHINES.values() for study in peer.studies for v in study.values]
    for row, doubt in zip(stored_rows(), doubts, strict=True):
        cells = dict(zip(HEADINGS, row, strict=True))
        assert cells["covered"] == "yes"
        # both are written with two digits
        assert float(cells["difference"]) <= 1.1 * (float(cells["claimed"]) + doubt)


def test_every_machine_has_its_paragraph():
    """Under its title, with the file that has its equations."""
    text = PAGE.read_text(encoding="utf-8")
    sections = dict(re.findall(r"^### (.*)\n\n(.*)$", text, re.MULTILINE))
    assert list(sections) == [peer.title for peer in MACHINES.values()]
    for name, peer in MACHINES.items():
        assert f"machines/{name}.py" in sections[peer.title]
