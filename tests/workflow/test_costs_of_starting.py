"""What a run does before its first point, and need not: processes, and modules for a few numbers."""

import platform
import subprocess
import sys

from contwalk.workflow.machine import name_of_machine


def test_the_machine_is_named_as_the_standard_library_names_it():
    assert name_of_machine() == platform.platform()


def test_a_system_is_checked_at_load_without_random_numbers_of_numpy():
    code = (
        "import sys\n"
        "from contwalk.plugin_check.at_load import load_system\n"
        "load_system('autobalancer')\n"
        "assert 'numpy.random' not in sys.modules"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
