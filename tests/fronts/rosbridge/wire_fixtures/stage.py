# SPDX-License-Identifier: Apache-2.0
"""The gateway between scripted clients and a scripted robot, with all its clocks stopped."""

import asyncio
import base64
import contextlib
import itertools
import json
import secrets
import tempfile
import time
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from functools import partial
from pathlib import Path
from typing import Any, Final, cast
from unittest import mock

import cbor2
from websockets.datastructures import Headers
from websockets.http11 import Request as HttpRequest
from websockets.http11 import Response
from websockets.server import ServerProtocol

from gateway.access.audit import Audit
from gateway.access.authentication import Authentication
from gateway.access.permissions import UNLIMITED, Identity, Policy
from gateway.access.tokens import Token, Tokens, digest_of
from gateway.access.web_rules import WebRules
from gateway.config.access import AccessConfig, Role, ViewerConfig
from gateway.core.errors import Level
from gateway.core.introspection import assets
from gateway.core.topics.slices import Slices
from gateway.drive.effects import GuardState
from gateway.fronts.pictures.front import Pictures
from gateway.fronts.rosbridge.session import RosbridgeSession
from gateway.sources.actions import GoalOutcome, GoalRequest
from gateway.sources.source import Qos, Sample
from gateway.transport.admission import Admission
from gateway.transport.front import HttpSession
from gateway.transport.http_connection import HttpConnection
from tests.core.conftest import Bench, Socketless, open_bench
from tests.fronts.rosbridge.wire_fixtures.text import OPENCV, shortened, shown, shown_bytes
from tests.sources.fake import FakePublisher
from tests.sources.fake_guard import FakeGuard
from tests.wire import websocket_frames

FILES: Final = sorted(Path(__file__).parent.glob("*.txt"))

_TURNS: Final = 40  # of the event loop until everything has happened that needs no time
_STEP_S: Final = 0.01

# of a viewer and an operator who have tokens, and a viewer who sees little
_ACCESS: Final = AccessConfig(
    authentication="token",
    viewer=ViewerConfig(deny_subscribe=("/secret/**", "/tf"), call=("/rosapi/**", "/seen")),
)
_TOKENS: Final = Tokens(
    tuple(
        Token(
            name=name, role=cast("Role", role), created="2026-01-01", sha256=digest_of(name).hex()
        )
        for name, role in [("wall", "viewer"), ("tablet", "operator")]
    )
)


class Clock:
    """All clocks of Python, which stand still between the steps of a conversation."""

    def __init__(self) -> None:
        self.now_ns = 1_700_000_000_000_000_000

    def s(self) -> float:
        return self.now_ns / 1e9

    def ns(self) -> int:
        return self.now_ns


def _at_once(_: object, work: Callable[..., Any], *arguments: Any, **named: Any) -> Future[Any]:
    """Do the work of a thread without the thread."""
    future: Future[Any] = Future()
    try:
        future.set_result(work(*arguments, **named))
    except Exception as error:  # noqa: BLE001  # whoever waits for it gets it
        future.set_exception(error)
    return future


@contextlib.contextmanager
def determined(clock: Clock) -> Iterator[None]:
    """Let nothing depend on time, threads, chance, or the packages that are installed here."""
    numbers = itertools.count(1)
    with contextlib.ExitStack() as patches, tempfile.TemporaryDirectory() as prefix:
        meshes = Path(prefix, "share", "arm", "meshes")
        meshes.mkdir(parents=True)
        (meshes / "cube.stl").write_bytes(b"solid cube\nendsolid cube\n")
        (meshes.parent / "package.xml").write_text("<package><name>arm</name></package>")
        for target, name, value in (
            *((time, name, clock.s) for name in ("time", "monotonic", "thread_time")),
            *((time, name, clock.ns) for name in ("time_ns", "monotonic_ns")),
            (Slices.__init__, "__defaults__", (clock.ns,)),
            (secrets, "token_hex", lambda _: f"{next(numbers):016x}"),
            (ThreadPoolExecutor, "submit", _at_once),
            (assets, "installed_prefixes", lambda: (Path(prefix),)),
        ):
            patches.enter_context(mock.patch.object(target, name, value))
        yield


def replay(script: str) -> str:
    """Carry out a conversation, and return it with what the gateway sends now."""
    clock = Clock()
    with determined(clock):
        return asyncio.run(_replay(script, clock))


async def _replay(script: str, clock: Clock) -> str:
    guard = FakeGuard()
    async with open_bench(guard=guard) as bench:
        stage = Stage(bench, guard, clock)
        for line in script.split("\n"):
            await stage.play(line)
    return "\n".join(stage.lines)


class Viewing:
    """A connection that asks for images over HTTP."""

    is_paused = awaits_page = is_encrypted = False
    address = name = "127.0.0.1"

    def __init__(self, write: Callable[[bytes], None]) -> None:
        self.write = write

    def answer(self, response: Response) -> None:
        self.write(response.serialize())

    def show(self, viewer: HttpSession) -> None:
        self.viewer = viewer


class Entering:
    """A connection of a client that has to show a token."""

    is_encrypted = False
    address = name = "127.0.0.1"

    def __init__(self, client: Socketless, note: Callable[[str], None]) -> None:
        self._client = client
        self._note = note

    @property
    def session(self) -> RosbridgeSession:
        return self._client.session

    def close(self, code: int, reason: str) -> None:
        self._note(f"closed {code} {reason}")

    def limit_messages(self, max_bytes: int) -> None:
        self._note(f"reads at most {max_bytes} bytes")


class Stage:
    """The clients, the robot, and what everybody gets. Each ``do_`` is a verb of the scripts."""

    def __init__(self, bench: Bench, guard: FakeGuard, clock: Clock) -> None:
        self.bench = bench
        self.guard = guard
        self.clock = clock
        self.lines: list[str] = []
        self.got: list[str] = []  # since the last turn
        self.waiting_s = 0.0
        self.clients: dict[str, Socketless] = {}
        self.goals: dict[str, GoalRequest] = {}
        self.pictures = Pictures(bench.router)
        authentication = Authentication(_TOKENS, Policy(_ACCESS), None)
        audit = Audit(time.time_ns, lambda line: None)
        rules = WebRules(own_names=frozenset())
        self.admission = Admission(authentication, _ACCESS, audit, lambda _: None, rules)

    async def play(self, line: str) -> None:
        name, sent, text = line.partition(">")
        if line.startswith("# OpenCV"):
            self.lines.append(OPENCV)
        elif line.startswith("!"):
            self.lines.append(line)
            verb, *arguments = line[1:].split(maxsplit=3)
            getattr(self, f"do_{verb}")(*arguments)
        elif sent and name in self.clients:
            self.lines.append(line)
            self.clients[name].send_raw(_bytes(text))
        elif not line or line.startswith("#"):
            self.lines.append(line)
        else:
            assert "<" in line, line
            return
        await self.settle()

    async def settle(self) -> None:
        await self._turn()
        while self.waiting_s > 0:
            step_s = min(_STEP_S, self.waiting_s)
            self.waiting_s -= step_s
            self.clock.now_ns += round(step_s * 1e9)
            self.bench.ros.now += round(step_s * 1e9)
            await self._turn()

    async def _turn(self) -> None:
        """Let all happen that needs no time. The order in which it reaches two clients is open."""
        for _ in range(_TURNS):
            await asyncio.sleep(0)
        self.lines += sorted(self.got, key=lambda line: line.partition("<")[0])
        self.got.clear()

    def note(self, name: str, text: str) -> None:
        self.got.append(f"{name}< {shortened(text)}")

    def values(self, type_name: str, cdr: bytes) -> str:
        """Return a message that others in ROS get."""
        return json.dumps(self.bench.types.get(type_name).decode(cdr))

    def cdr(self, type_name: str, text: str) -> bytes:
        return self.bench.cdr(type_name, **json.loads(text))

    # clients

    def do_client(self, name: str, level: str = "warning", role: str = "admin") -> None:
        """Connect: ``rosbridge`` is a level, and ``nobody`` has yet to send a token."""
        identity: Identity | None = UNLIMITED
        if role != "admin":
            is_known = role != "nobody"
            permissions = Policy(_ACCESS).of(cast("Role", role)) if is_known else None
            identity = None if permissions is None else Identity(role, permissions)
        wanted = None if level == "rosbridge" else cast("Level", level)
        self.clients[name] = Recorded(self, name, identity, wanted)

    def do_leave(self, name: str) -> None:
        self.bench.router.leave(self.clients.pop(name).session)

    def do_pause(self, name: str) -> None:
        self.clients[name].is_paused = True

    def do_resume(self, name: str) -> None:
        self.clients[name].is_paused = False
        self.clients[name].flush()

    def do_turn(self, name: str) -> None:
        self.bench.router.end_turn(self.clients[name].session)

    def do_sent(self, name: str, frame: str, count: str) -> None:
        """Send a long frame: its X stands for *count* of them."""
        self.clients[name].send_raw(frame.replace("X", "x" * int(count)).encode())

    def do_get(self, target: str, method: str = "GET", role: str = "admin") -> None:
        """Ask for images over HTTP."""
        viewing = Viewing(lambda data: self.note(target, shown_bytes(data)))
        identity = Identity(role, Policy(_ACCESS).of(cast("Role", role)))
        asked = HttpRequest(target, Headers(Host="127.0.0.1"), method=method)
        answer = self.pictures.respond(
            ServerProtocol(), asked, cast("HttpConnection", viewing), identity, "127.0.0.1"
        )
        if answer is not None:
            viewing.answer(answer)

    # the robot

    def do_wait(self, seconds: str) -> None:
        self.waiting_s = float(seconds)

    def do_guard(self, state: str) -> None:
        self.guard.report(cast("GuardState", state))

    def do_publisher(self, topic: str, type_name: str, qos: str = "{}") -> None:
        self.bench.ros.add_publisher(topic, type_name, Qos(**json.loads(qos)))

    def do_publish(self, topic: str, *values: str) -> None:
        publisher = self._publisher(topic)
        publisher.publish(self.cdr(publisher.type_name, " ".join(values)))

    def do_repeated(self, topic: str, count: str) -> None:
        """Publish a long array."""
        data = base64.b64encode(bytes(range(250)) * (int(count) // 250)).decode()
        self.do_publish(topic, json.dumps({"data": data}))

    def do_cdr(self, topic: str, data: str) -> None:
        self._publisher(topic).publish(bytes.fromhex(data))

    def do_gone(self, topic: str) -> None:
        self._publisher(topic).close()

    def _publisher(self, topic: str) -> FakePublisher:
        return next(
            p for p in self.bench.ros.publishers if (p.topic, p.node) == (topic, "/outside")
        )

    def do_listen(self, topic: str, type_name: str, qos: str = "{}") -> None:
        def note(samples: "list[Sample] | Any") -> None:
            for sample in samples:
                self.note(topic, self.values(type_name, sample.cdr))

        self.bench.ros.add_subscription(topic, type_name, note, Qos(**json.loads(qos)))

    def do_service(self, name: str, type_name: str, response: str = "") -> None:
        """Provide a service that gives this response. Without one it never answers."""

        def respond(request: Any) -> None:
            self.note(name, self.values(f"{type_name}_Request", request.cdr))
            if response:
                request.answer(self.cdr(f"{type_name}_Response", response))

        self.bench.ros.add_service(name, type_name, respond)

    def do_vanish(self, name: str) -> None:
        """End a service or an action."""
        for each in [*self.bench.ros.service_servers, *self.bench.ros.action_servers]:
            if (each.name, each.node) == (name, "/outside"):
                each.close()

    def do_call(self, name: str, type_name: str, request: str) -> None:
        call = self.bench.ros.add_client(name, type_name).call
        work = call(self.cdr(f"{type_name}_Request", request))
        self._note_later(name, work, lambda cdr: self.values(f"{type_name}_Response", cdr))

    def _note_later(self, name: str, work: Any, text: Callable[[Any], str]) -> None:
        async def note() -> None:
            try:
                self.note(name, text(await work))
            except Exception as error:  # noqa: BLE001  # which is what is recorded
                self.note(name, f"{type(error).__name__}: {error}")

        self.task = asyncio.get_running_loop().create_task(note())

    def do_action(self, name: str, type_name: str, accepts: str = "") -> None:
        """Provide an action, which accepts goals, or ``rejects`` them."""

        def begin(goal: GoalRequest) -> None:
            self.goals[name] = goal
            self.note(name, self.values(f"{type_name}_Goal", goal.cdr))

        self.bench.ros.add_action_server(
            name,
            type_name,
            begin,
            lambda goal: self.note(name, "cancel"),
            lambda goal: accepts != "rejects",
        )

    def do_feedback(self, name: str, type_name: str, values: str) -> None:
        self.goals[name].feedback(self.cdr(f"{type_name}_Feedback", values))

    def do_finish(self, name: str, status: str, result: str) -> None:
        """End the goal. *result* is the type and the values."""
        type_name, values = result.split(maxsplit=1)
        outcome = cast("GoalOutcome", int(status))
        self.goals[name].finish(outcome, self.cdr(f"{type_name}_Result", values))

    def do_goal(self, name: str, type_name: str, goal: str) -> None:
        async def send() -> str:
            heard = self.bench.ros.add_action_client(name, type_name)
            sent = self.sent = await heard.send_goal(
                self.cdr(f"{type_name}_Goal", goal),
                lambda cdr: self.note(name, self.values(f"{type_name}_Feedback", cdr)),
            )
            if sent is None:
                return "rejected"
            result = await sent.result()
            return f"{result.status} {self.values(f'{type_name}_Result', result.cdr)}"

        self._note_later(name, send(), lambda text: cast("str", text))

    def do_cancel(self) -> None:
        assert self.sent is not None
        self.sent.cancel()


class Recorded(Socketless):
    """A client whose frames go to the recording."""

    def __init__(
        self, stage: Stage, name: str, identity: Identity | None, level: Level | None
    ) -> None:
        self.stage = stage
        self.name = name
        entering = Entering(self, lambda text: stage.note(name, text))
        super().__init__(
            *(stage.bench.front, "127.0.0.1", identity, level),
            authenticate=partial(stage.admission.authenticate, entering),
        )
        request = HttpRequest("/", Headers(Host="127.0.0.1"))
        stage.admission.enter(cast("Any", entering), self.session, request, 0.0)

    def flush(self) -> None:
        before = len(self.wires)
        super().flush()
        wire = b"".join(self.wires[before:])
        frames = websocket_frames(wire)
        assert b"".join(frame.serialize(mask=False) for frame in frames) == wire
        self.stage.got += [f"{self.name}<{shown(frame)}" for frame in frames]


def _bytes(text: str) -> bytes:
    kind, _, rest = text.partition(" ")
    match kind:
        case "cbor":
            return cbor2.dumps(json.loads(rest))
        case "hex":
            return bytes.fromhex(rest)
    return text.removeprefix(" ").encode()
