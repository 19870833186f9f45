"""A process that works for another one ends with it, in the middle of a request or an answer too."""

from __future__ import annotations

import os
import pickle
import subprocess
import sys

import pytest

from contwalk.diagram.ahead import Task
from contwalk.workflow.requests import Walk
from contwalk.workflow.study_text import StudyText

REQUEST = pickle.dumps(Walk(StudyText("no: run file", "nowhere.yaml", (), ""), Task((0,))))


@pytest.mark.parametrize(
    ("given", "read"),
    [(b"", True), (REQUEST[: len(REQUEST) // 2], True), (REQUEST, False)],
    ids=["nothing asked", "half a request", "an answer that nobody reads"],
)
def test_a_worker_ends_with_the_one_it_works_for(given, read):
    ours, theirs = os.pipe()
    command = [sys.executable, "-m", "contwalk.workflow.worker"]
    paths = {"PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    pipes = {"stdin": subprocess.PIPE, "stdout": theirs, "stderr": subprocess.PIPE}
    with subprocess.Popen(command, env={**os.environ, **paths}, **pipes) as process:
        os.close(theirs)
        if not read:
            os.close(ours)
        process.stdin.write(given)
        process.stdin.flush()
        if read:
            process.stdin.close()  # else it ends by what it says itself
        assert process.stderr.read() == b""
        assert process.wait() == 0
    if read:
        os.close(ours)
