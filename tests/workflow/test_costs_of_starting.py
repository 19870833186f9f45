"""What a run does before its first point, and need not."""

import platform

from contwalk.workflow.machine import name_of_machine


def test_the_machine_is_named_as_the_standard_library_names_it():
    assert name_of_machine() == platform.platform()
