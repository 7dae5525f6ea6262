# SPDX-License-Identifier: Apache-2.0
import errno

import pytest

from tests.clock import StoppedClock
from tests.core.conftest import LIMITS, Bench


async def test_a_request_that_waits_for_its_turn_fails_after_10_s(
    bench: Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    list_parameters = "rcl_interfaces/srv/ListParameters"
    bench.ros.add_service("/n/list_parameters", list_parameters, lambda request: None, node="/n")
    clock = StoppedClock(monkeypatch)
    client = bench.client()
    for number in range(LIMITS.max_pending_calls + 1):
        client.send(op="list_parameters", id=number, node="/n", timeout=60)
    await bench.settle()
    await clock.advance(9.99)
    assert client.statuses == []
    await clock.advance(0.02)
    waiting = LIMITS.max_pending_calls
    text = f"{waiting} other calls of this client still wait for an answer: send fewer at once"
    assert client.statuses == [("timeout", text)]


async def test_a_client_spends_the_time_that_its_task_works_but_not_waits(bench: Bench):
    client = bench.client()
    spent_s: list[float] = []
    client.turns.spend = lambda seconds, now_s: spent_s.append(seconds) is None
    client.send(op="lookup_transform", id=1, target_frame="a", source_frame="b", timeout=0)
    await client.sees(1, "status")
    assert spent_s
    assert min(spent_s) > 0


async def test_a_task_that_is_cancelled_ends(bench: Bench):
    list_parameters = "rcl_interfaces/srv/ListParameters"
    bench.ros.add_service("/n/list_parameters", list_parameters, lambda request: None, node="/n")
    client = bench.sender(op="list_parameters", id=1, node="/n")
    await bench.settle()
    assert bench.router.counts()["calls"] == 1
    bench.router.leave(client.session)
    await bench.settle()
    assert bench.router.counts()["calls"] == 0


async def test_a_fault_of_the_machine_is_answered_without_its_paths(
    bench: Bench, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
):
    def none_left(*_: object) -> None:
        raise OSError(errno.EMFILE, "Too many open files", "/etc/secret")

    monkeypatch.setattr(bench.router._subscriptions, "subscribe", none_left)
    client = bench.sender(op="subscribe", id="s", topic="/t")
    assert client.statuses == [("internal", "the gateway's machine: too many open files")]
    assert "Traceback" not in caplog.text
    assert "secret" not in caplog.text
