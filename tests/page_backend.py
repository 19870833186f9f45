"""The storage backend of the page that says how one is added, as the module that the page makes of it."""

from __future__ import annotations

import re
import sys
from functools import cache
from pathlib import Path
from types import ModuleType

PAGE = Path(__file__).parents[1] / "docs" / "howto" / "storage_backends.md"
NAME = "contwalk.storage.json_lines"


@cache
def json_lines() -> ModuleType:
    """The module of the page."""
    text = re.findall(r"^```python\n(.*?)^```", PAGE.read_text(encoding="utf-8"), re.DOTALL | re.MULTILINE)[0]
    module = ModuleType(NAME)
    sys.modules[NAME] = module
    exec(compile(text, str(PAGE), "exec"), module.__dict__)
    return module


def backends() -> dict[str, str]:
    """The table of the page."""
    text = re.findall(r"^```python\n(.*?)^```", PAGE.read_text(encoding="utf-8"), re.DOTALL | re.MULTILINE)[1]
    found: dict[str, dict[str, str]] = {}
    exec(text, found)
    return found["BACKENDS"]
