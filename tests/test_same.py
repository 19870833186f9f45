"""`make same` compares two codes: each study is computed by the one that is asked for."""

from __future__ import annotations

from pathlib import Path

import pytest

from tools.same import ROOT, made

WRITES = """\
import sys
from pathlib import Path

Path(sys.argv[sys.argv.index("--output") + 1]).write_text("by this code")
"""


def test_a_study_is_computed_by_the_code_that_is_asked_for(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """And not by that in the current folder, which `python -m` puts before all others."""
    monkeypatch.chdir(ROOT)
    package = tmp_path / "code" / "contwalk"
    package.mkdir(parents=True)
    (package / "__init__.py").touch()
    (package / "__main__.py").write_text(WRITES, encoding="utf-8")
    study = tmp_path / "study.yaml"
    study.write_text("contwalk: 1\n", encoding="utf-8")
    found = made(study, tmp_path / "code", tmp_path / "made", {})
    assert found.database.read_text(encoding="utf-8") == "by this code"
