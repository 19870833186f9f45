"""Parameters as a plugin's functions read them."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

from contwalk.errors import UnsupportedOperation
from contwalk.system.names import nearest


class ParameterValues(SimpleNamespace):
    """Parameters by name, as a plugin's functions read them: `p.omega`."""

    def __getattr__(self, name: str) -> Any:
        hint = nearest(name, list(vars(self)))
        raise AttributeError(f"the system has no parameter '{name}'" + (f" ({hint})" if hint else ""))

    def __setattr__(self, name: str, value: Any) -> None:
        raise UnsupportedOperation(
            f"The function writes to the parameters: p.{name} = ... is not possible.",
            "Parameters are read only: use a variable.",
        )

    def __delattr__(self, name: str) -> None:
        raise UnsupportedOperation(f"The function deletes p.{name}.", "Parameters are read only.")
