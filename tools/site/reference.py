"""The page of what Python offers, from docstrings."""

from __future__ import annotations

import inspect

import contwalk
from contwalk import system

_HEAD = """# Python

`import contwalk as cw`: each name is imported when it is first used. Figures are on
[a page of their own](figures.md), and how a study is put together
from Python [on that of equations](equations.md#from-python).

"""
# What a plugin declares; the page on plugins explains it.
_DECLARED = sorted(name for name, thing in vars(system).items() if inspect.isclass(thing))


def page() -> str:
    """Its text, for MyST."""
    names = [name for name in contwalk.__all__ if name != "__version__"]
    parts = [_HEAD, *(_entry(f"cw.{name}", getattr(contwalk, name)) for name in sorted(names))]
    parts += ["\n## Declarations of a plugin\n\n`from contwalk.system import ...`\n\n"]
    parts += [_entry(name, vars(system)[name], level=3) for name in _DECLARED]
    return "".join(parts)


def _entry(title: str, thing: object, level: int = 2) -> str:
    home = f"{getattr(thing, '__module__', '')}.{getattr(thing, '__qualname__', '')}"
    kind = "autoclass" if inspect.isclass(thing) else "autofunction"
    members = "   :members:\n" if inspect.isclass(thing) else ""
    return f"{'#' * level} {title}\n\n```{{eval-rst}}\n.. {kind}:: {home}\n{members}```\n\n"
