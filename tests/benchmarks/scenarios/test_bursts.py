# SPDX-License-Identifier: Apache-2.0
"""Of each burst the server's report is compared with what is missing."""

import contextlib

import pytest

from benchmarks.plan import Plan
from benchmarks.scenarios import bursts
from benchmarks.servers import MeasuredServer


class Actor:
    """Answers orders from a table. A list is answered one by one."""

    def __init__(self, **answers):
        self.answers = answers

    def answer(self):
        return "ready"

    def ask(self, word, *_):
        answer = self.answers[word]
        return answer.pop(0) if isinstance(answer, list) else answer


@pytest.fixture
def measured(monkeypatch):
    def measure(*seen):
        publisher = Actor(matched=1, run={"sent": 10, "seconds": 0.002})
        client = Actor(count=1, clear=True, burst=list(seen))
        server = MeasuredServer()
        monkeypatch.setattr(bursts, "_SIZES", {"string": 10})
        monkeypatch.setattr(bursts, "_CALM_S", 0.0)
        monkeypatch.setattr(bursts, "publishing", lambda _: contextlib.nullcontext(publisher))
        monkeypatch.setattr(bursts, "acting", lambda *_: contextlib.nullcontext(client))
        running = contextlib.nullcontext(("ws://x", None))
        monkeypatch.setattr(MeasuredServer, "running", lambda _: running)
        found = bursts.measure(Plan(rounds=1, seconds=1.0, servers=(server,)))
        return {one.name.removeprefix("gateway, 10 of string, "): one.value for one in found}

    return measure


def burst(arrived, reported, took_ms=5.0):
    return {"distinct": arrived, "reported": reported, "took_ms": took_ms}


def test_reported_and_silent_losses_are_counted_apart(measured):
    assert measured(burst(10, 0), burst(4, 6), burst(7, 1, 9.0)) == {
        "arrived": 7,
        "least arrived": 4,
        "reported lost": 1,
        "most lost in silence": 2,
        "sending": 2,
        "time": 5,
    }


def test_a_server_that_reports_nothing_has_no_such_figures(measured, capsys):
    figures = measured(*[burst(10, None)] * 3)
    assert set(figures) == {"arrived", "least arrived", "sending", "time"}
    assert " - " in capsys.readouterr().out
