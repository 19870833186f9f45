"""The size of a guard at the steps, which the end of a family asks for at each point, from the samples."""

import numpy as np
import pytest
from hybrid_machines import CASES, orbit

from contwalk.problems.hybrid.vanishing import reach


@pytest.mark.parametrize("name", list(CASES))
def test_the_samples_at_the_steps_tell_what_the_guard_alone_tells_there(name):
    problem, z = orbit(name)
    for leg, transition in problem.events:
        (view,) = problem.pieces_of(z, leg)
        alone = np.abs(view.guard_values(transition)).max()
        assert reach(problem, z, leg) == pytest.approx(alone, rel=1e-12)
