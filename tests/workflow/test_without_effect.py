"""Marks outside the range and limits that a system has none of are told, with file, line and key."""

from __future__ import annotations

import json

import pytest
from run_file_cases import GOOD, read

from contwalk.cli.entry import run

SMOOTH = """
from contwalk.system import Mode, Parameter, State, System

def field(t, x, p, dx):
    dx[0] = p.mu - x[0]

SYSTEM = System("decay", (State("x"),), (Parameter("mu", 0.0), Parameter("nu", 0.0)), (Mode("only", field),))
"""
STUDY = """\
contwalk: 1
system: ./decay.py
start: {state: {x: 0.0}}
continue: {parameter: mu, range: [-1.0, 1.0], direction: up}
"""


@pytest.mark.parametrize(
    ("text", "parts"),
    [
        ("mark: {stiffness: [2.0, 4.5]}", ["line 8, key mark.stiffness:", "4.5 lies outside", "[1, 3]"]),
        ("mark: {stiffness: [0.5, 4.5]}", ["line 8, key mark.stiffness:", "0.5, 4.5 lie outside"]),
        ("  stop_at: {stiffness: 4}", ["line 8, key continue.stop_at.stiffness:", "4 lies outside"]),
        (
            "loci: {with: load, range: [0.0, 2.0]}\nmark: {load: 3.0}",
            ["line 9, key mark.load:", "3 lies outside the range [0, 2] of load"],
        ),
        ("events: {AZ: switch}", ["line 8, key events.AZ:", "'rotor' has no AZ", "a condition"]),
        ("events: {GR: switch, AZ: stop}", ["line 8, key events.AZ:", "nothing will stop there"]),
    ],
)
def test_what_cannot_come_about_is_told(tmp_path, text, parts):
    (sentence,) = read(tmp_path, f"{GOOD}{text}\n").without_effect.values()
    for part in (str(tmp_path / "run.yaml"), *parts):
        assert part in sentence


@pytest.mark.parametrize(
    "text",
    [
        "mark: {stiffness: [1.0, 3.0, extremum]}",
        "mark: {swing: 900.0}",
        "events: {GR: switch, OC: stop, AZ: ignore}",
        "loci: {with: load, range: [0.0, 2.0]}\nmark: {load: 2.0}",
    ],
)
def test_what_can_come_about_is_not(tmp_path, text):
    assert read(tmp_path, f"{GOOD}{text}\n").without_effect == {}


def test_a_run_tells_and_stores_it_until_the_range_is_widened(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "decay.py").write_text(SMOOTH)
    (tmp_path / "run.yaml").write_text(STUDY + "mark: {mu: 1.5}\nevents: {GR: switch}\n")
    sentences = [
        "run.yaml, line 5, key mark.mu: 1.5 lies outside the range [-1, 1] of mu, and no branch comes there. "
        "Widen the range, or remove the value.",
        "run.yaml, line 6, key events.GR: 'decay' has no GR, which needs an event or a watched transition: "
        "nothing will switch there. Remove it, or give `ignore`.",
    ]

    def notes():
        capsys.readouterr()
        assert run(("show", "run.h5", "--json")) == 0
        return [note["text"] for note in json.loads(capsys.readouterr().out)["notes"]]

    assert run(("continue", "run.yaml")) == 0
    printed = " ".join("".join(capsys.readouterr()).split())
    assert all(sentence in printed for sentence in sentences)
    assert notes() == sentences
    assert run(("continue", "run.yaml", "--resume", "--set", "continue.range=[-1, 2]")) == 0
    assert notes() == sentences[1:]
