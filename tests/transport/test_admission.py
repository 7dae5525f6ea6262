# SPDX-License-Identifier: Apache-2.0
"""Admission of clients, on real sockets."""

import asyncio
import contextlib
import json
from collections.abc import AsyncIterator
from functools import partial
from types import SimpleNamespace
from typing import Any

import pytest
from websockets.datastructures import Headers
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.frames import Opcode
from websockets.http11 import Request

from gateway.access.audit import Audit
from gateway.access.authentication import Authentication
from gateway.access.permissions import Policy
from gateway.access.tokens import Token, Tokens, make_token
from gateway.access.web_rules import WebRules
from gateway.config.access import AccessConfig, OperatorConfig, PageConfig, Role
from gateway.core.peer import Peer
from gateway.transport.admission import Admission
from tests.client import TIMEOUT_S, Client, client, eventually
from tests.transport.conftest import Serve, Served
from tests.transport.test_server import closing, handshake, masked, status_of, upgrade

NOW = "2026-01-02T03:04:05+00:00"
STRING = "std_msgs/msg/String"
OPERATORS, OPERATOR = make_token("tablet", "operator", NOW)
VIEWERS, VIEWER = make_token("wall", "viewer", NOW)


class AccessServer:
    """A served gateway that asks for tokens, and its audit log."""

    def __init__(self, serve: Serve, **config: Any) -> None:
        self.events: list[dict[str, Any]] = []
        self.anonymous_role: Role | None = config.pop("anonymous_role", None)
        self.limits: dict[str, Any] = config.pop("limits", {})
        self.rules: dict[str, Any] = config.pop("rules", {})
        # a busy machine needs longer than people
        self.config = AccessConfig(**{"auth_timeout_s": 60.0} | config)
        self._serve = serve

    @contextlib.asynccontextmanager
    async def open(self) -> AsyncIterator[Served]:
        authentication = Authentication(
            Tokens((OPERATOR, VIEWER)), Policy(self.config), self.anonymous_role
        )
        audit = Audit(lambda: 0, lambda line: self.events.append(json.loads(line)))
        admission = partial(Admission, authentication, self.config, audit)
        async with self._serve(self.limits, admission=admission, **self.rules) as served:
            yield served

    def of(self, event: str) -> list[dict[str, Any]]:
        return [each for each in self.events if each["event"] == event]


def bearer(token: str) -> dict[str, str]:
    return {"Authorization": f"Bearer {token}"}


async def role_of(speaker: Client) -> str:
    await speaker.send(op="hello")
    hello = await speaker.receive(lambda frame: frame["op"] == "hello")
    return str(hello["role"])


def without_token(events: list[dict[str, Any]]) -> bool:
    return "r2g_" not in json.dumps(events)


@pytest.mark.parametrize(
    ("token", "role"),
    [(OPERATORS, "operator"), (VIEWERS, "viewer")],
    ids=["operator", "viewer"],
)
async def test_a_token_in_the_header_gives_its_role(serve: Serve, token, role):
    access_server = AccessServer(serve)
    async with access_server.open() as served:
        async with client(served.url, additional_headers=bearer(token)) as speaker:
            assert await role_of(speaker) == role
        await eventually(lambda: len(access_server.events) == 2)
    assert [each["event"] for each in access_server.events] == ["connected", "disconnected"]
    assert (access_server.events[0]["role"], access_server.events[0]["address"]) == (
        role,
        "127.0.0.1",
    )
    assert without_token(access_server.events)


LOCAL = {"allows_local": True}
PAGE = "http://localhost:3000"  # of another server on this machine


@pytest.mark.parametrize(
    ("rules", "config", "role"),
    [
        (LOCAL, {"anonymous_role": "admin"}, "page"),
        (LOCAL, {"anonymous_role": "viewer"}, "viewer"),
        (LOCAL | {"allowed_origins": (PAGE,)}, {"anonymous_role": "admin"}, "admin"),
    ],
)
async def test_a_local_page_has_the_role_page_unless_its_origin_is_allowed_or_others_have_less(
    serve: Serve, rules, config, role
):
    access_server = AccessServer(serve, rules=rules, **config)
    async with access_server.open() as served, client(served.url, origin=PAGE) as speaker:
        assert await role_of(speaker) == role
        (connected,) = access_server.of("connected")
        assert (connected["role"], connected["origin"]) == (role, PAGE)


async def test_after_a_reload_a_local_page_has_the_role_page_still(serve: Serve):
    access_server = AccessServer(serve, rules=LOCAL, anonymous_role="admin")
    async with access_server.open() as served, client(served.url, origin=PAGE) as page:
        await page.sync()
        served.server.reload(Tokens(), Policy(access_server.config))
        assert await role_of(page) == "page"
        permitted = AccessConfig(page=PageConfig(publish=("/cmd_vel",)))
        served.server.reload(Tokens(), Policy(permitted))
        assert (await closing(page))[0] == 1001


async def test_a_token_among_the_subprotocols_is_taken_and_never_repeated(serve: Serve):
    async with AccessServer(serve).open() as served:
        offered = ["ros2-gateway", f"bearer.{OPERATORS}"]
        async with client(served.url, subprotocols=offered) as speaker:
            assert speaker.socket.subprotocol == "ros2-gateway"
            assert await role_of(speaker) == "operator"
        offer = f"Sec-WebSocket-Protocol: bearer.{OPERATORS}"
        reader, writer = await asyncio.open_connection("127.0.0.1", served.port)
        writer.write(upgrade("Host: localhost", offer))
        response = await reader.readuntil(b"\r\n\r\n")
        assert b" 101 " in response
        assert b"bearer" not in response
        writer.close()


async def test_clients_that_offer_other_subprotocols_get_none(serve: Serve):
    async with serve() as served, client(served.url, subprotocols=["rosbridge_v2"]) as speaker:
        assert speaker.socket.subprotocol is None
        await speaker.sync()


async def test_a_token_in_the_first_frame_opens_the_door(serve: Serve):
    access_server = AccessServer(serve)
    async with access_server.open() as served, client(served.url) as speaker:
        await speaker.send(op="auth", id="a", token=OPERATORS)
        assert await speaker.receive() == {
            "op": "auth",
            "id": "a",
            "name": "tablet",
            "role": "operator",
        }
        await speaker.send(op="publish", topic="/a", type=STRING, msg={"data": "x" * 10_000})
        assert await speaker.sync() == []
        assert len(access_server.of("connected")) == 1


async def test_before_its_token_everything_is_refused_with_words(serve: Serve):
    async with AccessServer(serve).open() as served, client(served.url) as speaker:
        for operation in ("ping", "hello", "graph"):
            await speaker.send(op=operation)
        await speaker.send(op="subscribe", topic="/a", type=STRING)
        await speaker.send(op="auth", mac="x", client="y")
        statuses = [await speaker.status() for _ in range(5)]
        assert [status["code"] for status in statuses] == ["forbidden"] * 4 + ["bad_request"]
        assert "authenticate first" in statuses[0]["msg"]
        assert "token is missing" in statuses[4]["msg"]
        assert served.ros.entity_count() == 0
        await speaker.send(op="auth", token=OPERATORS)
        assert await speaker.sync() == []


@pytest.mark.parametrize(
    "token",
    [
        pytest.param("wrong", id="short"),
        pytest.param(OPERATORS + "x", id="longer"),
        pytest.param("\0\x7f\u2028 \U0001f916", id="odd"),
        pytest.param("x" * 3000, id="long"),
        pytest.param("", id="empty"),
    ],
)
async def test_a_wrong_token_in_the_first_frame_gets_4401(serve: Serve, token):
    access_server = AccessServer(serve)
    async with access_server.open() as served, client(served.url) as speaker:
        await speaker.send(op="auth", id=1, token=token)
        assert await closing(speaker) == (4401, "the token is wrong")
        assert [frame["code"] for frame in speaker.seen] == ["forbidden"]
    (event,) = access_server.of("refused")
    assert event == {**event, "address": "127.0.0.1", "reason": "the token is wrong"}


@pytest.mark.parametrize(
    "options",
    [
        {"additional_headers": bearer("wrong")},
        {"additional_headers": bearer("\xff\xfe")},
        {"subprotocols": ["ros2-gateway", "bearer.wrong"]},
    ],
)
async def test_a_wrong_token_in_the_handshake_gets_4401(serve: Serve, options):
    async with AccessServer(serve).open() as served, client(served.url, **options) as speaker:
        assert await closing(speaker) == (4401, "the token is wrong")
        assert speaker.seen[0]["code"] == "forbidden"


@pytest.mark.parametrize(
    ("target", "headers"),
    [
        ("/?token=" + OPERATORS, ()),
        ("/", ("Authorization: Basic dXNlcjpwYXNz",)),
        ("/", ("Authorization: Bearer a", "Authorization: Bearer b")),
        ("/", ("Authorization: Bearer a", "Sec-WebSocket-Protocol: bearer.b")),
    ],
    ids=["in the address", "basic", "two", "two places"],
)
async def test_a_token_in_a_wrong_place_or_two_tokens_get_400(serve: Serve, target, headers):
    access_server = AccessServer(serve)
    async with access_server.open() as served:
        request = upgrade("Host: localhost", *headers).replace(b"GET / ", f"GET {target} ".encode())
        assert await status_of(served, request) == 400
    assert without_token(access_server.events)


async def test_a_client_that_sends_no_token_is_closed_after_a_while(serve: Serve):
    access_server = AccessServer(serve, auth_timeout_s=0.2)
    async with (
        access_server.open() as served,
        client(served.url) as silent,
        client(served.url, additional_headers=bearer(VIEWERS)) as other,
    ):
        assert await closing(silent) == (4401, "no token within 0.2 s")
        await other.sync()
    assert access_server.of("refused")[0]["reason"] == "no token within 0.2 s"


async def test_before_its_token_a_client_sends_small_messages_alone(serve: Serve):
    async with AccessServer(serve).open() as served:
        async with client(served.url) as speaker:
            await speaker.send(op="ping", value="x" * 5000)
            code, _ = await closing(speaker)
            assert code == 1009
            assert "at most 4096 bytes" in speaker.seen[-1]["msg"]
        async with client(served.url) as speaker:
            piece = {"op": "fragment", "id": "f", "num": 0, "total": 100}
            for _ in range(10):
                await speaker.send(**piece, data="x" * 3000)
            statuses = [await speaker.status() for _ in range(10)]
            assert {status["code"] for status in statuses} == {"forbidden"}


class Waiting:
    """A client that has yet to send its token."""

    name, address = "10.0.0.5#1", "10.0.0.5"

    def __init__(self, refused: int) -> None:
        self.session: Any = SimpleNamespace(identity=None, refused=refused)
        self.closed: list[int] = []

    def close(self, code: int, reason: str) -> None:
        self.closed.append(code)

    def limit_messages(self, max_bytes: int) -> None:
        pass


def test_64_operations_without_a_token_are_not_abuse_yet():
    authentication = Authentication(Tokens((OPERATOR,)), Policy(AccessConfig()), None)
    parts = AccessConfig(), Audit(lambda: 0), lambda _: None, WebRules(())
    admission = Admission(authentication, *parts)
    waiting = Waiting(refused=64)
    admission.enter(waiting, waiting.session, Request("/", Headers()), 0.0)
    admission.tick(0.1)
    assert waiting.closed == []
    waiting.session.refused += 1
    admission.tick(0.2)
    assert waiting.closed == [1008]


async def test_so_many_clients_wait_for_their_token_and_the_oldest_makes_room(serve: Serve):
    access_server = AccessServer(serve, max_unauthenticated=3, limits={"max_clients": 1})
    async with access_server.open() as served, contextlib.AsyncExitStack() as stack:
        waiting = [await stack.enter_async_context(client(served.url)) for _ in range(4)]
        reason = "over capacity: at most 3 clients without a token"
        assert await closing(waiting[0]) == (1013, reason)
        # and they do not use the places of clients
        newest = waiting[-1]
        await newest.send(op="auth", token=OPERATORS)
        assert await newest.sync() == []
        assert len(served.server._admission) == 2


async def test_of_those_that_wait_one_of_the_greediest_address_makes_room(serve: Serve):
    class ClientConnection:
        session = None

        def __init__(self, address: str) -> None:
            self.address = address
            self.name = f"{address}#1"
            self.codes: list[int] = []

        def close(self, code: int, reason: str) -> None:
            self.codes.append(code)

        def limit_messages(self, max_bytes: int) -> None: ...

    async with AccessServer(serve, max_unauthenticated=3).open() as served:
        admission = served.server._admission
        entrants = [ClientConnection(address) for address in ("a", "b", "b", "c")]
        for connection in entrants:
            session = served.server.fronts.of(None).open(Peer(wake=lambda: None, identity=None))
            admission.enter(connection, session, None, 0.0)
            served.server._router.leave(session)
        assert [connection.codes for connection in entrants] == [[], [1013], [], []]
        for connection in entrants:
            admission.left(connection, None)


async def test_lines_of_the_audit_log_have_the_client_as_all_lines_do(serve: Serve, caplog):
    caplog.set_level("INFO", "gateway.audit")
    async with AccessServer(serve).open() as served:
        async with client(served.url) as speaker:
            await speaker.send(op="auth", token="r2g_wrong")  # noqa: S106
            await closing(speaker)
        async with client(served.url, additional_headers=bearer(VIEWERS)) as speaker:
            await speaker.sync()
        await eventually(lambda: "disconnected" in caplog.text)
    records = [each for each in caplog.records if each.name == "gateway.audit"]
    found = [(json.loads(each.getMessage())["event"], each.client) for each in records]
    assert found == [
        ("refused", "127.0.0.1#1"),
        ("connected", "127.0.0.1#2"),
        ("disconnected", "127.0.0.1#2"),
    ]


async def test_a_full_gateway_also_refuses_clients_with_a_token(serve: Serve):
    async with (
        AccessServer(serve, limits={"max_clients": 1}).open() as served,
        client(served.url, additional_headers=bearer(VIEWERS)) as first,
    ):
        await first.sync()
        full = (1013, "over capacity: at most 1 clients (limits.max_clients)")
        async with client(served.url, additional_headers=bearer(VIEWERS)) as second:
            assert await closing(second) == full
        async with client(served.url) as third:
            await third.send(op="auth", token=OPERATORS)
            assert await closing(third) == full


async def test_each_wrong_token_is_refused_and_a_right_one_passes_all_the_same(serve: Serve):
    access_server = AccessServer(serve)
    async with access_server.open() as served:
        codes = []
        for _ in range(12):
            async with client(served.url, additional_headers=bearer("wrong")) as speaker:
                codes.append((await closing(speaker))[0])
        assert codes == [4401] * 12
        async with client(served.url, additional_headers=bearer(OPERATORS)) as speaker:
            assert await role_of(speaker) == "operator"


async def test_without_authentication_a_token_is_not_looked_at(serve: Serve):
    async with serve() as served, client(served.url, additional_headers=bearer("any")) as speaker:
        assert await role_of(speaker) == "admin"
        await speaker.send(op="auth", token="any")  # noqa: S106  # none of ours
        assert await speaker.sync() == []


async def test_if_all_may_watch_a_token_gives_more_permissions(serve: Serve):
    async with AccessServer(serve, anonymous_role="viewer").open() as served:
        async with client(served.url) as speaker:
            assert await role_of(speaker) == "viewer"
            await speaker.send(op="auth", mac="x")  # of an old client
            await speaker.send(op="auth", token=OPERATORS)
            assert await role_of(speaker) == "operator"
        async with client(served.url) as speaker:
            await speaker.send(op="auth", token="wrong")  # noqa: S106
            assert (await closing(speaker))[0] == 4401


async def test_a_client_that_has_signed_in_keeps_its_role(serve: Serve):
    async with (
        AccessServer(serve).open() as served,
        client(served.url, additional_headers=bearer(VIEWERS)) as speaker,
    ):
        await speaker.send(op="auth", token=VIEWERS)
        assert await speaker.sync() == []
        await speaker.send(op="auth", token=OPERATORS)
        assert "already" in (await speaker.status())["msg"]
        assert await role_of(speaker) == "viewer"


def changed(token: Token, **fields: Any) -> Token:
    return token.model_copy(update=fields)


@pytest.mark.parametrize(
    ("tokens", "policy", "closed"),
    [
        ((OPERATOR, VIEWER), {}, None),
        ((VIEWER,), {}, (4401, "the token was revoked")),
        (
            (changed(OPERATOR, role="viewer"), VIEWER),
            {},
            (4403, "the role of the token is viewer now, not operator"),
        ),
        (
            (OPERATOR, VIEWER),
            {"operator": OperatorConfig(deny_publish=("/a",))},
            (1001, "the permissions of role operator have changed, connect again"),
        ),
    ],
    ids=["nothing", "revoked", "another role", "other permissions"],
)
async def test_a_reload_closes_those_whom_it_takes_or_gives_something(
    serve: Serve, tokens, policy, closed
):
    access_server = AccessServer(serve)
    async with (
        access_server.open() as served,
        client(served.url, additional_headers=bearer(OPERATORS)) as operator,
        client(served.url, additional_headers=bearer(VIEWERS)) as viewer,
    ):
        await operator.send(op="advertise", topic="/a", type=STRING)
        await operator.sync()
        await viewer.sync()
        served.server.reload(Tokens(tokens), Policy(AccessConfig(**policy)))
        if closed is None:
            await operator.sync()
        else:
            assert await closing(operator) == closed
            await eventually(lambda: served.ros.entity_count() == 0)
            assert [each["code"] for each in access_server.of("revoked")] == [closed[0]]
        await viewer.sync()
        assert await role_of(viewer) == "viewer"


async def test_everything_of_a_revoked_client_ends_before_its_closing_handshake(serve: Serve):
    access_server = AccessServer(serve, limits={"close_timeout_s": 2.0})
    async with access_server.open() as served:
        reader, writer = await asyncio.open_connection("127.0.0.1", served.port)
        writer.write(upgrade("Host: localhost", f"Authorization: Bearer {OPERATORS}"))
        await reader.readuntil(b"\r\n\r\n")
        advertise = json.dumps({"op": "advertise", "topic": "/a", "type": STRING}).encode()
        writer.write(masked(Opcode.TEXT, advertise))
        await eventually(lambda: served.ros.entity_count() == 1)
        served.server.reload(Tokens(), Policy(AccessConfig()))
        assert served.ros.entity_count() == 0
        writer.write(masked(Opcode.TEXT, advertise))  # too late
        writer.write(masked(Opcode.CLOSE, (1000).to_bytes(2, "big")))
        assert (4401).to_bytes(2, "big") in await reader.read()
        assert served.ros.entity_count() == 0
        writer.close()


async def test_after_a_reload_a_new_token_is_valid_and_a_revoked_one_is_not(serve: Serve):
    text, token = make_token("new", "viewer", NOW)
    async with AccessServer(serve).open() as served:
        served.server.reload(Tokens((token,)), Policy(AccessConfig()))
        async with client(served.url, additional_headers=bearer(text)) as speaker:
            assert await role_of(speaker) == "viewer"
        async with client(served.url, additional_headers=bearer(OPERATORS)) as speaker:
            assert (await closing(speaker))[0] == 4401


async def test_a_flood_of_frames_before_the_token_leaves_nothing_behind(serve: Serve):
    access_server = AccessServer(serve, limits={"frames_per_s": 1000, "frame_burst": 1000})
    async with access_server.open() as served:
        reader, writer = await handshake(served)
        frame = masked(Opcode.TEXT, b'{"op":"ping"}')
        with contextlib.suppress(ConnectionError):
            for _ in range(50):
                writer.write(frame * 100)
                await writer.drain()
        async with asyncio.timeout(TIMEOUT_S):
            with contextlib.suppress(ConnectionError):
                assert (1008).to_bytes(2, "big") in await reader.read()
        writer.close()
        await eventually(lambda: not served.server.connections)
        assert len(served.server._admission) == 0


async def test_health_and_the_page_need_no_token(serve: Serve):
    async with AccessServer(serve).open() as served:
        for path in (b"/", b"/healthz"):
            request = b"GET %b HTTP/1.1\r\nHost: localhost\r\n\r\n" % path
            assert await status_of(served, request) == 200


async def test_a_foreign_page_is_refused_whatever_token_it_has(serve: Serve):
    async with AccessServer(serve).open() as served:
        with pytest.raises(InvalidStatus) as caught:
            async with client(
                served.url, additional_headers=bearer(OPERATORS), origin="http://evil.example"
            ):
                pass
        assert caught.value.response.status_code == 403


async def test_a_connection_that_ends_while_it_waits_is_forgotten(serve: Serve):
    async with AccessServer(serve).open() as served:
        with contextlib.suppress(ConnectionClosed):
            async with client(served.url):
                await eventually(lambda: len(served.server._admission) == 1)
        await eventually(lambda: len(served.server._admission) == 0)
