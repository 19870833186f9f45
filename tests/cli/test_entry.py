"""The commands as a whole: help, bad input, exit codes, what becomes of errors."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

import contwalk as package
from contwalk.cli import show_command

COMMANDS = (
    (),
    ("init",),
    ("continue",),
    ("simulate",),
    ("sample",),
    ("warmup",),
    ("show",),
    ("plot",),
    ("export",),
    ("systems",),
    ("systems", "list"),
    ("systems", "describe"),
    ("systems", "check"),
    ("systems", "stress"),
)


@pytest.mark.parametrize("command", COMMANDS, ids=" ".join)
def test_help_imports_nothing_heavy(command):
    code = (
        "import sys; from contwalk.cli.entry import run\n"
        f"assert run({[*command, '--help']!r}) == 0\n"
        "heavy = {'numpy', 'h5py', 'matplotlib', 'pydantic', 'ruamel', 'rich', 'mpmath'} & set(sys.modules)\n"
        "assert not heavy, heavy"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("Usage: contwalk")


def test_help_lists_what_there_is(contwalk):
    bare = contwalk()
    assert bare.code == 0
    for name in ("init", "continue", "show", "plot", "export", "systems"):
        assert f"\n  {name} " in bare.out


def test_version(contwalk):
    assert contwalk("--version").out == f"contwalk {package.__version__}\n"


def test_python_m(folder):
    done = subprocess.run(
        [sys.executable, "-m", "contwalk", "--version"], capture_output=True, text=True, check=True
    )
    assert done.stdout.startswith("contwalk ")


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("sho",), "There is no command 'sho'. Did you mean 'show'?"),
        (("systems", "chek"), "Did you mean 'check'?"),
        (("continue",), "Missing argument 'FILE'"),
        (("continue", "nothing.yaml"), "nothing.yaml does not exist"),
        (("continue", "run.yaml", "--resume", "--force"), "Give one of them"),
        (("continue", "run.yaml", "--sett", "x=1"), "--sett"),
        (("continue", "run.yaml", "--set", "parameters.q=1"), "'q' is not a parameter"),
        (("continue", "fork.py"), "fork.py"),
        (("show", "nothing.h5"), "nothing.h5 does not exist"),
        (("show", "run.yaml"), "not a contwalk database"),
        (("show",), "Missing argument 'DB'"),
        (("plot", "nothing.h5", "-o", "x.png"), "nothing.h5 does not exist"),
        (("export", "nothing.h5", "--csv", "tables"), "nothing.h5 does not exist"),
        (("systems", "describe", "forkk"), "no installed system named 'forkk'"),
        (("systems", "describe", "./none.py"), "none.py does not exist"),
        (("systems", "check", "./none.py"), "none.py does not exist"),
        (("init", "./none.py"), "none.py does not exist"),
    ],
)
def test_bad_input(contwalk, folder, arguments, said):
    before = sorted(folder.iterdir())
    done = contwalk(*arguments)
    assert done.code == 2
    assert done.out == ""
    assert done.err.startswith("error: ")
    assert said in done.err
    assert "Traceback" not in done.err
    assert [p for p in sorted(folder.iterdir()) if p.name != "__pycache__"] == before


def _fails(error):
    def print_text(*_):
        raise error

    return print_text


@pytest.fixture
def database(contwalk):
    assert contwalk("continue", "run.yaml", "--quiet").code == 0
    return "fork.h5"


def test_a_bug_is_not_hidden(contwalk, database, monkeypatch):
    monkeypatch.setattr(show_command, "_print_text", _fails(RuntimeError("lost a sign")))
    done = contwalk("show", database)
    assert done.code == 1
    assert "internal error: RuntimeError: lost a sign" in done.err
    assert "CONTWALK_TRACEBACK=1" in done.err
    assert "Traceback" not in done.err
    monkeypatch.setenv("CONTWALK_TRACEBACK", "1")
    assert "Traceback (most recent call last)" in contwalk("show", database).err


def test_ctrl_c_anywhere(contwalk, database, monkeypatch):
    monkeypatch.setattr(show_command, "_print_text", _fails(KeyboardInterrupt()))
    done = contwalk("show", database)
    assert (done.code, done.err.strip()) == (130, "Interrupted.")


def test_reader_that_leaves(contwalk, database, folder):
    """As `contwalk show ... | head -1`, with more output than a pipe holds."""
    read, write = os.pipe()
    command = [sys.executable, "-m", "contwalk", "show", database, "--json", "--points"]
    process = subprocess.Popen(command, stdout=write, stderr=subprocess.PIPE, cwd=folder)
    os.close(write)
    os.read(read, 10)
    os.close(read)
    assert process.communicate()[1] == b""
    assert process.returncode in (0, 1)


@pytest.mark.drawn(3)
@pytest.mark.parametrize(
    "arguments",
    [
        ("continue", "run.yaml", "--output", "LONG.h5"),
        ("continue", "LONG.yaml"),
        ("continue", "run.yaml", "--set", "system=./LONG.py"),
        ("show", "LONG.h5"),
        ("plot", "fork.h5", "-o", "LONG.png"),
        ("export", "fork.h5", "--csv", "LONG"),
        ("animate", "fork.h5", "b1/0", "-o", "LONG.gif", "--trust"),
        ("systems", "check", "./LONG.py"),
        ("init", "autobalancer", "-o", "LONG.yaml"),
    ],
)
def test_names_that_are_too_long(contwalk, database, arguments):
    done = contwalk(*(word.replace("LONG", 300 * "a") for word in arguments))
    assert done.code == 2
    assert "too long" in done.err
    assert "internal error" not in done.err


@pytest.mark.parametrize("closed", [1, 2])
def test_streams_that_are_closed(contwalk, database, folder, closed):
    """As `contwalk show ... >&-`."""
    command = [sys.executable, "-m", "contwalk", "show", database]
    done = subprocess.run(
        command, cwd=folder, preexec_fn=lambda: os.close(closed), capture_output=True, text=True, check=False
    )
    assert done.returncode == 0
    assert done.stderr == ""


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="needs a device that is always full")
def test_output_that_does_not_fit(contwalk, database, folder):
    with open("/dev/full", "w", encoding="utf-8") as full:
        command = [sys.executable, "-m", "contwalk", "show", database]
        done = subprocess.run(
            command, stdout=full, stderr=subprocess.PIPE, text=True, cwd=folder, check=False
        )
    assert done.returncode == 1
    assert done.stderr.startswith("error: what is printed cannot be written: ")
    assert len(done.stderr.splitlines()) == 1


def test_letters_that_the_terminal_lacks(contwalk, database, folder):
    environment = {**os.environ, "PYTHONIOENCODING": "ascii"}
    plugin = (folder / "fork.py").read_text(encoding="utf-8").replace("any textbook", "Poincaré")
    (folder / "fork.py").write_text(plugin, encoding="utf-8")
    command = [sys.executable, "-m", "contwalk", "systems", "describe", "./fork.py"]
    done = subprocess.run(command, capture_output=True, env=environment, cwd=folder, check=False)
    assert (done.returncode, done.stderr) == (0, b"")
    assert b"Poincar\\xe9" in done.stdout


def test_a_reader_that_stops_reading_is_no_error_of_a_plugin(tmp_path):
    """As after `| head`: rich would leave the process, which a plugin is then blamed for."""
    import io

    from contwalk.cli.terminal import console, line

    class Closed(io.StringIO):
        def write(self, text):
            raise BrokenPipeError

    out = console()
    out.file = Closed()
    with pytest.raises(BrokenPipeError):
        line(out, "some text")


def test_the_collector_runs_as_usual_after_loading():
    code = (
        "import gc; usual = gc.get_threshold(); own = gc.get_freeze_count()  # Python 3.12 begins with some\n"
        "from contwalk.cli.collector import hold_collector, loaded\n"
        "loaded(); assert gc.get_freeze_count() == own, 'nothing was held'\n"
        "hold_collector(); assert gc.get_threshold()[0] > usual[0]\n"
        "loaded(); assert gc.get_threshold() == usual and gc.isenabled() and gc.get_freeze_count() > own\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
