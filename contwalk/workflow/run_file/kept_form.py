"""Forms that have been checked before, kept on disk under the text and all that checks it.

Checking takes two packages that are a third of a process before its first point. A text whose form was right
is right for the same versions of all that has found so.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from importlib.util import find_spec
from pathlib import Path
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, cast

from contwalk import object_cache
from contwalk.module_texts import text_behind
from contwalk.workflow.run_file.document import Document

if TYPE_CHECKING:
    from contwalk.workflow.run_file.model import RunModel

# Files whose text tells the version of the packages that the form is checked by.
_VERSIONS = (("pydantic", "version.py"), ("ruamel.yaml", "__init__.py"))


class KeptSection(SimpleNamespace):
    """A section that was checked by an earlier process, as `Section` to those who read it."""

    def __init__(self, values: Mapping[str, Any], given: Iterable[str]) -> None:
        super().__init__(**values)
        self._names, self.model_fields_set = tuple(values), set(given)

    def model_dump(self, exclude_none: bool = False) -> dict[str, Any]:
        """Its values by name."""
        values = {name: getattr(self, name) for name in self._names}
        return {k: _dumped(v) for k, v in values.items() if not (exclude_none and v is None)}


def form_of(text: str, name: str, overrides: Sequence[str]) -> tuple[Document, RunModel]:
    """As `form.checked_form`, from what an earlier process has kept if it can be."""
    key = object_cache.key("run file", str(len(overrides)), text, *overrides, *_checked_by())
    kept = object_cache.load_values(key)
    if kept is not None:
        data, origins, form = kept
        return Document(name, data, origins), cast("RunModel", read_back(form))
    from contwalk.workflow.run_file.form import checked_form, written_out

    document, model = checked_form(text, name, overrides)
    try:
        form = written_out(model)
    except TypeError:  # a form with more than plain values is checked each time
        return document, model
    object_cache.store_values(key, (document.data, document.origins, form))
    return document, model


def read_back(form: Any) -> Any:
    """What `form.written_out` has made plain."""
    if isinstance(form, list):
        kind, what, *given = form
        if kind == "list":
            return [read_back(each) for each in what]
        return KeptSection(read_back(what), *given)
    if isinstance(form, tuple):
        return tuple(read_back(each) for each in form)
    return {key: read_back(each) for key, each in form.items()} if isinstance(form, dict) else form


def _checked_by() -> list[str]:
    """Texts of what checks a form."""
    texts = text_behind("contwalk.workflow.run_file.form")
    for package, file in _VERSIONS:
        found = find_spec(package)
        if found is not None and found.origin is not None:
            texts.append(Path(found.origin).with_name(file).read_text(encoding="utf-8"))
    return texts


def _dumped(value: Any) -> Any:
    return value.model_dump() if isinstance(value, KeptSection) else value
