"""Published problems: every known special point is found, with its label and error, and no other is."""

from __future__ import annotations

from pathlib import Path

import pytest
from peers.compare import judge
from peers.form import Study
from peers.running import peers, run_study

from contwalk.errors import ContwalkError

PEERS = peers()
# What a study that is known to lose something may end in: a complaint, a warning that leaks, a run that ends.
LOSSES = (AssertionError, RuntimeWarning, ContwalkError)


def _cases():
    for name, peer in PEERS.items():
        for study in peer.studies:
            marks = [pytest.mark.slow] if study.slow or study.long else []
            if study.long:
                marks.append(pytest.mark.long)
            if study.lost:
                marks.append(pytest.mark.xfail(reason=study.lost, raises=LOSSES, strict=True))
            yield pytest.param(name, study, id=f"{name}-{study.name}", marks=marks)


@pytest.mark.parametrize(("problem", "study"), list(_cases()))
def test_a_published_problem(problem: str, study: Study, tmp_path: Path):
    verdict = judge(study, run_study(problem, study, tmp_path).branches)
    assert not verdict.complaints, "\n".join(verdict.complaints)


def test_there_are_enough_and_each_value_names_its_source():
    values = [value for peer in PEERS.values() for study in peer.studies for value in study.values]
    assert len(PEERS) >= 25
    assert sum(value.times for value in values) >= 120
    assert all(value.source and 0.0 <= value.rel < 1e-3 for value in values)
    assert all(peer.source for peer in PEERS.values())
