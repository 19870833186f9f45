"""What can go wrong, said in sentences.

Every error that contwalk raises on purpose is a `ContwalkError`: a sentence that says what was wrong and
where, and a remedy that says what is allowed and what to do. The command line prints both and exits with
the class's exit code; a library user catches one class.
"""

from __future__ import annotations

import sys
import traceback
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import Any, NoReturn

from contwalk.python_functions import line_of, plain


class ContwalkError(Exception):
    """Root of all errors raised on purpose.

    Parameters
    ----------
    sentence : str
        What was wrong, and where (file, line, key) if that is known.
    remedy : str
        What is allowed, and what to do.
    """

    exit_code = 2
    # The reason code of a branch that it ends.
    reason = "no_convergence"

    def __init__(self, sentence: str, remedy: str = "") -> None:
        super().__init__(sentence)
        self.sentence = sentence
        self.remedy = remedy

    def __str__(self) -> str:
        return f"{self.sentence} {self.remedy}".strip()

    def _render_traceback_(self) -> list[str]:
        """What IPython shows: the lines of whoever called, and what was wrong."""
        frames = [f for f in traceback.extract_tb(self.__traceback__) if is_of_plugin(f.filename)]
        return [*map(str.rstrip, traceback.format_list(frames)), f"{type(self).__name__}: {self}"]


class Interrupted(KeyboardInterrupt):
    """Ctrl-C, in a sentence that says what is kept and how it goes on."""

    def _render_traceback_(self) -> list[str]:
        """What IPython shows: the sentence, and nothing of the machinery that was interrupted."""
        return [str(self)]


@contextmanager
def interruptible(
    sentence: str = "Interrupted: of this nothing is kept. cw.diagram and cw.run keep all that they find.",
) -> Iterator[None]:
    """Within it, and in functions under it, Ctrl-C says this sentence, and not where it came."""
    try:
        yield
    except Interrupted:
        raise
    except KeyboardInterrupt:
        raise Interrupted(sentence) from None


class SystemDefinitionError(ContwalkError):
    """A plugin that cannot be used: what it declares is incomplete or contradicts itself."""

    reason = "plugin_error"


class RunFileError(ContwalkError):
    """A run file that cannot be used."""


class DatabaseError(ContwalkError):
    """A branch database that cannot be read or written."""


class WriteError(DatabaseError):
    """A database that could not take more; what was stored before can be read."""

    exit_code = 1


class StartError(ContwalkError):
    """A start that does not exist, such as a named equilibrium outside its range of existence."""


class UnsupportedOperation(ContwalkError):
    """A plugin's function does something that contwalk cannot differentiate."""

    reason = "plugin_error"


class PluginError(ContwalkError):
    """A plugin's function raised an exception; the sentence names its line."""

    exit_code = 1
    reason = "plugin_error"


class NotSmooth(PluginError):
    """A field jumps where a motion crosses a place in it: no derivative of the motion is right beyond."""


class NotFinite(ContwalkError):
    """A plugin's function gave NaN or infinity; the sentence names the line where it first arose."""

    exit_code = 1
    reason = "not_finite"


def plugin_line(error: BaseException) -> str:
    """`file, line n` of the innermost frame of the traceback that is not part of contwalk or numpy.

    One of a library, Python's own included, counts only where there is no other: a plugin may be installed.
    """
    frames = [f for f in traceback.extract_tb(error.__traceback__) if not _is_library(f.filename)]
    own = [f for f in frames if is_of_plugin(f.filename)]
    if not frames:
        return NO_LINE
    innermost = (own or frames)[-1]
    return f"{innermost.filename}, line {innermost.lineno}"


def calling_line() -> str:
    """`file, line n` of the plugin's function that is being called right now."""
    frame = sys._getframe(1)
    while frame is not None and _is_library(frame.f_code.co_filename):
        frame = frame.f_back  # type: ignore[assignment]
    return NO_LINE if frame is None else f"{frame.f_code.co_filename}, line {frame.f_lineno}"


# What stands for a line that is not known.
NO_LINE = "the plugin"
_OWN = str(Path(__file__).resolve().parent)


@cache
def _libraries() -> tuple[str, ...]:
    """Where Python and installed packages are."""
    import sysconfig  # every command imports this module, and few have a plugin's line to tell

    return tuple(str(Path(sysconfig.get_path(kind)).resolve()) for kind in ("stdlib", "purelib", "platlib"))


def is_of_plugin(filename: str) -> bool:
    """Whether a file is neither of contwalk nor of a library, Python's own included."""
    return not _is_library(filename) and not str(Path(filename).resolve()).startswith(_libraries())


def _is_library(filename: str) -> bool:
    """Whether a file belongs to contwalk or numpy, and not to a plugin."""
    path = str(Path(filename).resolve())
    return (
        filename.startswith("<") or path.startswith(_OWN) or "site-packages/numpy/" in path.replace("\\", "/")
    )


def called(what: str, function: Callable[..., Any], *arguments: Any) -> Any:
    """The result of a plugin's function; an exception in it becomes a `PluginError` that names the line.

    Parameters
    ----------
    what : str
        The function in words, as `observable 'amplitude'`.
    """
    try:
        return plain(function)(*arguments)
    except (Exception, SystemExit) as error:
        _raise_told(what, error)


def _raise_told(what: str, error: BaseException) -> NoReturn:
    """Raise an exception of a plugin's function in words."""
    if isinstance(error, UnsupportedOperation):
        raise UnsupportedOperation(f"{plugin_line(error)}: {error.sentence}", error.remedy) from error
    if isinstance(error, ContwalkError):
        raise error
    raise PluginError(
        f"The {what} raised an exception at {plugin_line(error)}: {type(error).__name__}: {error}.",
        "Mend the plugin.",
    ) from error


def measured(what: str, function: Callable[..., Any], t: Any, x: Any, p: Any) -> float:
    """The number that a plugin's function makes of a motion, as `called`.

    It gets copies of times and states: whatever it changes in them is its own. Where it has no value it is
    NaN, which a run tells once a branch and not, as NumPy would, in the midst of what it prints.
    """
    return all_measured([(what, function)], t, x, p)[0]


def all_measured(functions: Iterable[tuple[str, Callable[..., Any]]], t: Any, x: Any, p: Any) -> list[float]:
    """As `measured`, of several functions of one motion."""
    import numpy as np  # here, since every command imports this module, and not all of them need it

    with np.errstate(all="ignore"):
        return [_number(what, function, t, x, p) for what, function in functions]


def _number(what: str, function: Callable[..., Any], t: Any, x: Any, p: Any) -> float:
    times = t.copy() if hasattr(t, "copy") else t
    try:
        value = plain(function)(times, x.copy(), p)
    except (Exception, SystemExit) as error:
        _raise_told(what, error)
    try:
        return float(value)
    except (TypeError, ValueError) as error:
        raise PluginError(
            f"The {what} gives no number: {line_of(function)}{type(error).__name__}: {error}.",
            "Mend the plugin.",
        ) from error
