"""What can go wrong, said in sentences.

Every error that contwalk raises on purpose is a `ContwalkError`: a sentence that says what was wrong and
where, and a remedy that says what is allowed and what to do. The command line prints both and exits with
the class's exit code; a library user catches one class.
"""

from __future__ import annotations


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

    def __init__(self, sentence: str, remedy: str = "") -> None:
        super().__init__(sentence)
        self.sentence = sentence
        self.remedy = remedy

    def __str__(self) -> str:
        return f"{self.sentence} {self.remedy}".strip()


class SystemDefinitionError(ContwalkError):
    """A plugin that cannot be used: what it declares is incomplete or contradicts itself."""


class RunFileError(ContwalkError):
    """A run file that cannot be used."""


class DatabaseError(ContwalkError):
    """A branch database that cannot be read or written."""


class StartError(ContwalkError):
    """A start that does not exist, such as a named equilibrium outside its range of existence."""


class UnsupportedOperation(ContwalkError):
    """A plugin's function does something that contwalk cannot differentiate."""


class PluginError(ContwalkError):
    """A plugin's function raised an exception; the sentence names its line."""

    exit_code = 1


class NotFinite(ContwalkError):
    """A plugin's function gave NaN or infinity; the sentence names the line where it first arose."""

    exit_code = 1
