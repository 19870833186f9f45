"""Reading a database runs no code of its plugin unless it is trusted, and says what has changed."""

from __future__ import annotations

import pytest

import contwalk as cw
from contwalk.errors import ContwalkError
from contwalk.storage import stored_system
from contwalk.workflow import runner

# Whoever runs the plugin, or the module beside it, leaves a file behind.
MARKED = "from pathlib import Path\nPath(__file__).with_suffix('.ran').touch()\n"
BESIDE = MARKED + "SUPPLY = 0.25\n"


@pytest.fixture
def database(contwalk, folder, monkeypatch):
    """A run of a plugin that imports a module beside it."""
    monkeypatch.syspath_prepend(folder)
    text = (folder / "fork.py").read_text(encoding="utf-8").replace('"a", 0.25', '"a", fork_values.SUPPLY')
    (folder / "fork.py").write_text(f"{MARKED}import fork_values\n{text}", encoding="utf-8")
    (folder / "fork_values.py").write_text(BESIDE, encoding="utf-8")
    assert contwalk("continue", "run.yaml", "--quiet").code == 0
    for ran in folder.glob("*.ran"):
        ran.unlink()
    return "fork.h5"


@pytest.mark.drawn(4)
@pytest.mark.parametrize(
    ("arguments", "code"),
    [
        (("show", "fork.h5"), 0),
        (("show", "fork.h5", "--json", "--points"), 0),
        (("show", "fork.h5", "b1/BP1"), 0),
        (("export", "fork.h5", "--csv", "tables"), 0),
        (("plot", "fork.h5", "-o", "a.svg"), 0),
        (("plot", "fork.h5", "--kind", "eigenvalues", "-o", "a.svg"), 0),
        (("plot", "fork.h5", "--kind", "machine", "-o", "a.svg"), 2),
        (("verify", "fork.h5"), 2),
        (("animate", "fork.h5", "b1/BP1", "-o", "a.gif"), 2),
    ],
)
def test_nothing_runs_without_trust(contwalk, folder, database, arguments, code):
    done = contwalk(*arguments)
    assert done.code == code
    assert not list(folder.glob("*.ran"))
    if code:
        assert "the plugin file ./fork.py, which is not run without being asked. Give --trust" in done.err
        assert contwalk(*arguments[:2], "--trust", *arguments[2:]).code in (0, 2)
        assert (folder / "fork.ran").exists()


def test_units_that_are_not_stored_are_not_shown(contwalk, folder, database, monkeypatch):
    """As in databases of earlier versions."""
    with monkeypatch.context() as patch:
        known = runner.provenance
        patch.setattr(runner, "provenance", lambda run_file: {**known(run_file), "units": None})
        assert contwalk("continue", "run.yaml", "--quiet", "--force").code == 0
    done = contwalk("show", database, "b1/BP1")
    assert done.code == 0
    assert done.err.startswith("Not shown: units. The system of fork.h5 is the plugin file ./fork.py")
    trusted = contwalk("show", database, "b1/BP1", "--trust").out.splitlines()
    assert any(line.split()[-1:] == ["m"] for line in trusted)


@pytest.mark.parametrize("changed", ["fork.py", "fork_values.py"])
def test_what_has_changed_is_said(contwalk, folder, database, changed):
    with (folder / changed).open("a", encoding="utf-8") as file:
        file.write("# another version\n")
    done = contwalk("verify", "--trust", database)
    assert done.err.startswith(
        f"warning: The plugin ./fork.py has changed since fork.h5 was computed ({changed})."
    )
    assert done.code == 0
    with (
        cw.open_database(database, trust=True) as db,
        pytest.warns(UserWarning, match=f"changed .*{changed}"),
    ):
        assert db.system().name == "fork"


def test_the_plugin_of_the_run_comes_first(contwalk, folder, database, monkeypatch):
    """It has been moved with the database; where the run file was stands another version."""
    moved = folder / "moved"
    moved.mkdir()
    for name in ("fork.py", "fork_values.py", "fork.h5"):
        (moved / name).write_bytes((folder / name).read_bytes())
    (folder / "fork.py").write_text("raise RuntimeError('changed')\n", encoding="utf-8")
    done = contwalk("verify", "--trust", "moved/fork.h5")
    assert (done.code, done.err) == (0, "")


def test_an_installed_system_that_has_changed(contwalk, folder, monkeypatch):
    run = (folder / "run.yaml").read_text(encoding="utf-8").replace("./fork.py", "bouncing_ball")
    assert run
    provenance = {"system_reference": "bouncing_ball", "plugin_sha256": "0" * 64}
    given = provenance, {}, "bouncing_ball", folder / "ball.h5"
    with pytest.raises(ContwalkError, match=r"installed system bouncing_ball has changed since .* --trust"):
        stored_system.system_of_run(*given)
    told = stored_system.system_of_run(*given, trust=True)
    assert told.system.name == "bouncing_ball"
    assert "has changed since" in told.changed
    same = {**provenance, "plugin_sha256": cw.load_system("bouncing_ball").source}
    assert stored_system.system_of_run(same, *given[1:]).changed == ""


def test_python_needs_trust_as_well(folder, database):
    with cw.open_database(database) as db:
        with pytest.raises(ContwalkError, match="trust=True"):
            db.system()
        assert not list(folder.glob("*.ran"))
        assert db.system(trust=True).name == "fork"


def test_the_plugin_is_found_where_the_run_file_was(folder, database, tmp_path):
    """The database alone has been moved."""
    away = tmp_path / "away"
    away.mkdir()
    moved = away / "fork.h5"
    moved.write_bytes((folder / "fork.h5").read_bytes())
    with cw.open_database(moved, trust=True) as db:
        assert db.system().name == "fork"
