"""What every database offers as a collection of branches that is open for a while."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator
from types import TracebackType
from typing import Self

from contwalk.branch import Branch


class NamedBranches(ABC):
    """Branches by their names, in the order of creation."""

    @abstractmethod
    def branch_names(self) -> list[str]:
        """Names in the order of creation."""

    @abstractmethod
    def branch(self, name: str) -> Branch:
        """One branch, sorted and named."""

    @abstractmethod
    def close(self) -> None:
        """Refuse further use."""

    def branches(self) -> list[Branch]:
        """All branches."""
        return [self.branch(name) for name in self.branch_names()]

    def __getitem__(self, name: str) -> Branch:
        return self.branch(name)

    def __iter__(self) -> Iterator[Branch]:
        """The branches in the order of creation."""
        return iter(self.branches())

    def __len__(self) -> int:
        """The number of branches."""
        return len(self.branch_names())

    def __contains__(self, name: object) -> bool:
        """Whether there is a branch of this name."""
        return name in self.branch_names()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()
