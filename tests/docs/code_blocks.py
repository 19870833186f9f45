"""The fenced blocks of a page, and how its console lines are run."""

from __future__ import annotations

import io
import os
import re
import shlex
import subprocess
import sys
from contextlib import chdir, redirect_stderr, redirect_stdout
from pathlib import Path
from unittest.mock import patch

from contwalk.cli.entry import run

ROOT = Path(__file__).resolve().parents[2]


def blocks(page: str, language: str) -> list[str]:
    """Texts of the page's blocks of one language, in their order."""
    text = (ROOT / page).read_text(encoding="utf-8")
    return re.findall(rf"^```{language}\n(.*?)^```", text, flags=re.DOTALL | re.MULTILINE)


def commands(page: str) -> list[str]:
    """The console lines of a page that call contwalk."""
    lines = [line for block in blocks(page, "console") for line in block.splitlines()]
    assert all(line.startswith("$ ") for line in lines)
    return [line[2:] for line in lines if line.startswith("$ contwalk ")]


def environment() -> dict[str, str]:
    # The test run may sit in an environment that says where matplotlib draws or how wide a terminal is.
    kept = {name: value for name, value in os.environ.items() if name not in ("COLUMNS", "MPLBACKEND")}
    return kept | {"COLUMNS": "200"}


def run_command(line: str, where: Path) -> str:
    """The output of a console line that starts with `contwalk`; it must succeed.

    It runs in this process: what a process of its own imports takes longer than most of the commands.
    """
    program, *words = shlex.split(line)
    assert program == "contwalk"
    said, complained = io.StringIO(), io.StringIO()
    with (
        patch.dict(os.environ, environment(), clear=True),
        chdir(where),
        redirect_stdout(said),
        redirect_stderr(complained),
    ):
        code = run(words)
    assert code == 0, said.getvalue() + complained.getvalue()
    return said.getvalue()


def run_python(text: str, where: Path) -> str:
    """The output of a Python block, run as a program with warnings as errors."""
    program = where / "example.py"
    program.write_text(text, encoding="utf-8")
    return _run([sys.executable, "-W", "error", str(program)], where)


def _run(words: list[str], where: Path) -> str:
    done = subprocess.run(
        words, cwd=where, env=environment(), capture_output=True, text=True, timeout=120, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout
