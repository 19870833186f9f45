"""The files of tests nearest to what has changed, by imports and by names: what `make near` runs.

    python -m tools.near                        against the branch main, what is not committed included
    python -m tools.near --base HEAD~3          against another commit
    python -m tools.near --worth 300            so many seconds of tests, 120 by itself

A file of tests is the nearer, the fewer imports lie between it and what has changed, and the more its name
and folders mirror it. What is no module of `contwalk` is near the tests that name it.
"""

from __future__ import annotations

import argparse
import ast
import re
import subprocess
import sys
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from tests.order import table
from tools.house.imports import PACKAGE, Graph, House, imported
from tools.mutants.nearest import common_parts

ROOT = Path(__file__).resolve().parents[1]
# Imports beyond which a change is no longer what a test is about.
FARTHEST = 3
# Seconds of tests that are run where nothing else is said; of a file that is not in the table of durations.
WORTH, UNKNOWN = 120.0, 1.5


@dataclass(frozen=True)
class Suite:
    """Texts of the files of tests and of what they share, by path, and who imports whom in `contwalk`."""

    texts: Mapping[str, str]
    imports: Graph
    seconds: Mapping[str, float]

    @classmethod
    def read(cls, root: Path = ROOT) -> Suite:
        """Those of a folder."""
        paths = sorted((root / "tests").rglob("*.py"))
        texts = {path.relative_to(root).as_posix(): path.read_text(encoding="utf-8") for path in paths}
        return cls(texts, House.read(root).imports, table())

    def nearest(self, changed: Iterable[str], worth: float) -> list[str]:
        """Files of tests, the nearest first, until they take so many seconds; the first one in any case."""
        found: dict[str, int] = {}
        for file in changed:
            for test, far in self._distances(file).items():
                found[test] = min(far, found.get(test, far))
        chosen, spent = [], 0.0
        for test in sorted(found, key=lambda test: (found[test], self._takes(test), test)):
            if not chosen or spent + self._takes(test) <= worth:
                chosen.append(test)
                spent += self._takes(test)
        return chosen

    def _takes(self, test: str) -> float:
        return self.seconds.get(test, UNKNOWN)

    def _distances(self, file: str) -> dict[str, int]:
        """How far files of tests are from one file that has changed; those that are too far are left out."""
        if Path(file).name.startswith("test_"):
            return {file: -FARTHEST} if file in self.texts else {}
        module = _module(file)
        if module in self.imports:
            steps = self._steps_to(module)
            far = {test: steps[test] - common_parts(file, test) for test in self._of_tests if test in steps}
        else:
            name = re.compile(rf"\b{re.escape(_name(file))}\b")
            far = {
                test: 1 - common_parts(file, test) for test in self._of_tests if name.search(self.texts[test])
            }
        return {test: distance for test, distance in far.items() if distance <= FARTHEST}

    def _steps_to(self, module: str) -> dict[str, int]:
        """How many imports lead from files of tests, and from modules, to a module."""
        steps, ahead = {module: 0}, [module]
        for node in ahead:
            for importer in self._importers.get(node, ()):
                if importer not in steps:
                    steps[importer] = steps[node] + 1
                    ahead.append(importer)
        return steps

    @cached_property
    def _of_tests(self) -> list[str]:
        return [path for path in self.texts if Path(path).name.startswith("test_")]

    @cached_property
    def _importers(self) -> dict[str, list[str]]:
        """Who imports what: modules each other, tests modules and what tests share."""
        found: dict[str, list[str]] = {}
        arrows = dict(self.imports)
        for path, text in self.texts.items():
            arrows[path] = frozenset(imported(ast.parse(text), self.imports)) - {PACKAGE}
        for importer, named in arrows.items():
            for name in named:
                found.setdefault(name, []).append(importer)
        return found


def _module(file: str) -> str:
    parts = Path(file).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def _name(file: str) -> str:
    """What tests call a file that is no module: by its name, or by its folder where the name says nothing."""
    path = Path(file)
    return path.parent.name if path.stem in ("__init__", "README") else path.stem


def changed_files(base: str, root: Path = ROOT) -> list[str]:
    """Files that are not as they were where this branch left `base`; untracked ones belong to them."""

    def told(*words: str) -> str:
        ran = subprocess.run(["git", *words], cwd=root, capture_output=True, text=True, check=False)
        if ran.returncode:
            raise SystemExit(
                f"git {' '.join(words)}: {ran.stderr.strip()} Name a commit that is there: --base."
            )
        return ran.stdout

    left = told("merge-base", "HEAD", base).strip()
    names = told("diff", "--name-only", left) + told("ls-files", "--others", "--exclude-standard")
    return sorted(set(names.splitlines()))


def main() -> None:
    """Print the files of tests, and to stderr for which changes."""
    parser = argparse.ArgumentParser(prog="python -m tools.near", description=__doc__.splitlines()[0])
    parser.add_argument("--base", default="main", help="the commit or branch to compare with")
    parser.add_argument("--worth", type=float, default=WORTH, help="seconds of tests")
    given = parser.parse_args()
    changed = changed_files(given.base)
    chosen = Suite.read().nearest(changed, given.worth)
    print(
        f"{len(changed)} files changed since {given.base}, {len(chosen)} files of tests near.",
        file=sys.stderr,
    )
    print("\n".join(chosen))


if __name__ == "__main__":
    main()
