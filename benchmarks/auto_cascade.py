"""The autobalancer's period doublings by AUTO-07p, for comparison; used by `cascade.py`.

AUTO is no part of contwalk. To have it (a Fortran compiler is needed):

    git clone https://github.com/auto-07p/auto-07p && cd auto-07p && ./configure && make
    CONTWALK_AUTO=/path/to/auto-07p python benchmarks/cascade.py

`auto_program.py` writes its equations from the plugin and starts it. Each stage is one start: balanced
equilibrium to the Hopf point, limit cycle to the first period doubling, and three times on to the next.
"""

from __future__ import annotations

import shutil
from dataclasses import dataclass
from pathlib import Path

from auto_program import built, equation_file, run

import contwalk as cw

HOPF, PERIOD_DOUBLING = "3", "7"  # types in AUTO's output


@dataclass(frozen=True)
class Setting:
    """Constants of AUTO; where there are four numbers, one for each cycle, from period T to period 8 T."""

    name: str
    intervals: tuple[int, int, int, int]  # NTST
    degree: int  # NCOL
    newton: float  # EPSL, EPSU
    location: float  # EPSS
    steps: tuple[float, float, float, float]  # DS
    largest_steps: tuple[float, float, float, float]  # DSMAX
    equilibrium_step: float = 1e-3
    adapt_every: int = 3  # IAD
    full_newton: int = 2  # NWTN
    weight: float = 1.0  # of delta in the arclength, THL


# The tuned ones came out of a random search over AUTO's constants for the least time at each accuracy of the
# answers below; such a search must know them, and with longer steps AUTO passes over period doublings without
# a word. `careful` is what one would choose without knowing.
SETTINGS = [
    Setting(
        *("AUTO, tuned to 1e-6", (6, 13, 20, 55), 4, 2.2e-9, 6.5e-5),
        *((0.0303, 0.0442, 0.00727, 0.00117), (0.0618, 0.672, 0.114, 0.164), 6.64e-4, 10),
    ),
    Setting(
        *("AUTO, tuned to 1e-8", (13, 13, 32, 64), 4, 1e-9, 3.2e-7),
        *((0.03, 0.0097, 0.0033, 0.0012), (0.062, 0.035, 0.15, 0.032), 3.3e-4, 5),
    ),
    Setting(
        *("AUTO, tuned to 7e-12", (10, 15, 29, 60), 6, 9.93e-10, 7.3e-10),
        *((0.0303, 0.00966, 0.00717, 0.00117), (0.117, 0.0634, 0.0879, 0.0321), 2.86e-4, 5, 2, 10.0),
    ),
    Setting(
        *("AUTO, careful", (20, 30, 50, 80), 6, 1e-10, 1e-11),
        *((0.01, 0.01, 0.005, 0.0012), (0.02, 0.02, 0.02, 0.02), 7e-4),
    ),
]


class Auto:
    """AUTO with the autobalancer's equations, ready to run in a folder."""

    def __init__(self, home: Path, folder: Path, delta: float) -> None:
        self.folder = folder
        built(home, folder, equations(delta))

    def cascade(self, setting: Setting) -> tuple[list[float], float]:
        """The parameter at the four period doublings, and CPU seconds of all five starts."""
        solution, seconds, found = None, 0.0, []
        for stage in range(5):
            label = HOPF if stage == 0 else PERIOD_DOUBLING
            spent, value = self._stage(constants(setting, stage), solution, label)
            seconds += spent
            found.append(value)
            solution = self.folder / f"solution{stage}"
            shutil.move(self.folder / "fort.8", solution)
        return found[1:], seconds

    def _stage(self, constants: str, solution: Path | None, label: str) -> tuple[float, float]:
        seconds, rows = run(self.folder, constants, solution)
        values = [row.value for row in rows if row.label == label]
        if not values:
            raise SystemExit(f"AUTO found no point of type {label} with these constants:\n{constants}")
        return seconds, values[-1]


def constants(setting: Setting, stage: int) -> str:
    """AUTO's constants file: stage 0 follows the equilibrium, stage k the cycle of period 2^(k - 1)."""
    cycle = max(stage - 1, 0)
    step = -setting.equilibrium_step if stage == 0 else setting.steps[cycle]
    largest = 4 * setting.equilibrium_step if stage == 0 else setting.largest_steps[cycle]
    start = ["0", "'HB1'", "'PD1'"][min(stage, 2)]
    return f"""NDIM= 8, IPS= {1 if stage == 0 else 2}, IRS= {start}, ILP= 0
ICP= {[1] if stage == 0 else [1, 11]}, ISP= 2, ISW= {1 if stage < 2 else -1}
NTST= {setting.intervals[cycle]}, NCOL= {setting.degree}, IAD= {setting.adapt_every}
IPLT= 0, NBC= 0, NINT= 0, NMX= 2000, NPR= 0, MXBF= 0, IID= 0, JAC= 1
ITMX= 12, ITNW= 8, NWTN= {setting.full_newton}
EPSL= {setting.newton}, EPSU= {setting.newton}, EPSS= {setting.location}
DS= {step}, DSMIN= 1e-7, DSMAX= {largest}, IADS= 1
NPAR= 11, THL= {{11: 0.0, 1: {setting.weight}}}, THU= {{}}
RL0= 0.0025, SP= ['{"HB1" if stage == 0 else "PD1"}']
"""


def equations(delta: float) -> str:
    """AUTO's equation file of the autobalancer with heavy correction masses; PAR(1) is delta."""
    system = cw.load_system("autobalancer", {"masses": 2})
    values = {**system.presets["heavy"], "delta": delta}
    return equation_file(system, values, ["delta"], system.named_states("balanced", values)[0])
