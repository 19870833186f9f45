"""Six studies by the code as it is, beside what another commit made of them: branches, points and cost.

make same
make same REVISION=v0.1.0
python -m tools.same --environment NAME=VALUE --counts 0.05

The databases of a commit are made once and kept in `.same/`, by commit and run files; those of the code as it
is as well, by the text of all its files. With `--environment` the same code runs with the variables and
without. Exit code: 0 if nothing differs, 1 if something does.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import resource
import subprocess
import sys
import tarfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path

from contwalk.comparing.databases import Comparison, diff
from contwalk.errors import ContwalkError

ROOT = Path(__file__).parents[1]
KEPT = ROOT / ".same"
STUDIES = (
    "runs/autobalancer_cascade.yaml",
    "runs/planar_slope.yaml",
    "runs/autobalancer_load.yaml",
    "runs/autobalancer_border_chart.yaml",
    "tools/same_studies/fitzhugh_nagumo.yaml",
    "tools/same_studies/impact_oscillator.yaml",
)
# What the code is, beside the studies.
CODE = ("contwalk", "systems")


@dataclass(frozen=True)
class Made:
    """A database that a study left, and what it took: CPU seconds of the process."""

    database: Path
    seconds: float
    code: int


def code_of_tree(root: Path = ROOT) -> str:
    """A name for the code as it is: a hash of all its files."""
    digest = hashlib.sha256()
    for folder in CODE:
        for path in sorted((root / folder).rglob("*.py")):
            digest.update(path.relative_to(root).as_posix().encode() + b"\0" + path.read_bytes() + b"\0")
    return f"tree-{digest.hexdigest()[:16]}"


def commit_of(revision: str) -> str:
    """The full name of a commit."""
    asked = subprocess.run(
        ["git", "rev-parse", "--verify", f"{revision}^{{commit}}"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )
    if asked.returncode:
        raise SystemExit(f"error: there is no commit '{revision}'. Give one that `git log` knows.")
    return asked.stdout.strip()


def unpacked(commit: str, kept: Path = KEPT) -> Path:
    """The code of a commit, in a folder of its own."""
    place = kept / commit / "code"
    if not place.is_dir():
        packed = subprocess.run(
            ["git", "archive", "--format=tar", commit, *CODE], cwd=ROOT, capture_output=True, check=True
        )
        draft = place.with_name(f"code.{os.getpid()}")
        with tarfile.open(fileobj=BytesIO(packed.stdout)) as files:
            files.extractall(draft, filter="data")
        (draft / "contwalk_systems").symlink_to("systems")
        draft.rename(place)
    return place


def made(study: Path, code: Path, folder: Path, environment: Mapping[str, str]) -> Made:
    """The database of a study by some code, computed unless it is there."""
    digest = hashlib.sha256(json.dumps(sorted(environment.items())).encode())
    for path in sorted(study.parent.glob(f"{study.stem}.*")):
        digest.update(path.read_bytes())
    database = folder / f"{study.stem}-{digest.hexdigest()[:8]}.h5"
    said = database.with_suffix(".json")
    if database.exists() and said.exists():
        told = json.loads(said.read_text(encoding="utf-8"))
        return Made(database, told["seconds"], told["code"])
    folder.mkdir(parents=True, exist_ok=True)
    # `-P`: not the code in the current folder, which comes before all others otherwise.
    command = [sys.executable, "-P", "-m", "contwalk", "continue", str(study), "--output", str(database)]
    surroundings = {**os.environ, "PYTHONPATH": str(code), **environment}
    before = _seconds()
    # What contwalk says of bad input is no study that failed: it stops here.
    ran = subprocess.run(
        [*command, "--force", "--quiet", "--no-figures"],
        env=surroundings,
        capture_output=True,
        text=True,
        check=False,
    )
    seconds = _seconds() - before
    if ran.returncode not in (0, 1) or not database.exists():
        raise SystemExit(f"error: {study.name} ends with exit code {ran.returncode}:\n{ran.stderr}")
    said.write_text(json.dumps({"seconds": seconds, "code": ran.returncode}) + "\n", encoding="utf-8")
    return Made(database, seconds, ran.returncode)


def _seconds() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def too_far(comparison: Comparison, part: float) -> list[str]:
    """Branches whose counts of points are apart by more than a part of the larger, and by more than one."""
    return [
        f"{'+'.join(each.a)}: {each.points[0]} and {each.points[1]} points"
        for each in comparison.branches
        if abs(each.points[0] - each.points[1]) > max(1.0, part * max(each.points))
    ]


def told(name: str, a: Made, b: Made, comparison: Comparison) -> str:
    """A line of the table: the study, its points by branch, CPU seconds, and how many differences."""
    counts = [" ".join(str(each.points[k]) for each in comparison.branches) for k in (0, 1)]
    points = counts[0] if counts[0] == counts[1] else f"{counts[0]} -> {counts[1]}"
    number = len(comparison.all_differences)
    return (
        f"{name:<28}{a.seconds:>7.2f} ->{b.seconds:>6.2f} s  {str(number) if number else 'same':>5}  {points}"
    )


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the studies, print the table and what differs."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--revision", default="HEAD", help="the commit to compare with (HEAD)")
    parser.add_argument(
        "--environment",
        action="append",
        default=[],
        metavar="NAME=VALUE",
        help="compare a run with these variables with one without them, by the same code",
    )
    parser.add_argument(
        "--counts",
        type=float,
        metavar="PART",
        help="counts of points may be apart by this part of the larger, or by one",
    )
    parser.add_argument("studies", nargs="*", help="run files instead of the six studies")
    given = parser.parse_args(arguments)
    environment = {}
    for each in given.environment:
        name, equals, value = each.partition("=")
        if not name or not equals:
            parser.error(f"--environment takes NAME=VALUE, not '{each}'")
        environment[name] = value
    studies = [Path(each).resolve() for each in given.studies] or [ROOT / each for each in STUDIES]
    if missing := [str(each) for each in studies if not each.is_file()]:
        parser.error(f"there is no run file {', '.join(missing)}")
    return _compared(studies, given.revision, environment, given.counts)


def _compared(
    studies: Sequence[Path], revision: str, environment: Mapping[str, str], counts: float | None
) -> int:
    now = KEPT / code_of_tree()
    link = now / "code"
    if not link.is_dir():
        link.mkdir(parents=True)
        (link / "contwalk").symlink_to(ROOT / "contwalk")
        (link / "contwalk_systems").symlink_to(ROOT / "systems")
    if environment:
        print(f"A: the code as it is; B: with {' '.join(f'{k}={v}' for k, v in environment.items())}")
        before, code = now, link
    else:
        commit = commit_of(revision)
        print(f"A: {revision} ({commit[:12]}); B: the code as it is")
        before, code = KEPT / commit, unpacked(commit)
    worse, total = False, [0.0, 0.0]
    for study in studies:
        a, b = made(study, code, before, {}), made(study, link, now, environment)
        try:
            comparison = diff(a.database, b.database)
        except ContwalkError as error:
            raise SystemExit(f"error: {error}") from error
        total = [total[0] + a.seconds, total[1] + b.seconds]
        print(told(study.stem, a, b, comparison), flush=True)
        said = [each.text for each in comparison.all_differences]
        said += [] if counts is None else too_far(comparison, counts)
        worse = worse or bool(said)
        for text in said:
            print(f"    {text}")
    print(f"{'all':<28}{total[0]:>7.2f} ->{total[1]:>6.2f} s")
    return 1 if worse else 0


if __name__ == "__main__":
    sys.exit(main())
