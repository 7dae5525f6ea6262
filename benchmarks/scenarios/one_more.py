# SPDX-License-Identifier: Apache-2.0
"""The cost of one more subscription, advertisement and connection, to the gateway and to a node.

`gateway.config.limits` takes its defaults from here.
"""

import contextlib
import json
import time
from collections.abc import Callable, Iterator
from typing import Final

from benchmarks.actors.connection import RawConnection
from benchmarks.figures import Figure
from benchmarks.plan import Plan
from benchmarks.processes import Process, cpu_s, memory_mb
from benchmarks.receivers import publishing
from benchmarks.servers import MeasuredServer

_Opening = Callable[[str], contextlib.AbstractContextManager[int]]
"""Opens them at a URL, and yields how many."""

_SCENARIO: Final = "one-more"
_TOPICS: Final = 300
_CONNECTIONS: Final = 100
_SETTLED_S: Final = 3.0
_SECONDS: Final = 10.0
_ROOM: Final = {
    "max_clients": 1000,
    "max_clients_per_address": 1000,
    "max_subscriptions": 2000,
    "max_advertisements": 2000,
    "max_ros_entities": 8000,
    "client_time_share": 1,
    "address_time_share": 1,
}


def measure(plan: Plan) -> list[Figure]:
    """Print a table and return the figures."""
    print(f"{_TOPICS} topics of one client, {_CONNECTIONS} connections: memory and time of each")
    print(f"  {'':16}{'':16}{'KB':>7}{'ms to open':>12}{'% of a core':>13}{'KB in a node':>14}")
    return [
        figure
        for server in plan.servers
        for kind, open_all in (
            ("subscription", _subscriptions),
            ("advertisement", _advertisements),
            ("connection", _connections),
        )
        for figure in _measure(server, kind, open_all)
    ]


def _measure(server: MeasuredServer, kind: str, open_all: _Opening) -> list[Figure]:
    # a node of another process, as a robot has many: it learns of every endpoint of the gateway
    with publishing("twist") as node, server.running(_ROOM) as (url, process):
        with _client(url):
            time.sleep(_SETTLED_S)
        before_kb, node_before_kb = _kb(process), _kb(node)
        spent_s = cpu_s(process.pid)
        with open_all(url) as count:
            time.sleep(_SETTLED_S)
            open_ms = (cpu_s(process.pid) - spent_s) / count * 1e3
            idle_s, started_s = cpu_s(process.pid), time.monotonic()
            time.sleep(_SECONDS)
            share = (cpu_s(process.pid) - idle_s) / (time.monotonic() - started_s) * 100
            each_kb = (_kb(process) - before_kb) / count
            node_kb = (_kb(node) - node_before_kb) / count
    print(
        f"  {server.name:16}{kind:16}{each_kb:7.1f}{open_ms:12.2f}{share:13.2f}{node_kb:14.1f}",
        flush=True,
    )
    name = f"{server.name}, {kind}"
    return [
        Figure(_SCENARIO, f"{name}, memory", each_kb, "KB"),
        Figure(_SCENARIO, f"{name}, to open", open_ms, "ms of CPU"),
        Figure(_SCENARIO, f"{name}, all of them silent", share, "% of a core"),
        Figure(_SCENARIO, f"{name}, memory of a node", node_kb, "KB"),
    ]


@contextlib.contextmanager
def _client(url: str) -> Iterator[RawConnection]:
    with RawConnection(url) as connection:
        _finish(connection)
        yield connection


def _finish(connection: RawConnection) -> None:
    """Wait until all that was sent is done."""
    connection.send({"op": "ping", "id": "end"})
    while True:
        for payload in connection.receive():
            if json.loads(bytes(payload)).get("op") == "pong":
                return


@contextlib.contextmanager
def _topics(url: str, op: str) -> Iterator[int]:
    with _client(url) as connection:
        for number in range(_TOPICS):
            connection.send({"op": op, "topic": f"/t{number}", "type": "nav_msgs/msg/Odometry"})
        _finish(connection)
        connection.answer_pings()
        yield _TOPICS


def _subscriptions(url: str) -> contextlib.AbstractContextManager[int]:
    return _topics(url, "subscribe")


def _advertisements(url: str) -> contextlib.AbstractContextManager[int]:
    return _topics(url, "advertise")


@contextlib.contextmanager
def _connections(url: str) -> Iterator[int]:
    with contextlib.ExitStack() as stack:
        for _ in range(_CONNECTIONS):
            stack.enter_context(_client(url)).answer_pings()
        yield _CONNECTIONS


def _kb(process: Process) -> float:
    return memory_mb(process.pid) * 1e3
