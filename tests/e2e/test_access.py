# SPDX-License-Identifier: Apache-2.0
"""The permissions of clients of a gateway that runs as people start it."""

import asyncio
import json
import os
import pty
import re
import signal
import socket
import ssl
import stat
import subprocess
import sys
from pathlib import Path
from urllib.parse import urlsplit

import pytest

from tests.client import TIMEOUT_S, Client, client, eventually
from tests.gateway_process import GatewayProcess, gateway_process
from tests.transport.test_admission import bearer, role_of
from tests.transport.test_server import closing

TWIST = {"topic": "/cmd_vel", "type": "geometry_msgs/msg/Twist", "msg": {}}


@pytest.fixture
def tokens(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return where the gateway keeps its tokens."""
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    return tmp_path / "ros2-gateway/tokens.json"


def text_of(path: Path) -> str | None:
    return path.read_text() if path.exists() else None


def write(path: Path, text: str) -> None:
    path.write_text(text)


def mode_of(path: Path) -> int:
    return stat.S_IMODE(path.stat().st_mode)


async def command(*arguments: str) -> str:
    """Run ``ros2-gateway`` and return what it prints."""
    finished = await asyncio.to_thread(
        subprocess.run,
        [sys.executable, "-m", "gateway", *arguments],
        capture_output=True,
        text=True,
        timeout=TIMEOUT_S,
        check=True,
    )
    return finished.stdout.strip()


async def shown_token(gateway: GatewayProcess) -> str:
    await eventually(lambda: "more    " in "".join(gateway.output))
    printed = "".join(gateway.output)
    if found := re.search(r"Bearer \$\(cat (\S+)\)", printed):  # this is not a terminal
        return (text_of(Path(found[1])) or "").strip()
    found = re.search(r"Bearer (\S+)'", printed)
    assert found
    return found[1]


def logged(gateway: GatewayProcess, text: str) -> bool:
    return text in "".join(gateway.log)


async def forbidden_to_drive(speaker: Client) -> bool:
    await speaker.send(op="publish", **TWIST)
    return any(frame.get("code") == "forbidden" for frame in await speaker.sync())


async def test_without_flags_nobody_needs_a_token_and_all_is_allowed(tokens: Path):
    async with gateway_process() as gateway, client(gateway.url) as speaker:
        assert await role_of(speaker) == "admin"
        assert not await forbidden_to_drive(speaker)
        await eventually(lambda: logged(gateway, "connected"))
        assert "audit" not in "".join(gateway.log)
        assert "token" not in "".join(gateway.output)
    assert text_of(tokens) is None


@pytest.mark.parametrize("flags", [("--lan",), ("--host", "0.0.0.0")])  # noqa: S104  # on purpose
async def test_a_gateway_that_others_can_reach_asks_for_a_token_and_makes_one(tokens: Path, flags):
    async with gateway_process("serve", *flags) as gateway:
        token = await shown_token(gateway)
        assert "other machines can connect, so clients need a token" in "".join(gateway.output)
        assert mode_of(tokens) == 0o600
        assert token not in (text_of(tokens) or "")
        kept = tokens.with_name("first-token")  # because this is not a terminal, but perhaps a log
        assert (mode_of(kept), text_of(kept)) == (0o600, f"{token}\n")
        assert token not in "".join(gateway.output)
        await eventually(lambda: logged(gateway, f"token of a new operator is in {kept}"))
        async with client(gateway.url, additional_headers=bearer(token)) as speaker:
            assert await role_of(speaker) == "operator"
            assert not await forbidden_to_drive(speaker)
        async with client(gateway.url) as stranger:
            await stranger.send(op="hello")
            assert (await stranger.status())["code"] == "forbidden"
        await eventually(lambda: logged(gateway, "gateway.audit"))
        assert token not in "".join(gateway.log)
    # it is shown no more, but valid
    async with gateway_process("serve", *flags) as gateway:
        assert await shown_token(gateway) == "TOKEN"
        async with client(gateway.url, additional_headers=bearer(token)) as speaker:
            assert await role_of(speaker) == "operator"


async def test_all_networks_are_those_of_ipv6_too(tokens: Path):
    async with gateway_process("serve", "--lan") as gateway:
        token = await shown_token(gateway)
        port = gateway.url.rpartition(":")[2]
        for host in ("127.0.0.1", "[::1]"):
            async with client(f"ws://{host}:{port}", additional_headers=bearer(token)) as speaker:
                await speaker.sync()


@pytest.mark.parametrize(
    ("flags", "role", "warning"),
    [
        ((), "viewer", "WARNING: without a token, everybody on the network may watch\n"),
        (
            ("--anyone-may-drive",),
            "operator",
            "WARNING: without a token, everybody on the network may drive the robot\n",
        ),
    ],
)
async def test_without_authentication_all_may_watch_and_drive_only_if_it_is_said(
    tokens: Path, flags, role, warning
):
    async with gateway_process("serve", "--lan", "--no-auth", *flags) as gateway:
        await eventually(lambda: warning in "".join(gateway.output))
        async with client(gateway.url) as speaker:
            assert await role_of(speaker) == role
            assert await forbidden_to_drive(speaker) is (role == "viewer")


async def test_a_revoked_token_ends_its_client_after_sighup_and_a_new_one_is_valid(tokens: Path):
    tablet = await command("token", "create", "tablet")
    async with gateway_process("serve", "--lan") as gateway:
        async with client(gateway.url, additional_headers=bearer(tablet)) as speaker:
            await speaker.sync()
            await command("token", "revoke", "tablet")
            wall = await command("token", "create", "wall", "--role", "viewer")
            gateway.process.send_signal(signal.SIGHUP)
            assert await closing(speaker) == (4401, "the token was revoked")
        async with client(gateway.url, additional_headers=bearer(wall)) as speaker:
            assert await role_of(speaker) == "viewer"
        assert await gateway.stop() == 0


async def test_a_reload_that_fails_changes_nothing_and_says_why(tokens: Path, tmp_path: Path):
    tablet = await command("token", "create", "tablet")
    config = tmp_path / "gateway.toml"
    config.write_text("lan = true\n")
    async with gateway_process("serve", "--config", str(config)) as gateway:
        async with client(gateway.url, additional_headers=bearer(tablet)) as speaker:
            await speaker.sync()
            good = text_of(tokens) or ""
            write(tokens, "damaged")
            gateway.process.send_signal(signal.SIGHUP)
            await eventually(lambda: logged(gateway, "not reloaded, the old configuration stays"))
            assert logged(gateway, f"{tokens} is not a token file")
            write(tokens, good)
            config.write_text("lan = true\n[access.operator]\nsubscribe = 'x'\n")
            gateway.process.send_signal(signal.SIGHUP)
            await eventually(lambda: logged(gateway, "access.operator.subscribe: got 'x'"))
            assert not await forbidden_to_drive(speaker)
            config.write_text("lan = true\n[access.operator]\npublish = ['/other']\n")
            gateway.process.send_signal(signal.SIGHUP)
            code, reason = await closing(speaker)
            assert (code, "have changed" in reason) == (1001, True)
        async with client(gateway.url, additional_headers=bearer(tablet)) as speaker:
            assert await forbidden_to_drive(speaker)
        assert await gateway.stop() == 0


# makes the terminal that is its standard output its controlling one, and becomes the gateway
_ON_A_TERMINAL = (
    "import fcntl, os, signal, sys, termios; fcntl.ioctl(1, termios.TIOCSCTTY, 0);"
    " signal.signal(signal.SIGHUP, signal.SIG_DFL);"  # also if nohup has started the tests
    " os.execv(sys.executable, [sys.executable, '-m', 'gateway', 'serve', '--port', '0',"
    " *sys.argv[1:]])"
)


@pytest.mark.parametrize("log_format", ["text", "json"])
@pytest.mark.parametrize("has_input", [True, False])
async def test_a_closed_terminal_ends_the_gateway_as_ever(log_format: str, *, has_input: bool):
    terminal, end = pty.openpty()
    gateway = await asyncio.create_subprocess_exec(
        *(sys.executable, "-c", _ON_A_TERMINAL, "--log-format", log_format),
        stdin=end if has_input else asyncio.subprocess.DEVNULL,
        stdout=end,
        stderr=end,
        start_new_session=True,
    )
    os.close(end)
    seen = ""
    async with asyncio.timeout(TIMEOUT_S):
        while "listening on" not in seen:
            seen += (await asyncio.to_thread(os.read, terminal, 4096)).decode()
        gateway.send_signal(signal.SIGHUP)  # the terminal is still there: it reloads
        while "reloaded" not in seen:
            seen += (await asyncio.to_thread(os.read, terminal, 4096)).decode()
        os.close(terminal)
        assert await gateway.wait() == 0


async def test_every_meaning_of_localhost_is_listened_on():
    with socket.socket(socket.AF_INET6) as probe:
        try:
            probe.bind(("::1", 0))
        except OSError as error:
            pytest.skip(f"no IPv6 here: {error}")
    async with gateway_process("serve") as gateway:
        port = urlsplit(gateway.url).port
        for host in ("127.0.0.1", "[::1]", "localhost"):
            async with client(f"ws://{host}:{port}/") as caller:
                assert await caller.sync() == []
        assert [line for line in gateway.output if "listening" in line] == [
            f"listening on ws://127.0.0.1:{port}/\n"
        ]


async def test_a_certificate_of_this_machine_encrypts_and_is_verified(tokens: Path):
    pytest.importorskip("cryptography")
    assert "localhost" in await command("cert")
    cert, key = tokens.with_name("cert.pem"), tokens.with_name("key.pem")
    assert mode_of(key) == 0o600
    async with gateway_process("serve", "--tls-cert", str(cert), "--tls-key", str(key)) as gateway:
        assert gateway.url.startswith("wss://127.0.0.1:")
        trusting = ssl.create_default_context(cafile=cert)
        async with client(gateway.url, ssl=trusting) as speaker:
            assert await role_of(speaker) == "admin"
            session = speaker.socket.transport.get_extra_info("ssl_object")
            assert session.version() in {"TLSv1.2", "TLSv1.3"}
            await speaker.send(op="ping", value="x" * 200_000)
            assert (await speaker.receive())["value"] == "x" * 200_000
        with pytest.raises(ssl.SSLCertVerificationError):
            async with client(gateway.url, ssl=ssl.create_default_context()):
                pass
        # a client without TLS does no harm
        _, writer = await asyncio.open_connection("127.0.0.1", port_of(gateway))
        writer.write(b"GET / HTTP/1.1\r\n\r\n")
        writer.close()
        async with client(gateway.url, ssl=trusting) as speaker:
            await speaker.sync()
        assert await gateway.stop() == 0


def port_of(gateway: GatewayProcess) -> int:
    return int(gateway.url.rstrip("/").rpartition(":")[2])


async def test_the_audit_log_says_who_came_and_who_was_refused(tokens: Path, tmp_path: Path):
    tablet = await command("token", "create", "tablet")
    path = tmp_path / "audit.jsonl"
    async with gateway_process("serve", "--lan", "--set", f"audit.file={path}") as gateway:
        async with client(gateway.url, additional_headers=bearer(tablet)) as speaker:
            await speaker.send(op="set_parameters", id=1, node="/x", values={"a": "payload"})
            await speaker.send(op="call_service", id=2, service="/x/set_parameters")
            await speaker.receive(lambda frame: frame.get("id") == 2)
        async with client(gateway.url, additional_headers=bearer("r2g_wrong")) as speaker:
            await closing(speaker)
        assert await gateway.stop() == 0
    events = [json.loads(line) for line in path.read_text().splitlines()]
    assert [each["event"] for each in events] == [
        "connected",
        "forbidden",
        "disconnected",
        "refused",
    ]
    assert events[0]["name"] == "tablet"
    assert "/x/set_parameters requires role admin" in events[1]["reason"]
    assert mode_of(path) == 0o600
    for secret in (tablet, "payload", "r2g_wrong"):
        assert secret not in path.read_text()
        assert not logged(gateway, secret)


async def test_the_demonstration_on_a_network_shows_a_command_that_works(tokens: Path):
    async with gateway_process("demo", "--lan") as gateway:
        token = await shown_token(gateway)
        await eventually(lambda: "paste:" in "".join(gateway.output))
        (hint,) = [line for line in gateway.output if "paste:" in line]
        assert f'-H "Authorization: Bearer $(cat {tokens.with_name("first-token")})"' in hint
        async with client(gateway.url, additional_headers=bearer(token)) as speaker:
            await speaker.send(op="subscribe", topic="/odom")
            await speaker.message("/odom")
