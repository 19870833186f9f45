"""Reasons of several attempts are told once each."""

from __future__ import annotations

from contwalk.problems.hybrid.reasons_in_words import first_sentence, told_once


def test_reasons_that_differ_in_numbers_only_are_told_once():
    reasons = ["it ends at t = 7.854", "it ends at t = -1e-05", "it falls at t = 7.854", "it ends at t = 3"]
    assert told_once(reasons) == "it ends at t = 7.854; it falls at t = 7.854"


def test_remedies_and_full_stops_are_left_out():
    assert first_sentence("It ends at t = 4.71. Mend it.") == "It ends at t = 4.71"
