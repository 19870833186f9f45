"""Databases that say what no run would: a sentence of each command, and no file but those asked for."""

from __future__ import annotations

import json
from pathlib import Path

import h5py
import pytest
from hostile_records import Texts, changed

from contwalk.storage.file_database import _leads
from contwalk.system import Mode, Parameter, State, System, Transition

# Names and texts that would act: on the folder that is written to, on the terminal.
NAMES = ("../x", "/tmp/x", "..", ".x", "a/b", "a\\b", "", "a\x1b[2Jb", "a\nb", "a\rb", "b\x00", "\u202eb")
ACTING = "\x1b]0;owned\x07\x1b[2J\x9b31m\r\x08"
CONTROL = set("\x1b\x07\x08\x9b\r\x00\u202e")

COMMANDS = (
    ("show", "x.h5"),
    ("show", "x.h5", "--json", "--points"),
    ("show", "x.h5", "b1/0"),
    ("show", "x.h5", "b1/BP1"),
    ("export", "x.h5", "--csv", "tables", "--force"),
    ("diff", "x.h5", "fork.h5"),
    ("diff", "fork.h5", "x.h5"),
    ("plot", "x.h5", "-o", "x.svg", "--force"),
    ("verify", "x.h5", "--trust"),
    ("continue", "fork.yaml", "--resume", "--output", "x.h5", "--no-figures"),
)


@pytest.fixture
def fork(fork_with_branches, folder) -> Path:
    """The path of a database with a pitchfork."""
    return folder / fork_with_branches


def spoken(done, given):
    """That a command ends with a sentence, and lets nothing act on the terminal."""
    assert done.code in (0, 1, 2), given
    assert "internal error" not in done.err, (given, done.err)
    assert done.code == 0 or done.err.startswith(("error: ", "warning: ", "Not shown: ")) or done.out, given
    assert not set(done.out + done.err) & CONTROL, given


def files(folder):
    """All files of the folder and of the one above it but those that commands are asked for."""
    places = (*folder.parent.iterdir(), *folder.iterdir(), Path("/tmp/x.csv"))
    return {path for path in places if path.name not in ("x.h5", "x.svg", "tables") and path.exists()}


@pytest.mark.parametrize("seed", range(24))
def test_hostile_values_of_records(contwalk, fork, folder, seed):
    before = files(folder)
    told = changed(fork, folder / "x.h5", seed)
    for given in COMMANDS:
        spoken(contwalk(*given), (told, given))
    assert files(folder) == before


@pytest.mark.parametrize("name", NAMES)
def test_a_branch_whose_name_leads_elsewhere_or_acts(contwalk, fork, folder, name):
    """Names of branches become names of files."""
    before, target = files(folder), folder / "x.h5"
    target.write_bytes(fork.read_bytes())
    with h5py.File(target, "r+") as file:
        texts = Texts(file)
        told = json.loads(texts.read("branches/b2/info")[0])
        texts.write("branches/b2/info", [json.dumps(told | {"name": name})])
    for given in COMMANDS[:8]:
        done = contwalk(*given)
        spoken(done, given)
        assert done.code == 2, given
    assert files(folder) == before
    assert not (folder / "tables").exists()


@pytest.mark.parametrize("names", [("b1", "branches"), ("b1", "special_points"), ("b1", "B1")])
def test_a_branch_whose_table_would_be_another_one(contwalk, fork, folder, names):
    target = folder / "x.h5"
    target.write_bytes(fork.read_bytes())
    with h5py.File(target, "r+") as file:
        texts = Texts(file)
        for own, name in zip(("b1", "b2"), names, strict=True):
            told = json.loads(texts.read(f"branches/{own}/info")[0])
            texts.write(f"branches/{own}/info", [json.dumps(told | {"name": name})])
    done = contwalk("export", "x.h5", "--csv", "tables")
    assert done.code == 2
    assert f"'{names[1]}'" in done.err
    assert not (folder / "tables").exists()


WHEEL = """
system: rimless_wheel
parameters: {gamma: 0.1}
start: {simulate: {state: {theta: -0.2, omega_: 1.5}, until: settled}}
continue: {parameter: gamma, range: [0.08, 0.12], max_points: 4}
diagram: none
"""


@pytest.mark.parametrize(
    "legs",
    [
        [["nowhere", "strike", False]],
        [["MODE", "nothing", True]],
        [[True, "strike", True]],
        [[]],
        [["MODE"]],
        [["MODE", "heel_strike", True, True, True, True, True]],
    ],
)
def test_orbits_in_modes_that_the_system_has_not(contwalk, kept_study_of, folder, legs):
    database = kept_study_of("wheel", "", WHEEL)
    with h5py.File(folder / database, "r+") as file:
        texts = Texts(file)
        told = json.loads(texts.read("branches/b1/info")[0])
        mode = told["settings"]["legs"][0][0]
        told["settings"]["legs"] = [[mode if word == "MODE" else word for word in leg] for leg in legs]
        texts.write("branches/b1/info", [json.dumps(told)])
    for given in (
        ("show", database, "b1/0"),
        ("verify", database),
        ("plot", database, "-o", "x.svg", "--kind", "phase_portrait"),
        ("continue", "wheel.yaml", "--resume"),
    ):
        done = contwalk(*given)
        spoken(done, given)
        assert "modes or transitions that 'rimless_wheel' has not" in done.err + done.out, given


def test_a_transition_that_leads_out_of_another_mode_is_none_of_a_leg():
    """Out of a mode, or of one that soft transitions lead to from it."""

    def passed(t, x, p):
        return x[0]

    system = System(
        "modes",
        states=(State("x"),),
        parameters=(Parameter("a", 1.0),),
        modes=tuple(Mode(name, passed) for name in ("first", "second", "third")),
        transitions=(
            Transition("soften", "first", "second", passed, role="soft"),
            Transition("end", "second", "third", passed, reset=passed),
            Transition("again", "third", "first", passed, reset=passed),
        ),
    )
    leads = {
        mode: {name for name in ("", "end", "again") if _leads(system, mode, name)}
        for mode in ("first", "second", "third")
    }
    assert leads == {"first": {"", "end"}, "second": {"", "end"}, "third": {"", "again"}}


def test_texts_of_a_database_do_not_act_on_the_terminal(contwalk, fork, folder):
    target = folder / "x.h5"
    target.write_bytes(fork.read_bytes())
    with h5py.File(target, "r+") as file:
        texts = Texts(file)
        for place in (*texts.logs, *texts.specials):
            told = texts.read(place)
            if told:
                texts.write(place, [acting(text, place) for text in told])
        texts.write("notes", [json.dumps([f"k{ACTING}", f"a note{ACTING}"])])
    seen = ""
    for given in (*COMMANDS[:8], ("show", "x.h5", "b1"), ("show", "x.h5", "b1", "--points")):
        done = contwalk(*given)
        spoken(done, given)
        seen += done.out + done.err
    for told in ("a note", "origin", "description", "message"):
        assert f"{told}\\x1b]0;owned\\x07" in seen.replace("\n", ""), told
    for table in (folder / "tables").iterdir():
        assert not set(table.read_text(encoding="utf-8")) & CONTROL, table


def acting(text, place):
    """A record whose texts for people end in what would act."""
    record = json.loads(text)
    if place == "header":
        record["provenance"] |= {"description": f"description{ACTING}", "units": {"r": f"N{ACTING}"}}
        record["model"] = {f"masses{ACTING}": f"2{ACTING}"}
    elif "info" in place:
        record |= {"origin": f"origin{ACTING}"}
    elif "outcome" in place:
        record["outcome"]["message"] = f"message{ACTING}"
    elif isinstance(place, tuple):
        record |= {"note": f"note{ACTING}"}
    return json.dumps(record)


@pytest.mark.slow
def test_many_hostile_values_of_records(contwalk, fork, folder):
    for seed in range(100, 500):
        told = changed(fork, folder / "x.h5", seed)
        for given in COMMANDS[: 8 if seed % 8 else None]:
            spoken(contwalk(*given), (told, given))
