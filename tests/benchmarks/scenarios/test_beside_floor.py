# SPDX-License-Identifier: Apache-2.0
"""Large messages have times in ms, as the floor's time depends on malloc. Others have a ratio."""

import contextlib

import pytest

from benchmarks import figures
from benchmarks.catalogue import COMPARED
from benchmarks.plan import Plan
from benchmarks.receivers import Receipt
from benchmarks.samples import SAMPLES
from benchmarks.scenarios import beside_floor
from benchmarks.servers import MeasuredServer

LARGE = {"image", "image-1080p", "point-cloud", "point-cloud-raw"}
PLAN = Plan(rounds=1, seconds=1.0, servers=(MeasuredServer(),), seeks_highest_rates=False)


@pytest.fixture(autouse=True)
def nothing_is_measured(monkeypatch):
    def receipt(receiver, *_):
        return Receipt(30.0, 1.0, 2.0, 3.0, 4000.0 if receiver.name == "floor" else 2000.0, 80.0)

    monkeypatch.setattr(beside_floor, "publishing", lambda *_: contextlib.nullcontext())
    monkeypatch.setattr(beside_floor, "_receipt", receipt)
    monkeypatch.setattr(beside_floor, "encoder_share", lambda _: "")


@pytest.mark.parametrize("name", SAMPLES)
def test_large_messages_have_milliseconds_and_others_a_ratio(name, capsys):
    measured = beside_floor.measure(name, PLAN)
    [cpu] = [one for one in measured if one.name == "gateway, CPU"]
    ratios = [one.value for one in measured if one.is_ratio]
    table = capsys.readouterr().out
    if name in LARGE:
        assert (cpu.value, cpu.unit, ratios) == (2.0, "ms per message", [])
        assert "CPU ms" in table
        assert "ratio" not in table
    else:
        assert (cpu.value, cpu.unit, ratios) == (2000.0, "us per message", [0.5])
        assert "CPU us" in table
        assert "ratio" in table


def test_default_comparisons_have_stored_ratios():
    assert {one.scenario for one in figures.read("ref") if one.is_ratio} == set(COMPARED)
