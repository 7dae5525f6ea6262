# SPDX-License-Identifier: Apache-2.0
"""Messages of relays at a robot: operations, stops, commands and tokens."""

import asyncio
import json
import logging

from gateway.access.permissions import UNLIMITED
from gateway.config.control import ControlConfig
from gateway.core.router import Router
from gateway.sources.zenoh.driving_wire import (
    read_beat,
    read_command,
    read_operation,
    read_stop,
    read_told,
)
from gateway.sources.zenoh.keys import WireError
from gateway.uplink.driving import RemoteDrivers
from tests.fuzz import types
from tests.fuzz.choices import Choices
from tests.fuzz.gateway_in_memory import LIMITS, TABLE, Inline, Log
from tests.fuzz.target import Target, check
from tests.sources.fake import FakeRos
from tests.sources.fake_guard import FakeGuard

CLIENT = "a1/1"
COMMAND = {
    "epoch": 1,
    "number": 1,
    "beat_ns": 1,
    "topic": "/cmd_vel",
    "type": "geometry_msgs/msg/Twist",
    "values": [0.2, 0, 0, 0, 0, 0],
    "frame_id": "x",
    "monotonic_ms": 1,
    "waited_ms": 3,
    "is_behind": True,
    "wants_answer": True,
}
OPERATION = {
    "op": "advertise",
    "client": CLIENT,
    "number": 1,
    "name": "n",
    "address": "a",
    "topic": "/cmd_vel",
    "type": "geometry_msgs/msg/Twist",
}
TOLD = {
    "epoch": 1,
    "time_ns": 1,
    "topics": [{"topic": "/cmd_vel", "holder": CLIENT, "members": {"state": "stopped"}}],
    "events": [{"what": "refusal", "number": 1, "code": "tripped", "text": "t"}],
}


def run(data: bytes) -> None:
    choices = Choices(data)
    if choices.happens(64):
        read_all(choices.rest())
        return
    asyncio.run(talk(choices))


def read_all(data: bytes) -> None:
    """Read bytes as each kind of message: they are read, or refused in one way."""
    for read in (read_beat, read_command, read_operation, read_stop, read_told):
        try:
            message = read(data)
        except WireError as error:
            check(str(error) and len(str(error)) <= 200, error)
        else:
            check(read(message.packed) == message, message)


async def talk(choices: Choices) -> None:
    """Send some messages to a robot. Each is answered or left out, and every stop stops."""
    log, logger = Log(), logging.getLogger("gateway")
    logger.addHandler(log)
    told: list[bytes] = []
    router = Router(
        FakeRos(guard=FakeGuard()),
        types.types(),
        TABLE,
        limits=LIMITS,
        workers=Inline(),
        version="fuzz",
        control=ControlConfig(),
    )
    drivers = RemoteDrivers(router, UNLIMITED, lambda _, data: told.append(data))
    try:
        while not choices.is_over:
            send(choices, drivers)
            await asyncio.sleep(0)
            drivers.tick()
        check(drivers.clients <= LIMITS.max_clients)
        for data in told:
            read_told(data)
        check(not log.faults, log.faults)
    finally:
        drivers.close()
        router.close()
        logger.removeHandler(log)


def send(choices: Choices, drivers: RemoteDrivers) -> None:
    key = choices.pick((f"x/{CLIENT}", f"x/{CLIENT}", "x", choices.octets().decode("latin-1")))
    match choices.byte() % 5:
        case 0:
            drivers.command(key, changed(choices, COMMAND | {"epoch": drivers.beat.epoch}))
        case 1:
            read_told(drivers.operate(changed(choices, OPERATION)))
        case 2:
            answer = read_told(drivers.stop(changed(choices, {"client": CLIENT, "number": 3})))
            check(answer.events, "a stop without an answer")
        case 3:
            drivers.follow_token(key, is_there=choices.happens(128))
        case 4:
            drivers.cut_off()


def changed(choices: Choices, fields: dict[str, object]) -> bytes:
    """Return a message, with some other fields, or other bytes."""
    if choices.happens(32):
        return choices.octets()
    fields = dict(fields)
    for _ in range(choices.below(3)):
        fields[choices.pick(sorted(fields))] = choices.pick(
            (None, "", "/cmd_vel", "no/Type", -1, 2**63, 1e308, [], {}, True, choices.text())
        )
    return json.dumps(fields).encode()


def corpus() -> list[bytes]:
    written = [json.dumps(each).encode() for each in (COMMAND, OPERATION, TOLD, {"topic": "/x"})]
    steps = b"".join(bytes((0, 0, kind, 0, 0)) for kind in (3, 1, 0, 2, 4))
    return [
        *(b"\xff" + text for text in written),
        b"\xff" + bytes(16),
        b"\0" + steps,
        b"\0" + steps * 4,
        *(b"\0" + bytes((0, 0, number % 5)) + bytes(range(number, 250, 9)) for number in range(20)),
    ]


TARGET = Target("relays and robots send anything, and every stop stops", run, corpus)
