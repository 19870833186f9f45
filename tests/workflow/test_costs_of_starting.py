"""What a run does before its first point, and need not."""

import platform
import subprocess
import sys
from importlib.metadata import version

from contwalk.version import version_of
from contwalk.workflow.machine import name_of_machine


def test_the_machine_is_named_as_the_standard_library_names_it():
    assert name_of_machine() == platform.platform()


def test_versions_are_what_packages_say():
    assert version_of("numba") == version("numba")
    assert version_of("click") == version("click")


def test_a_run_loads_no_grammar_and_no_metadata():
    """Each is a fiftieth of a short study."""
    code = (
        "import sys, contwalk.workflow.runner, contwalk.workflow.machine\n"
        "print({'contwalk.equations.grammar', 'importlib.metadata', 'email'} & set(sys.modules))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "set()"


def test_numpy_is_loaded_without_what_no_orbit_needs():
    """Masked arrays and families of polynomials: a hundredth of a short study."""
    code = (
        "import sys, numpy as np\n"
        "from contwalk.problems.orbit import periodic_orbit\n"
        "from contwalk.problems.orbit.repeated_steps import repeating\n"
        "repeating([np.linspace(0.0, 1.0, 5)], 2)\n"
        "print({'numpy.ma', 'numpy.polynomial'} & set(sys.modules))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "set()"
