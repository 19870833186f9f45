"""What the site's page on Python is made of: docstrings that say of every argument what it is."""

from __future__ import annotations

import inspect

import pytest

import contwalk as cw

# Users are given these, and make none.
RESULTS = {"Branch", "ContwalkError", "DiagramFound", "SpecialPoint"}


@pytest.mark.parametrize("name", sorted({*cw.__all__} - RESULTS))
def test_every_argument_is_told(name):
    value = getattr(cw, name)
    told = (inspect.getdoc(value) or "").split("Parameters\n---")[-1]
    rows = "".join(line.partition(" : ")[0] + "\n" for line in told.splitlines() if not line.startswith(" "))
    listed = {each.strip("* ") for each in rows.replace(",", "\n").splitlines()}
    assert [each for each in inspect.signature(value).parameters if each not in listed] == []


@pytest.mark.parametrize("name", sorted(RESULTS))
def test_every_result_says_what_it_is(name):
    assert inspect.getdoc(getattr(cw, name))
