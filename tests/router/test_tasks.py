# SPDX-License-Identifier: Apache-2.0
import pytest

from tests.clock import StoppedClock
from tests.router.conftest import LIMITS, Bench


async def test_who_waits_for_a_turn_to_ask_a_node_is_told_after_10_s(
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
    assert client.statuses == [
        ("timeout", f"{LIMITS.max_pending_calls} other calls of this client are still under way")
    ]
