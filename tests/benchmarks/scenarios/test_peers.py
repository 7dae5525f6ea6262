# SPDX-License-Identifier: Apache-2.0
"""A missing foxglove-sdk is said with the command that installs it, before anything starts."""

import contextlib
import importlib.util

import pytest

from benchmarks.errors import BenchmarkError
from benchmarks.plan import Plan
from benchmarks.scenarios import peers
from benchmarks.servers import MeasuredServer

PLAN = Plan(rounds=1, seconds=1.0, servers=(MeasuredServer(),))


@pytest.fixture(autouse=True)
def nothing_is_measured(monkeypatch):
    def service(_publisher, _name, form, *_):
        return peers.Service(40.0 if form == peers.FOXGLOVE else 20.0, 1.0, 2.0, 1.0)

    monkeypatch.setattr(peers, "publishing", lambda *_: contextlib.nullcontext())
    monkeypatch.setattr(peers, "_service", service)


@pytest.mark.parametrize("is_installed", [False, True])
def test_the_peer_must_be_installed(monkeypatch, is_installed):
    monkeypatch.setattr(importlib.util, "find_spec", lambda _: is_installed or None)
    if not is_installed:
        with pytest.raises(BenchmarkError, match=r"run .*--group peers"):
            peers.measure(PLAN)
        return
    ratios = {one.name: one.value for one in peers.measure(PLAN) if one.is_ratio}
    assert ratios["odometry to 200, JSON, CPU beside foxglove's"] == 0.5
    assert len(ratios) == 4 * 4  # three kinds as CDR, and JSON
