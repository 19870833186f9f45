"""A database is not continued with a plugin that has changed since."""

import pytest
from test_kill_and_resume import PLUGIN, RUN

from contwalk.errors import DatabaseError
from contwalk.workflow.run_file import read_run_file
from contwalk.workflow.runner import run


@pytest.mark.parametrize(
    ("old", "new"),
    [("p.mu * x[0]", "1.01 * p.mu * x[0]"), ('Parameter("mu", -0.5)', 'Parameter("mu", -0.4)')],
)
def test_a_changed_plugin_is_refused(tmp_path, old, new):
    (tmp_path / "fork.py").write_text(PLUGIN)
    (tmp_path / "run.yaml").write_text(RUN)
    output = str(tmp_path / "out.h5")
    run(read_run_file(tmp_path / "run.yaml", output=output))
    run(read_run_file(tmp_path / "run.yaml", output=output), resume=True)  # unchanged: nothing to do
    assert old in PLUGIN
    (tmp_path / "fork.py").write_text(PLUGIN.replace(old, new))
    with pytest.raises(DatabaseError, match="another version of the plugin"):
        run(read_run_file(tmp_path / "run.yaml", output=output), resume=True)
