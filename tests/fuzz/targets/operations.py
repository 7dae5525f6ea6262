# SPDX-License-Identifier: Apache-2.0
"""Operations of two clients, in JSON that is right, nearly right, or missing."""

import json
import struct
from collections import Counter
from typing import Any, get_args

import cbor2

from gateway.codec.error_text import CodecError
from gateway.codec.json import loads
from gateway.core.errors import StatusCode
from gateway.core.peer import Peer
from gateway.fronts.rosbridge.front import RosbridgeFront
from gateway.fronts.rosbridge.operations.base import MAX_ID_CHARACTERS
from gateway.fronts.rosbridge.session import RosbridgeSession
from tests.fuzz import seeds
from tests.fuzz.gateway_in_memory import World, run_in_a_loop, turns
from tests.fuzz.stopwatch import STOPWATCH
from tests.fuzz.target import Target, check
from tests.wire import unpacked

CODES = frozenset(get_args(StatusCode)) - {"internal"}
OTHER_CLIENT = b"~"  # a line that begins with it is the other client's
CBOR = b"^"  # and what then begins with this is sent as CBOR
MAX_LINES = 24
ANSWERED_ONCE = {"call_service": "service_response", "send_action_goal": "action_result"}


class Client:
    """Sends frames, and looks at all that comes back."""

    def __init__(self, front: RosbridgeFront) -> None:
        self.front = front
        self.frames: list[Any] = []
        self.asked: Counter[tuple[str, object]] = Counter()
        self.is_flushing = False
        self.session: RosbridgeSession = front.open(
            # without a level some refusals are in the log alone
            Peer(wake=self.flush, address="127.0.0.1", level="warning")
        )

    def flush(self) -> None:
        if self.is_flushing:
            return
        self.is_flushing = True
        outbox = self.session.outbox
        while (batch := outbox.take(1 << 20)) or outbox.has_control:
            for wire in batch:
                self.frames += unpacked(wire)
        self.is_flushing = False

    def send(self, data: bytes, *, is_cbor: bool) -> None:
        refused, count = self.session.refused, len(self.frames)
        operation = read(data)
        if is_cbor and operation:
            data = cbor2.dumps(in_cbor(operation))
        op, request_id = operation.get("op"), operation.get("id")
        if isinstance(op, str) and is_id(request_id):
            self.asked[ANSWERED_ONCE.get(op, op), request_id] += 1
        with STOPWATCH.running():
            self.front.receive(self.session, data)
            self.front.core.end_turn(self.session)
        if self.session.refused > refused:
            answers = self.frames[count:]
            check(answers or self.is_silenced, "refused without an answer")
            if op != "fragment" and is_id(request_id) and not self.is_silenced:
                ids = [answer.get("id") for answer in answers]
                check(request_id in ids, "refused without its id", request_id, ids)

    @property
    def is_silenced(self) -> bool:
        """Whether the client has chosen not to see every refusal."""
        return not self.session._dialect.hears("warning")

    def check_frames(self) -> None:
        """See that each frame is one that the protocol has."""
        for frame in self.frames:
            check(isinstance(frame, dict) and isinstance(frame.get("op"), str), frame)
            if frame["op"] == "status" and "code" in frame:
                check(frame["code"] in CODES, "not a documented code", frame)
        for op in ANSWERED_ONCE.values():
            answers = Counter(
                frame["id"] for frame in self.frames if frame["op"] == op and "id" in frame
            )
            for request_id, count in answers.items():
                asked = self.asked[op, request_id]
                check(count <= asked or self.has_sent_pieces, "answered twice", request_id)

    @property
    def has_sent_pieces(self) -> bool:
        return any(op == "fragment" for op, _ in self.asked)


def read(data: bytes) -> dict[str, Any]:
    try:
        value = loads(data)
    except CodecError:
        return {}
    return value if isinstance(value, dict) else {}


def in_cbor(value: Any) -> Any:
    """Return JSON as a client may say it in CBOR: with octets, and with numbers in typed arrays."""
    match value:
        case dict():
            return {name: in_cbor(item) for name, item in value.items()}
        case [float(), *_] if all(type(item) is float for item in value):
            return cbor2.CBORTag(86, struct.pack(f"<{len(value)}d", *value))
        case [int(), *_] if all(type(item) is int and 0 <= item < 2**32 for item in value):
            return cbor2.CBORTag(70, struct.pack(f"<{len(value)}I", *value))
        case list():
            return list(map(in_cbor, value))
        case str() if value.startswith("\0"):
            return value.encode(errors="replace")
    return value


def is_id(value: object) -> bool:
    return type(value) is int or (isinstance(value, str) and len(value) <= MAX_ID_CHARACTERS)


def run(data: bytes) -> None:
    """Take each line as a frame."""

    async def talk(world: World) -> None:
        clients = [Client(world.front), Client(world.front)]
        for line in data.split(b"\n")[:MAX_LINES]:
            is_other = line.startswith(OTHER_CLIENT)
            text = line.removeprefix(OTHER_CLIENT)
            clients[is_other].send(text.removeprefix(CBOR), is_cbor=text.startswith(CBOR))
            world.publish()
            await turns()
        for client in clients:
            client.check_frames()
            world.router.leave(client.session)

    run_in_a_loop(talk)


def frame(op: str, **members: Any) -> bytes:
    return json.dumps({"op": op, **members}).encode()


def corpus() -> list[bytes]:
    several = [
        [
            frame("advertise_service", service="/arm", type="std_srvs/SetBool"),
            b"~" + frame("call_service", service="/arm", id=1, args=[True]),
            frame("service_response", service="/arm", id="service_request:/arm:1", values=3),
        ],
        [
            frame("subscribe", topic="/camera", image={"max_fps": 5}, id="a", throttle_rate=9),
            frame("subscribe", topic="/camera", compression="cbor", id="b", queue_length=1),
            frame("unsubscribe", topic="/camera", id="a"),
        ],
        [
            frame("subscribe", topic="/odom", compression="cbor-raw", meta=True),
            b"~" + frame("subscribe", topic="/odom", compression="png", fragment_size=64),
        ],
        [
            frame("send_action_goal", action="/fib", id="g", args={"order": 3}, feedback=True),
            frame("cancel_action_goal", action="/fib", id="g"),
        ],
        [
            CBOR
            + frame("publish", topic="/s", type="sensor_msgs/LaserScan", msg={"ranges": [0.5]}),
            CBOR + frame("publish", topic="/p", type="std_msgs/String", msg={"data": "\0octets"}),
            CBOR + frame("ping", value=["\0octets", [1, 2]], id=1),
            CBOR + frame("call_service", service="/arm", id=2, args="\0octets"),
        ],
    ]
    return [b"\n".join(lines) for lines in [*seeds.conversations(), *several]]


TARGET = Target("each operation is answered as documented, and nothing stays behind", run, corpus)
