# SPDX-License-Identifier: Apache-2.0
"""Tokens, samples, and requests of Zenoh peers. Zenoh itself is left out."""

import contextlib
import itertools
from types import SimpleNamespace
from typing import Any
from unittest.mock import patch

from gateway.codec.types import Types
from gateway.sources.qos import MAX_QUEUE_DEPTH, adopt
from gateway.sources.source import Qos
from gateway.sources.zenoh import heard_publishers, token_changes, token_graph
from gateway.sources.zenoh.attachment import Attachment, read_attachment
from gateway.sources.zenoh.clock import RobotClock
from gateway.sources.zenoh.heard_publishers import SampleNumbers, UnlistedPublishers
from gateway.sources.zenoh.keys import WireError, parse_key
from gateway.sources.zenoh.replier import ZenohReplier
from gateway.sources.zenoh.requester import ZenohEndpoints
from gateway.sources.zenoh.service_forms import service_wire
from gateway.sources.zenoh.session import ZenohSession
from gateway.sources.zenoh.token_changes import TokenChanges
from gateway.sources.zenoh.token_graph import TokenGraph
from gateway.sources.zenoh.tokens import EndpointToken, NodeToken, parse_token
from schemas.installed import InstalledDefinitions
from tests.fuzz.choices import EDGES, LARGE_EDGES, Choices
from tests.fuzz.target import Target, check
from tests.sources.zenoh.recordings import NAMES, tokens

RECORDED = [token for name in NAMES for token in tokens(name)]
OWN = RECORDED[0].split("/")[2]
PARTS = (
    *("", "%", "%%", "$", "$*", "%a$b", "*", "**", "é", "%é", "\0", "a b", "x" * 300, "@ros2_lv"),
    *("%chatter", "0", "-1", "99999999999999999999999", "NN", "MP", "MS", "SS", "SC", "XX", "abc"),
    *("TypeHashNotSupported", f"RIHS01_{'0' * 64}", "RIHS01_", "std_msgs::msg::dds_::Int32_"),
    *("%fib%_action%send_goal", "test_msgs::action::dds_::Fibonacci_SendGoal_", "::", "/"),
    *("::,:,:,:,,", "1:1:2,99999999999999999999:9,9:9,9:3,9,9", ":::::", ":,::,:,:,,", "::,,:,"),
)
BOUNDS = {
    token_changes: "MAX_TOKENS",
    token_graph: "MAX_OF_NAME",
    heard_publishers: "MAX_PUBLISHERS",
}
LEAST = 3
WIRE = service_wire(Types(InstalledDefinitions()), "std_srvs/srv/SetBool")
LATER = SimpleNamespace(add_reader=lambda *_: None, remove_reader=lambda _: None)
DECLARED = SimpleNamespace(undeclare=lambda: None)
LIVELINESS = SimpleNamespace(declare_token=lambda _: DECLARED)


def run(data: bytes) -> None:
    choices = Choices(data)
    with contextlib.ExitStack() as stack:
        for module, bound in BOUNDS.items():
            stack.enter_context(patch.object(module, bound, LEAST + choices.below(9)))
        match choices.byte() % 3:
            case 0:
                declare(choices)
            case 1:
                publish(choices)
            case _:
                ask(choices)


def declare(choices: Choices) -> None:
    """Let tokens come and go, in any order and number."""
    graph = TokenGraph(OWN)
    changes: Any = TokenChanges(LATER, graph.apply)  # type: ignore[arg-type]
    came: dict[str, None] = {}
    with contextlib.closing(changes):
        while not choices.is_over:
            token = a_token(choices)
            check_token(token)
            came[token] = None
            changes.put(token, not choices.happens(64))
            if choices.happens(64):
                changes._deliver()
                check_graph(graph)
        for each in came:
            changes.put(each, False)
            changes._deliver()
        while changes._waiting:
            changes._deliver()
        whole = graph.whole()
        check(not any((whole.topics, whole.nodes, whole.services, whole.actions)), whole)
        check(not any((graph._places, graph._nodes, graph._publishers, graph._beyond)))
        check(not changes._known and not changes.left_out and not graph.is_humble)


def a_token(choices: Choices) -> str:
    parts = choices.pick(RECORDED).split("/")
    for _ in range(choices.below(4)):
        at = choices.below(len(parts) + 1)
        new = choices.text() if choices.happens(64) else choices.pick(PARTS)
        parts[at : at + choices.below(2)] = [new]
    return "/".join(parts)


def check_token(text: str) -> None:
    try:
        token = parse_token(text)
    except WireError as error:
        check(0 < len(str(error)) < 1000, "a long refusal", str(error)[:1000])
        return
    node = token if isinstance(token, NodeToken) else token.of
    check(parse_token(node.text) == node, node)
    if isinstance(token, EndpointToken):
        check(parse_key(token.key.text) == token.key, token)
        check(len(token.gid) == 16, token)


def check_graph(graph: TokenGraph) -> None:
    whole = graph.whole()
    for topic in whole.topics:
        offers = graph.offers(topic.name)
        check(len(offers) <= token_graph.MAX_OF_NAME, "too many publishers")
        check(0 < (adopt(Qos(), offers).depth or 0) <= MAX_QUEUE_DEPTH, offers)
        check(graph.topic_types(topic.name), topic)
    for service in whole.services:
        check(service.types and service.nodes, service)


def publish(choices: Choices) -> None:
    """Let samples come, with any attachment, some of them of ``/clock``."""
    numbers, unlisted, clock = SampleNumbers(), UnlistedPublishers(lambda _: False), RobotClock()
    while not choices.is_over:
        attachment = an_attachment(choices)
        try:
            number, source_ns, gid = read_attachment(attachment)
        except WireError as error:
            check(0 < len(str(error)) < 1000)
            continue
        check(min(number, source_ns) >= -(2**63) and len(gid) == 16)
        before = numbers.lost
        numbers.note(gid, number)
        check(0 <= numbers.lost - before <= heard_publishers.MAX_GAP, "too many are lost")
        unlisted.hear(gid)
        heard = max(len(numbers._next), len(unlisted._heard_s))
        check(heard <= heard_publishers.MAX_PUBLISHERS, "too many publishers")
        clock.hear([SimpleNamespace(cdr=choices.octets())])  # type: ignore[list-item]
        check(isinstance(clock.now_ns(), int))


def an_attachment(choices: Choices) -> bytes:
    if choices.happens(64):
        return choices.octets()
    number, source_ns = (choices.pick((*EDGES, *LARGE_EDGES)) for _ in range(2))
    gid = bytes([choices.byte()]) * 16
    fits = all(-(2**63) <= each < 2**63 for each in (number, source_ns))
    packed = Attachment(number, source_ns, gid).packed if fits else b"\xff" * 33
    return packed[: choices.pick((33, 33, 33, 32, 9))]


def ask(choices: Choices) -> None:
    """Let requests come, which are read and answered, or dropped, once."""
    calls: list[Any] = []
    session: Any = SimpleNamespace(
        info=SimpleNamespace(zid=lambda: OWN),
        liveliness=lambda: LIVELINESS,
        declare_queryable=lambda _, arrive, complete: calls.append(arrive) or DECLARED,
    )
    owner = ZenohSession(session, 0)
    owner.add_node("/n")
    waiting: list[Any] = []
    direct = SimpleNamespace(
        put=waiting.append, send=lambda _, __, send: send(), finish=lambda withdraw: withdraw()
    )
    parts: Any = (owner, "/n", TokenGraph(OWN), direct, direct, None)
    heard: list[Any] = []
    replier = ZenohReplier(
        ZenohEndpoints(*parts), WIRE, "/s", lambda *each: heard.append(each), subject="service /s"
    )
    queries = []
    while not choices.is_over:
        query = Query(choices)
        queries.append(query)
        calls[0](query)
        while waiting and choices.happens(128):
            waiting.pop(0)()
        for _, reply in heard if choices.happens(128) else ():
            reply(b"\0\1\0\0\0\0\0\0\1\0\0\0\0")
    for call in itertools.takewhile(callable, (waiting.pop(0) for _ in iter(waiting.__len__, 0))):
        call()
    for request, _ in heard:
        WIRE.read_request(request)
    replier.close()
    check(all(each.drops == 1 for each in queries), "a query is dropped once")
    check(all(each.replies <= 1 for each in queries), "a query is answered once")


class Query:
    """A query of a peer, which counts what becomes of it."""

    def __init__(self, choices: Choices) -> None:
        self.payload = choices.pick((None, Bytes(b"\0\1\0\0\1"), Bytes(choices.octets())))
        self.attachment = choices.pick((None, Bytes(an_attachment(choices))))
        self.drops = self.replies = 0

    def drop(self) -> None:
        self.drops += 1

    def reply(self, *_: object, **__: object) -> None:
        self.replies += 1


class Bytes(bytes):
    """Bytes as Zenoh has them."""

    def to_bytes(self) -> bytes:  # type: ignore[override]
        return bytes(self)


def corpus() -> list[bytes]:
    bounds = bytes(3)
    return [
        b"",
        bounds + b"\0" + bytes(range(0, 250, 5)) * 3,
        bounds + b"\0" + b"\7\1\5\0\0\0" * 20,
        bounds + b"\1" + b"\0\1\1\7\0\4\0\1\0\0" * 8,
        bounds + b"\2" + b"\1\2\0\1\0\1\1\5\0\xff\xff" * 8,
    ]


TARGET = Target(
    "the gateway reads or leaves out all that a Zenoh peer sends, and nothing grows", run, corpus
)
