"""`contwalk tradeoff`: the table, the files, and what is refused before anything runs."""

from __future__ import annotations

import pytest


@pytest.fixture
def following(folder):
    """The run file of the fork with its branch point followed."""
    text = (folder / "run.yaml").read_text(encoding="utf-8")
    (folder / "run.yaml").write_text(
        text.replace("diagram: none", "diagram: {follow: [BP]}"), encoding="utf-8"
    )
    return "run.yaml"


def test_table_recommendation_and_files(contwalk, following, folder):
    done = contwalk("tradeoff", following, "--accuracies", "1e-4,1e-8", "--methods", "auto")
    assert done.code == 0
    lines = done.out.splitlines()
    assert lines[0].split()[:3] == ["accuracy", "method", "CPU"]
    assert [line.split()[:2] for line in lines[1:3]] == [["0.0001", "auto"], ["1e-08", "auto"]]
    assert "Truth: 1 point at accuracy 1e-10, recomputed by 40 digits" in done.out
    assert "The cheapest setting that met the run file's accuracy of 1e-08" in done.out
    assert (folder / "fork_tradeoff.csv").exists()
    assert (folder / "fork_tradeoff.png").exists()
    assert not (folder / "fork.h5").exists()  # databases are temporary
    again = contwalk("tradeoff", following, "--accuracies", "1e-4", "--methods", "auto")
    assert again.code == 2
    assert "fork_tradeoff.csv exists" in again.err


def test_quiet_and_without_figures(contwalk, following, folder):
    done = contwalk(
        "tradeoff", following, "--accuracies", "1e-4", "--methods", "auto", "--quiet", "--no-figures"
    )
    assert (done.code, done.out, done.err) == (0, "", "")
    assert not (folder / "fork_tradeoff.png").exists()


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("--accuracies", "tight"), "is not a list of numbers"),
        (("--accuracies", "0"), "is not possible"),
        (("--accuracies", "nan"), "is not possible"),
        (("--methods", "dopri853"), "Did you mean 'dop853'?"),
        (("--set", "start={equilibrium: nowhere}"), "nowhere"),
    ],
)
def test_bad_input(contwalk, following, folder, arguments, said):
    done = contwalk("tradeoff", following, *arguments)
    assert done.code == 2
    assert said in done.err
    assert not (folder / "fork_tradeoff.csv").exists()


def test_a_folder_that_takes_no_file_is_refused_before_anything_is_computed(contwalk, following):
    done = contwalk("tradeoff", "run.yaml", "--output", "/proc/x.h5")
    assert done.code == 2
    assert "/proc/x_tradeoff.csv cannot be created" in done.err
