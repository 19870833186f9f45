"""What a period without derivatives costs where motions are pushed, as `contwalk margins` computes them.

    python benchmarks/stride_cost.py RUNFILE DATABASE

The run file has a section `margins`, and the database its solution, which `contwalk continue` has stored.
Small pushes of one state after the other, all of which come back: processor time of 400 periods and more,
five times, after as many that make the machine known.
"""

from __future__ import annotations

import os
import resource
import sys

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # as the command line does

import numpy as np

from contwalk.studies.margins.survival import Survival
from contwalk.workflow.margin_rays import survival_of
from contwalk.workflow.margin_study import study_of
from contwalk.workflow.run_file.margins import read_margins

PUSH, MOTIONS, REPEATED = 1e-3, 20, 5  # pushes in parts of the states' magnitudes


def main() -> None:
    """Print milliseconds a period, one line each time, with the machine's load."""
    file, database = sys.argv[1:]
    asked = [f"margins.of.from={os.path.abspath(database)}", "margins.instants=[0]"]
    study, _, _ = study_of(read_margins(file, asked, database))
    survival = survival_of(study)
    _followed(survival)
    for _ in range(REPEATED):
        begin = _processor()
        periods, events = _followed(survival)
        cost = 1e3 * (_processor() - begin) / periods
        print(f"{cost:.2f} ms a period, {events / periods:.1f} events, load {os.getloadavg()[0]:.1f}")


def _followed(survival: Survival) -> tuple[float, int]:
    """Periods that some pushed motions last for, and their events."""
    solution, random = survival.solution, np.random.default_rng(1)
    instant, periods, count = solution.instants[0], 0.0, 0
    for number in range(MOTIONS):
        push, state = np.zeros(len(instant.state)), instant.exists[number % len(instant.exists)]
        push[state] = PUSH * random.standard_normal() * solution.magnitudes[state]
        _, events = survival.followed(instant, push)
        periods += (survival.end.time - instant.time) / solution.period
        count += len(events)
    return periods, count


def _processor() -> float:
    return resource.getrusage(resource.RUSAGE_SELF).ru_utime


if __name__ == "__main__":
    main()
