"""Names of files and numbers of run files that cannot be used: a sentence each, and exit code 2."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

LATIN, GREEK = b"n\xff", "größe_ω".encode()
ASCII = {"LC_ALL": "C", "LANG": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"}
LARGE = ("0x" + "f" * 4000, "-0x" + "f" * 4000, "9" * 4000, "9" * 5000, "0o" + "7" * 5000, "0b" + "1" * 9000)
KEYS = ("parameters.r", "continue.max_points", "engine.segments", "description", "contwalk", "start.state.x")


def commands(name):
    """Commands that are given a name of a file in each place where there is one."""
    return [
        [b"continue", name + b".yaml"],
        [b"continue", b"run.yaml", b"--output", name + b".h5"],
        [b"continue", b"run.yaml", b"--set", b"system=./" + name + b".py"],
        [b"continue", b"run.yaml", b"--set", b"description=" + name],
        [b"show", name + b".h5"],
        [b"export", b"fork.h5", b"--csv", name],
        [b"plot", b"fork.h5", b"-o", name + b".png"],
        [b"systems", b"describe", b"./" + name + b".py"],
        [b"init", b"./fork.py", b"-o", name + b".yaml"],
        [b"simulate", b"run.yaml", b"--set", b"simulate={until: 1.0}", b"--output", name + b".h5"],
    ]


def called(folder, given, environment=None):
    command = [sys.executable, "-m", "contwalk", *given]
    done = subprocess.run(command, cwd=folder, env={**os.environ, **(environment or {})}, capture_output=True)
    return done.returncode, done.stderr.decode("utf-8", "replace")


@pytest.mark.drawn(4)
@pytest.mark.parametrize("number", range(10))
@pytest.mark.parametrize(("name", "environment"), [(LATIN, {}), (LATIN, ASCII), (GREEK, ASCII)])
def test_a_name_that_is_no_text_here(folder, number, name, environment):
    before = os.listdir(folder)
    code, told = called(folder, commands(name)[number], environment)
    assert code == 2
    assert told.startswith("error: The name ")
    assert ("is not UTF-8 text" if name is LATIN else "PYTHONUTF8=1") in told
    assert os.listdir(folder) == before


def test_a_folder_whose_name_is_no_text(folder):
    there = os.path.join(os.fsencode(folder), LATIN)
    os.mkdir(there)
    code, told = called(there, ["systems", "list"])
    assert (code, told.endswith("is not UTF-8 text. Rename the file or the folder.\n")) == (2, True)


@pytest.mark.parametrize(
    "key", ["output: {}.h5", "system: ./{}.py", "figures: [{{machine: {{file: {}.png}}}}]"]
)
def test_a_name_in_a_run_file_that_the_locale_cannot_have(folder, key):
    line = key.format(GREEK.decode())
    kept = [each for each in (folder / "run.yaml").read_text().splitlines() if each[:6] != line[:6]]
    (folder / "named.yaml").write_text("\n".join([*kept, line]), encoding="utf-8")
    (folder / f"{GREEK.decode()}.py").write_bytes((folder / "fork.py").read_bytes())
    code, told = called(folder, ["continue", "named.yaml"], ASCII)
    assert code == 2
    assert "PYTHONUTF8=1" in told or "\\u03c9" in told or GREEK.decode() in told
    assert told.startswith("error: ")


@pytest.mark.parametrize("number", LARGE, ids=lambda text: f"{text[:3]}{len(text)}")
@pytest.mark.parametrize("key", KEYS)
def test_a_number_of_thousands_of_digits(contwalk, folder, number, key):
    done = contwalk("continue", "run.yaml", "--set", f"{key}={number}")
    assert done.code == 2
    assert done.err.startswith("error: --set ")
    assert len(done.err) < 1000
    run_file = (folder / "run.yaml").read_text(encoding="utf-8")
    (folder / "large.yaml").write_text(f"{run_file}parameters: {{r: {number}}}\n", encoding="utf-8")
    done = contwalk("continue", "large.yaml")
    assert done.code == 2
    assert "large.yaml, line 7, key parameters.r" in done.err
