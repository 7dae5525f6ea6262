# SPDX-License-Identifier: Apache-2.0
"""Services and actions of the recorded robot, once more: its replies, and its requests."""

import asyncio
import json
import struct
import time
from collections.abc import Callable
from functools import partial
from typing import Any, NamedTuple

import zenoh
from zenoh import ext

from gateway.codec.types import Types
from gateway.sources.zenoh.keys import DataKey, parse_key
from gateway.sources.zenoh.tokens import EndpointToken, parse_token
from tests.client import TIMEOUT_S, eventually
from tests.sources.zenoh.outside import DEFINITIONS, client
from tests.sources.zenoh.recordings import of_robot, recording, tokens

TYPES = Types(DEFINITIONS)
IDS = slice(4, 20)  # of goals, behind the header of CDR


class Call(NamedTuple):
    """A recorded request, and the reply to it."""

    key: DataKey
    request: bytes
    reply: bytes | None
    attachment: bytes

    @property
    def answer(self) -> Any:
        return self.read(self.reply or b"")

    def read_request(self, request: bytes) -> Any:
        return TYPES.get(f"{self.key.type_name}_Request").decode(request)

    def read(self, response: bytes) -> Any:
        return TYPES.get(f"{self.key.type_name}_Response").decode(response)


def calls(name: str, by: str) -> list[Call]:
    """Return the requests of the robot's nodes, or of those that asked them."""
    lines = recording(name)
    replies = {
        line["more"]["q"]: bytes.fromhex(line["payload"])
        for line in reversed(lines)  # the first counts
        if line["kind"] == "reply" and "q" in line["more"]
    }
    return [
        Call(
            parse_key(line["key"]),
            bytes.fromhex(line["payload"]),
            replies.get(line["more"]["q"]),
            bytes.fromhex(line["attachment"] or ""),
        )
        for line in lines
        if (line["kind"], line["by"]) == ("query", by)
        and "q" in line["more"]
        and line["key"][-1] != "*"
        and "/@adv/" not in line["key"]
    ]


class Callee:
    """The recorded node as a server: it answers what it was asked, as it did.

    Goals have other ids now. Feedback comes before the result of its goal.
    """

    def __init__(self, router: str, name: str) -> None:
        self._session = client(router)
        self.asked: list[tuple[Call, bytes, bytes]] = []  # with what came, and its attachment
        self._calls = calls(name, "us")
        self._new_ids: dict[bytes, bytes] = {}
        self._feedback = [
            line for line in of_robot(name, "put") if "/_action/feedback/" in line["key"]
        ]
        live = self._session.liveliness()
        self._kept: list[Any] = [live.declare_token(each) for each in tokens(name)]
        self._publishers: dict[str, Any] = {}
        for token in map(parse_token, tokens(name)):
            if not isinstance(token, EndpointToken):
                continue
            key = token.key.text
            if token.kind == "SS":
                answer = partial(self._answer, key)
                self._kept.append(self._session.declare_queryable(key, answer, complete=True))
            elif token.kind == "MP":
                # a plain one, which knows whether its subscriber has found it
                self._publishers[key] = self._session.declare_publisher(
                    key, congestion_control=zenoh.CongestionControl.BLOCK
                )

    def close(self) -> None:
        self._session.close()

    def _answer(self, key: str, query: Any) -> None:
        request, attachment = query.payload.to_bytes(), query.attachment.to_bytes()
        same = (
            each for each in self._calls if each.key.text == key and self._is_same(each, request)
        )
        call = next(same, None)
        if call is None:
            query.drop()
            return
        self._calls.remove(call)
        self.asked.append((call, request, attachment))
        if key.endswith("GetResult_/" + call.key.type_hash):
            self._publish(call.request[IDS], request[IDS])
        assert call.reply is not None
        reply = call.reply.replace(call.request[IDS], request[IDS])
        number, _, size, gid = struct.unpack("<qqB16s", attachment)
        stamped = struct.pack("<qqB16s", number, time.time_ns(), size, gid)
        query.reply(key, reply, attachment=stamped)
        query.drop()

    def _is_same(self, call: Call, request: bytes) -> bool:
        if "/_action/" not in call.key.name:
            return bool(call.read_request(call.request) == call.read_request(request))
        if call.key.name.endswith("send_goal"):
            if call.request[20:] != request[20:]:
                return False
            self._new_ids[call.request[IDS]] = request[IDS]
        return self._new_ids.get(call.request[IDS]) == request[IDS]

    def _publish(self, recorded: bytes, new: bytes) -> None:
        for line in self._feedback:
            payload, attachment = (bytes.fromhex(line[each]) for each in ("payload", "attachment"))
            if payload[IDS] == recorded:
                publisher = self._publishers[line["key"]]
                end_s = time.monotonic() + TIMEOUT_S
                while not publisher.matching_status.matching and time.monotonic() < end_s:
                    time.sleep(0.01)  # on a thread of Zenoh
                publisher.put(payload.replace(recorded, new), attachment=attachment)


class Caller:
    """The recorded node as a client: it asks what it asked."""

    def __init__(self, router: str, name: str) -> None:
        self.router = router
        self._session = client(router)
        live = self._session.liveliness()
        self._kept: list[Any] = [live.declare_token(each) for each in tokens(name)]

    def subscribe(self, key: str, on_sample: Callable[[bytes], None]) -> None:
        loop = asyncio.get_running_loop()

        def arrive(sample: Any) -> None:
            loop.call_soon_threadsafe(on_sample, sample.payload.to_bytes())

        self._kept.append(ext.declare_advanced_subscriber(self._session, key, arrive))

    async def ask(self, call: Call) -> Any:
        """Send a request as it was recorded. Return the reply decoded, or None without one."""
        loop, answers = asyncio.get_running_loop(), asyncio.Queue[bytes | None]()

        def arrive(reply: Any) -> None:
            cdr = None
            if reply.ok is not None:
                cdr = reply.ok.payload.to_bytes()
                recorded, got = call.attachment, reply.ok.attachment.to_bytes()
                assert (got[:8], got[16:]) == (recorded[:8], recorded[16:])
            loop.call_soon_threadsafe(answers.put_nowait, cdr)

        def over() -> None:
            loop.call_soon_threadsafe(answers.put_nowait, None)

        querier = self._session.declare_querier(
            call.key.text,
            target=zenoh.QueryTarget.ALL_COMPLETE,
            consolidation=zenoh.ConsolidationMode.NONE,
            timeout=600.0,
        )
        await eventually(lambda: bool(querier.matching_status.matching))
        handler = zenoh.handlers.Callback(arrive, over)
        querier.get(handler, payload=call.request, attachment=call.attachment or None)
        answer = await answers.get()
        return None if answer is None else call.read(answer)

    def close(self) -> None:
        self._session.close()


def decoded(name: str, before: str) -> list[Any]:
    """Return what was read of the recorded replies when they were recorded."""
    notes = [line["note"] for line in recording(name) if line["kind"] == "event"]
    return [json.loads(each.split(":", 1)[1]) for each in notes if each.startswith(before)]
