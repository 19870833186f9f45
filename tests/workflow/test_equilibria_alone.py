"""A study of equilibria loads nothing of orbits: their compiled flow takes as long as all the rest."""

import subprocess
import sys

STUDY = """
import sys
import contwalk as cw
found = cw.diagram(
    cw.system_from_text("x' = A - (B + 1)*x + x^2*y; y' = B*x - x^2*y; A = 1; B = 1.5"),
    "B", (1.0, 3.0), start={"x": 1.0, "y": 1.5}, diagram={"follow": []},
)
(hopf,) = (point for point in found["b1"].special_points if point.label == "HB")
assert hopf.criticality == "supercritical", hopf.criticality
loaded = {"contwalk.flow.compiled", "contwalk.flow.integrate", "contwalk.problems.orbit.monodromy"}
print(*sorted(loaded & set(sys.modules)))
"""


def test_a_hopf_point_and_its_coefficient_load_no_flow():
    told = subprocess.run([sys.executable, "-c", STUDY], capture_output=True, text=True, timeout=100)
    assert told.returncode == 0, told.stderr
    assert told.stdout.strip() == ""
