"""`contwalk systems` and `contwalk init`."""

from __future__ import annotations

import pytest

from contwalk.cli import systems_list
from contwalk.system import loading
from contwalk.workflow.run_file.reading import read_run_file


def test_list(contwalk):
    done = contwalk("systems", "list")
    assert done.code == 0
    assert any(line.startswith("autobalancer ") for line in done.out.splitlines())


def test_list_with_a_system_that_cannot_be_loaded(contwalk, monkeypatch):
    def load(name):
        raise ImportError("no module named numba")

    monkeypatch.setattr(loading, "load_declaration", load)
    done = contwalk("systems", "list")
    assert done.code == 0
    assert "cannot be loaded: ImportError: no module named numba" in done.out
    assert systems_list.command.name == "list"


def test_describe(contwalk):
    done = contwalk("systems", "describe", "./fork.py")
    assert done.code == 0
    lines = [line.split() for line in done.out.splitlines()]
    for expected in (
        ["x", "m", "deflection"],
        ["r", "-0.5", "N", "[-5,", "5]", "load"],
        ["a", "0.25", "1", "(-inf,", "inf)", "supply"],
        ["height", "m", "largest", "x"],
        ["upright"],
        ["rich", "a=2"],
        ["reference:", "any", "textbook"],
    ):
        assert expected in lines


def test_describe_signals(contwalk):
    """What figures take beside states: heights of toes."""
    lines = [line.split() for line in contwalk("systems", "describe", "walker3d").out.splitlines()]
    assert ["signal", "unit", "about"] in lines
    assert ["height11", "m", "height", "of", "toe", "11"] in lines


def test_describe_a_model(contwalk):
    two = contwalk("systems", "describe", "autobalancer").out
    three = contwalk("systems", "describe", "autobalancer", "--set", "masses=3").out
    assert "beta3" not in two
    assert "beta3" in three
    assert "exchange_2_3" in three
    assert "a whole number from 1 up" in three
    assert contwalk("systems", "describe", "autobalancer", "--set", "model.masses=3").out == three


@pytest.mark.parametrize(
    ("choice", "said"),
    [
        ("masses=0", "a whole number from 1 up"),
        ("mases=3", "Did you mean 'masses'?"),
        ("masses", "this is not CHOICE=VALUE"),
        ("masses=[", "not valid YAML"),
    ],
)
def test_describe_what_is_no_model(contwalk, choice, said):
    done = contwalk("systems", "describe", "autobalancer", "--set", choice)
    assert (done.code, done.out) == (2, "")
    assert said in done.err


def test_check_a_good_plugin(contwalk):
    done = contwalk("systems", "check", "./fork.py")
    assert done.code == 0
    assert done.out.splitlines()[-1].endswith("ok, 0 warnings, 0 errors")


def test_check_names_the_line(contwalk, folder):
    plugin = (folder / "fork.py").read_text(encoding="utf-8")
    (folder / "fork.py").write_text(plugin.replace("    dx[1] = p.a - x[1]\n", ""), encoding="utf-8")
    done = contwalk("systems", "check", "./fork.py")
    assert done.code == 2
    line = next(line for line in done.out.splitlines() if line.startswith("error"))
    assert line.startswith("error    fork.py:3: field of mode 'free': It does not write dx[1] (state y).")
    assert done.out.splitlines()[-1].endswith("1 error")


def test_check_warnings_are_no_failure(contwalk, folder):
    plugin = (folder / "fork.py").read_text(encoding="utf-8")
    (folder / "fork.py").write_text(plugin.replace(', about="supply"', ""), encoding="utf-8")
    done = contwalk("systems", "check", "./fork.py")
    assert done.code == 0
    assert any(line.startswith("warning  fork.py:15: parameter 'a'") for line in done.out.splitlines())


def test_check_names_all_that_lack_the_same_in_one_line(contwalk, folder):
    """A plugin that was made of a text of equations has neither units nor meanings."""
    (folder / "eaten.txt").write_text("x' = a*x - x*y\ny' = x*y - y\na = 1.2\n", encoding="utf-8")
    assert contwalk("import", "eaten.txt", "-o", "eaten.py").code == 0
    lines = [line for line in contwalk("systems", "check", "eaten.py").out.splitlines() if "warning " in line]
    assert [line.partition(": ")[2] for line in lines] == [
        'states x, y and parameter a: No unit is given. Write unit="m", or unit="1" if it has none.',
        'states x, y and parameter a: No meaning is given. Write about="one line".',
    ]


def test_check_each_model(contwalk):
    done = contwalk("systems", "check", "autobalancer")
    assert done.code == 0
    for masses in (1, 2, 3):
        assert f"with masses={masses}, suspension=isotropic" in done.out


def test_init_writes_what_continue_accepts(contwalk, folder):
    done = contwalk("init", "./fork.py")
    assert (done.code, done.out) == (0, "Wrote fork.yaml. Next: contwalk continue fork.yaml\n")
    assert read_run_file(folder / "fork.yaml").system.name == "fork"
    assert contwalk("continue", "fork.yaml", "--quiet").code == 0


def test_init_refers_to_the_plugin_from_the_run_file(contwalk, folder):
    (folder / "runs").mkdir()
    assert contwalk("init", "fork.py", "-o", "runs/first.yaml").code == 0
    assert "system: ../fork.py" in (folder / "runs" / "first.yaml").read_text(encoding="utf-8")
    assert read_run_file(folder / "runs" / "first.yaml").system.name == "fork"


def test_init_with_a_model(contwalk, folder):
    assert contwalk("init", "autobalancer", "--set", "masses=3", "-o", "three.yaml").code == 0
    run_file = read_run_file(folder / "three.yaml")
    assert run_file.model["masses"] == 3
    assert run_file.system_reference == "autobalancer"


def test_init_replaces_nothing(contwalk, folder):
    (folder / "mine.yaml").write_text("mine", encoding="utf-8")
    done = contwalk("init", "./fork.py", "-o", "mine.yaml")
    assert done.code == 2
    assert "mine.yaml exists" in done.err
    assert (folder / "mine.yaml").read_text(encoding="utf-8") == "mine"
    assert contwalk("init", "./fork.py", "-o", "nowhere/x.yaml").code == 2


def test_a_file_that_is_not_there_is_looked_for_where_the_command_is_given(contwalk):
    refused = contwalk("systems", "check", "nowhere.py")
    assert refused.code == 2
    assert "Relative paths are relative to the current directory" in refused.err
