"""`contwalk diff`: exit codes, and sentences for files that cannot be read."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import contwalk as cw
from contwalk.cli.entry import run

RUN = """
contwalk: 1
system: autobalancer
model: {masses: 2}
preset: heavy
parameters: {omega: 5.0}
start: {equilibrium: balanced, parameters: {delta: 0.0065}}
continue: {parameter: delta, range: [0.003, 0.0065], direction: backward}
diagram: none
"""


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> tuple[str, str]:
    folder = tmp_path_factory.mktemp("diff")
    (folder / "run.yaml").write_text(RUN, encoding="utf-8")
    for name, given in (("a", []), ("b", ["parameters.c=1.9"])):
        cw.run(cw.read_run_file(folder / "run.yaml", given, str(folder / f"{name}.h5")), figures=False)
    return str(folder / "a.h5"), str(folder / "b.h5")


def test_exit_codes_and_words(files, capsys):
    assert run(["diff", files[0], files[0]]) == 0
    assert "The same within errors." in capsys.readouterr().out
    assert run(["diff", *files]) == 1
    assert "The fixed parameter c is 2.0 in A and 1.9 in B." in capsys.readouterr().out


def test_json_is_one_document(files, capsys):
    assert run(["diff", *files, "--json"]) == 1
    document = json.loads(capsys.readouterr().out)
    assert document["diff_version"] == 1
    assert document["same"] is False
    assert document["differences"][0]["quantity"] == "c"


def test_what_cannot_be_read_is_a_sentence(files, tmp_path: Path, capsys):
    (tmp_path / "no.h5").write_text("no database", encoding="utf-8")
    for path in (tmp_path / "no.h5", tmp_path / "absent.h5"):
        assert run(["diff", files[0], str(path)]) == 2
        assert capsys.readouterr().err.startswith("error: ")
