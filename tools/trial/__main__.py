"""The command: every kind of trial, what each must keep, and the table."""

from __future__ import annotations

import argparse
import errno
import os
import random
import shutil
import signal
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import chdir, redirect_stderr, redirect_stdout, suppress
from pathlib import Path

from tests.hostile_records import changed, changed_plain
from tools.trial.commands import Done, Fault, Running, done, with_faults
from tools.trial.studies import FIELDS, MAGNITUDES, write_stressed, write_study

PAGE = Path(__file__).resolve().parents[2] / "docs" / "trial.md"
CONTINUE = ("continue", "study.yaml", "--quiet", "--no-figures")
WRITERS = {
    "continue": CONTINUE,
    "simulate": ("simulate", "study.yaml", "--quiet", "--no-figures"),
    "margins": ("margins", "study.yaml", "--quiet", "--no-figures"),
    "export": ("export", "study.h5", "--csv", "tables", "--force"),
    "plot": ("plot", "study.h5", "-o", "study.svg", "--force"),
}
READERS = (
    ("show", "{}", "--json", "--points"),
    ("show", "{}"),
    ("export", "{}", "--csv", "read", "--force"),
    ("plot", "{}", "-o", "read.svg", "--force"),
    ("diff", "{}", "study.h5"),
)
NAMES = ("../x", "a b", "é", "-x", "'; touch owned'", "$(touch owned)", "a\nb", "\x1b[2J", "x" * 300, ".", "")
# What a kind of trial does by itself if it is run whole.
FLIPS, CUTS, CRAFTED, JOBS = 500, 100, 500, 36
CRAFTED_ARRAYS = (
    ("study_margins.h5", (*READERS, ("diff", "study.h5", "{}"), ("verify", "{}", "--trust"))),
    ("study_trajectory.h5", (*READERS, ("animate", "{}", "-o", "read.svg"), ("verify", "{}", "--trust"))),
)


class Broken(Exception):
    """Something that must not happen."""


class Trial:
    """Folders with a study, and what has been tried in them.

    Parameters
    ----------
    root : Path
    random_ : random.Random
    share : float
        How much of each kind is tried.
    """

    def __init__(self, root: Path, random_: random.Random, share: float) -> None:
        self.root, self.random, self.share = root, random_, share
        self.whole, self.number = root / "whole", 0
        write_study(self.whole)
        for name in ("continue", "simulate", "margins"):
            made = done(self.whole, *WRITERS[name])
            if made.code != 0:
                raise Broken(f"the study itself fails: {name}: {made.said}")
        self.names = {path.name for path in self.whole.iterdir()}

    def some(self, count: int) -> range:
        """Numbers of so many trials, or of the share of them."""
        return range(max(1, round(count * self.share)))

    def folder(self, *, made: bool) -> Path:
        """A new folder with the study, and with what it makes."""
        self.number += 1
        where = self.root / f"t{self.number}" / "inside"
        if made:
            shutil.copytree(self.whole, where)
        else:
            write_study(where)
        return where

    def kept(self, where: Path, told: Done, what: str, *, killed: bool = False) -> None:
        """That a command ended with a sentence, and wrote nothing outside its folder."""
        ended = told.code in (0, 1, 2) or (killed and told.code == -9)
        if not ended or "internal error" in told.said or "Traceback" in told.said:
            raise Broken(f"{what}: ended with {told.code}: {told.said[:1500]}")
        if [path.name for path in where.parent.iterdir()] != [where.name] or (where / "owned").exists():
            raise Broken(f"{what}: a file outside the folder")

    def clean(self, where: Path, what: str, *more: str) -> None:
        """That no file is left but those that are asked for; the folder goes."""
        left = {path.name for path in where.iterdir()} - self.names - set(more)
        if left:
            raise Broken(f"{what}: left behind: {', '.join(sorted(left))}")
        shutil.rmtree(where.parent)

    def faults(self, how: int) -> Iterator[str]:
        """A fault at every write of each command that writes, and what goes on after it."""
        each = []
        for name in ("continue", "simulate", "margins", "export"):
            where = self.folder(made=name != "continue")
            writes = done(where, *WRITERS[name], *_over(name)).writes
            shutil.rmtree(where.parent)
            each += [(name, nth) for nth in range(1, writes + 1)]
        for name, nth in self.random.sample(each, len(self.some(len(each)))):
            where, what = self.folder(made=name != "continue"), f"{name}, write {nth}"
            command = (*WRITERS[name], *_over(name))
            self.kept(where, done(where, *command, fault=Fault(nth, how)), what, killed=how < 0)
            again = None
            if name == "continue" and (where / "study.h5").exists():
                self.kept(where, done(where, "show", "study.h5"), f"show after {what}")
                again = done(where, *command, "--resume")
            if again is None or again.code == 2:
                again = done(where, *command, *(["--force"] if name == "continue" else []))
            self.kept(where, again, f"again after {what}")
            if again.code != 0:
                raise Broken(f"again after {what}: {again.said}")
            if name == "continue":
                same = done(where, "diff", "study.h5", str(self.whole / "study.h5"))
                if same.code != 0:
                    raise Broken(f"another study after {what}: {same.said[-600:]}")
            self.clean(where, what, "tables")
            yield what

    def damaged(self, count: int, damage: Callable[[bytes], bytes]) -> Iterator[str]:
        """Files of every kind, changed, read by every command that reads them."""
        kinds = ("study.h5", "study_margins.h5", "study_trajectory.h5", "study.yaml")
        for k in self.some(count):
            where, kind = self.folder(made=True), kinds[k % len(kinds)]
            path = where / f"damaged{Path(kind).suffix}"
            path.write_bytes(damage((where / kind).read_bytes()))
            command = ("continue", "{}", "--output", "read.h5", "--no-figures")
            if kind != "study.yaml":
                command = READERS[(k // len(kinds)) % len(READERS)]
            given = [word.format(path.name) for word in command]
            self.kept(where, done(where, *given), f"{' '.join(given)} of {kind}")
            self.clean(where, kind, path.name, "read", "read.svg", "read.h5")
            yield kind

    def flips(self) -> Iterator[str]:
        """One bit is another one."""

        def flipped(content: bytes) -> bytes:
            place, changed_ = self.random.randrange(8 * len(content)), bytearray(content)
            changed_[place // 8] ^= 1 << place % 8
            return bytes(changed_)

        yield from self.damaged(FLIPS * 4, flipped)

    def cuts(self) -> Iterator[str]:
        """The end is missing."""
        yield from self.damaged(CUTS * 4, lambda content: content[: self.random.randrange(len(content))])

    def crafted(self) -> Iterator[str]:
        """Records that say what no run would, whole by their checksums."""
        for k in self.some(CRAFTED):
            where = self.folder(made=True)
            what = changed(where / "study.h5", where / "damaged.h5", self.random.randrange(1 << 30))
            given = [word.format("damaged.h5") for word in READERS[k % len(READERS)]]
            self.kept(where, done(where, *given), f"{given[0]}: {what}")
            self.clean(where, what, "damaged.h5", "read", "read.svg")
            yield what

    def crafted_arrays(self) -> Iterator[str]:
        """Margins and trajectories with arrays, texts and links that no command writes."""
        for k in self.some(CRAFTED):
            where, (kind, readers) = self.folder(made=True), CRAFTED_ARRAYS[k % len(CRAFTED_ARRAYS)]
            what = changed_plain(where / kind, where / "damaged.h5", self.random.randrange(1 << 30))
            given = [word.format("damaged.h5") for word in self.random.choice(readers)]
            self.kept(where, done(where, *given), f"{given[0]} of {kind}: {what}")
            self.clean(where, what, "damaged.h5", "read", "read.svg")
            yield what

    def jobs(self) -> Iterator[str]:
        """Faults while other processes work: none of them outlives the command, and nothing is lost."""
        for k in self.some(JOBS):
            name, how = ("continue", "margins")[k % 2], (0, -1, errno.ENOSPC)[k % 3]
            where, command = (
                self.folder(made=name != "continue"),
                (*WRITERS[name], "--jobs", "2", *_over(name)),
            )
            nth = self.random.randrange(1, 40) if how else 0
            running, what = Running(where, command, Fault(nth, how)), f"{name} --jobs 2, {how} at write {nth}"
            if how == 0 and (worker := running.worker()) is not None:
                time.sleep(self.random.random())
                with suppress(ProcessLookupError):
                    os.kill(worker, signal.SIGKILL)
            told = running.done()
            self.kept(where, told, what, killed=how < 0)
            if not running.all_ended():
                raise Broken(f"{what}: a process goes on without the command that began it")
            if how == 0 and name == "continue" and told.code != 0:
                raise Broken(f"{what}: {told.said}")
            if told.code:
                again = done(where, *command, "--resume")
                again = done(where, *command, "--force") if again.code == 2 else again
                self.kept(where, again, f"again after {what}")
            if name == "continue":
                same = done(where, "diff", "study.h5", str(self.whole / "study.h5"))
                if same.code != 0:
                    raise Broken(f"another study after {what}: {same.said[-600:]}")
            self.clean(where, what)
            yield what

    def hostile_names(self) -> Iterator[str]:
        """Names that would act, as every name that a command takes."""
        takes = [
            ("show", "{}"),
            ("show", "study.h5", "{}"),
            ("show", "study.h5", "b1/{}"),
            ("continue", "{}"),
        ]
        takes += [
            ("continue", "{}"),
            (*CONTINUE, "--output", "{}"),
            ("plot", "study.h5", "-o", "{}"),
            ("diff", "study.h5", "{}"),
        ]
        takes += [("export", "study.h5", "--csv", "{}"), ("init", "{}"), ("systems", "check", "{}")]
        each = [(take, name) for take in takes for name in NAMES if (take[-1], name) != ("{}", "../x")]
        for take, name in self.random.sample(each, len(self.some(len(each)))):
            where = self.folder(made=True)
            given = [word.format(name) for word in take]
            self.kept(where, done(where, *given), f"{given}")
            shutil.rmtree(where.parent)
            yield take[0]

    def two_writers(self) -> Iterator[str]:
        """Two at once of everything that writes: at least one is done, and what is there is whole."""
        for k in self.some(8 * len(WRITERS)):
            name = list(WRITERS)[k % len(WRITERS)]
            where, command = self.folder(made=True), WRITERS[name]
            command = command if "--force" in command else (*command, "--force")
            both = [Running(where, command) for _ in range(2)]
            ended = [each.done() for each in both]
            for told in ended:
                self.kept(where, told, f"two of {name}")
            if all(told.code for told in ended):
                raise Broken(f"two of {name}: none is done: {ended[0].said}")
            self.kept(where, done(where, "show", "study.h5"), f"show after two of {name}")
            self.clean(where, name, "tables", "study.svg")
            yield name

    def stress(self) -> Iterator[str]:
        """Fields whose numbers are at their limits."""
        each = [(field, at, size) for field, at in FIELDS.items() for size in MAGNITUDES]
        for field, at, size in self.random.sample(each, len(self.some(len(each)))):
            where, what = self.root / f"s{self.number}" / "inside", f"{field} at {size:g}"
            self.number += 1
            write_stressed(where, field, at, size)
            told = done(where, "continue", "stressed.yaml", "--quiet", "--no-figures")
            self.kept(where, told, what)
            shutil.rmtree(where.parent)
            yield what


def _over(name: str) -> tuple[str, ...]:
    """What has a command go over what is there."""
    return ("--force",) if name in ("simulate", "margins") else ()


def kinds_of(trial: Trial) -> dict[str, Iterator[str]]:
    """All kinds, each in words, with its trials."""
    return {
        "killed at a write, and gone on with": trial.faults(-1),
        "disk full from a write on (ENOSPC)": trial.faults(errno.ENOSPC),
        "disk broken from a write on (EIO)": trial.faults(errno.EIO),
        "one bit flipped: databases, margins, trajectories, run files": trial.flips(),
        "cut short: the same": trial.cuts(),
        "crafted databases, whole by their checksums": trial.crafted(),
        "crafted margins and trajectories": trial.crafted_arrays(),
        "processes of `--jobs` killed, and commands above them": trial.jobs(),
        "hostile names through every command": trial.hostile_names(),
        "two writers at once": trial.two_writers(),
        "fields at the limits of numbers": trial.stress(),
    }


def main() -> int:
    """Run all, tell each kind; 1 where something broke."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--share", type=float, default=1.0)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", default="")
    parser.add_argument("--table", action="store_true")
    given = parser.parse_args()
    rows, broken = [], 0
    with tempfile.TemporaryDirectory(prefix="contwalk_trial_") as name:
        trial = Trial(Path(name), random.Random(given.seed), given.share)
        for words, tried in kinds_of(trial).items():
            if given.only not in words:
                continue
            count, begun, why = 0, time.process_time() + sum(os.times()[2:4]), ""
            try:
                for _ in tried:
                    count += 1
            except Broken as error:
                why, broken = str(error), broken + 1
            spent = time.process_time() + sum(os.times()[2:4]) - begun
            rows.append((words, count, spent, why))
            print(f"{words}: {count} in {spent:.0f} CPU s{f' BROKEN: {why}' if why else ''}", flush=True)
    if given.table and not broken and not given.only:
        text = PAGE.read_text(encoding="utf-8")
        head = text[: text.index("| what")]
        lines = ["| what | trials | CPU s |", "|---|---|---|"]
        lines += [f"| {words} | {count} | {spent:.0f} |" for words, count, spent, _ in rows]
        lines += ["", f"A share of {given.share:g}, by seed {given.seed}: nothing broke."]
        PAGE.write_text(head + "\n".join(lines) + "\n", encoding="utf-8")
    return 1 if broken else 0


def warm() -> None:
    """Import and compile here, once, what the forked commands need."""
    from contwalk.cli.entry import run

    with (
        tempfile.TemporaryDirectory() as name,
        chdir(name),
        open(os.devnull, "w", encoding="utf-8") as nowhere,
    ):
        write_study(Path(name))
        readers = [[word.format("study.h5") for word in each] for each in READERS]
        with redirect_stdout(nowhere), redirect_stderr(nowhere):
            for command in (*WRITERS.values(), *readers):
                run(command)


if __name__ == "__main__":
    with_faults()
    warm()
    sys.exit(main())
