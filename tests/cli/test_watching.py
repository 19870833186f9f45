"""A plugin that does not come back is told of with its line."""

from __future__ import annotations

import functools
import subprocess
import sys
import time
from pathlib import Path

import pytest

from contwalk.cli import entry
from contwalk.workflow.watching import watching

LOOP = """
import time

def loop(seconds, until):
    while until() < seconds:
        wait()

def wait():
    time.sleep(0.01)
"""


# An observable that comes back in the process that is asked, and never in one that works for it.
WORKER = """
def height(t, x, p):
    own = getattr(sys.modules["__main__"], "__spec__", None)
    while own is not None and own.name == "contwalk.workflow.worker":
        pass
    return x[0, 0]


SYSTEM = System("""


def plugin(folder):
    path = folder / "loop.py"
    path.write_text(LOOP, encoding="utf-8")
    names = {}
    exec(compile(LOOP, str(path), "exec"), names)
    return names["loop"], path


def since(begun):
    return lambda: time.monotonic() - begun


def test_one_call_that_lasts_is_told_once_with_its_innermost_line(tmp_path):
    loop, path = plugin(tmp_path)
    said = []
    with watching(said.append, after=0.2, every=0.02):
        loop(0.8, since(time.monotonic()))
    (line,) = said
    assert line.startswith("note: the plugin has not come back for 0.2 s; it is at ")
    assert any(f"{path}, line {number}." in line for number in (5, 6, 9))


def test_many_calls_that_return_are_no_loop(tmp_path):
    loop, _ = plugin(tmp_path)
    said, begun = [], time.monotonic()
    with watching(said.append, after=0.3, every=0.02):
        while time.monotonic() - begun < 0.9:
            loop(0.03, since(time.monotonic()))
            time.sleep(0.03)
    assert said == []


def test_contwalk_itself_is_no_plugin():
    said = []
    with watching(said.append, after=0.05, every=0.01):
        time.sleep(0.2)
    assert said == [] or "test_watching.py" in said[0]


@pytest.mark.parametrize("command", ["continue", "simulate", "sample", "margins", "plot"])
def test_every_command_is_watched(contwalk, folder, monkeypatch, command):
    """The plugin takes its time once, where it is loaded: no function of it is called before."""
    monkeypatch.setattr(entry, "watching", functools.partial(watching, after=0.2, every=0.02))
    text = "import time\ntime.sleep(0.6)\n" + (folder / "fork.py").read_text(encoding="utf-8")
    if command == "plot":
        assert contwalk("continue", "run.yaml", "--quiet", "--no-figures").code == 0
    (folder / "fork.py").write_text(text, encoding="utf-8")
    drawn = ("fork.h5", "--kind", "machine", "-o", "fork.svg", "--trust")
    done = contwalk(command, *(drawn if command == "plot" else ("run.yaml", "--no-figures")))
    assert "has not come back for 0.2 s; it is at" in done.err
    assert "fork.py, line 2." in done.err


@pytest.mark.slow
@pytest.mark.parametrize("where", ["field", "import", "worker"])
def test_of_a_run_it_is_told_after_half_a_minute(folder, where):
    text = (folder / "fork.py").read_text(encoding="utf-8")
    if where == "import":
        text += "\nwhile True:\n    pass\n"
    elif where == "worker":
        text = "import sys\n" + text.replace("SYSTEM = System(", WORKER, 1)
        text = text.replace("lambda t, x, p: x[:, 0].max()", "height")
    else:
        text = text.replace("    dx[1] = p.a - x[1]\n", "    while True:\n        pass\n")
    (folder / "fork.py").write_text(text, encoding="utf-8")
    command = [sys.executable, "-m", "contwalk", "continue", "run.yaml", "--jobs", "2", "--quiet"]
    process = subprocess.Popen(command, cwd=folder, stderr=subprocess.PIPE, text=True)
    try:
        assert process.stderr is not None
        line = process.stderr.readline()
    finally:
        process.kill()
        process.communicate()
    assert "has not come back for 30 s; it is at" in line
    number = 1 + text[: text.index("while ")].count("\n")
    assert any(f"{Path('fork.py').name}, line {n}." in line for n in (number, number + 1))
