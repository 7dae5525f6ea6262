# SPDX-License-Identifier: Apache-2.0
"""An uplink to `ros2-gateway router` over TLS, with a password or a certificate. All are processes.

A refusal has its true cause, which Zenoh does not say, and what to do.
"""

import asyncio
import contextlib
import json
import sys
import urllib.request
from asyncio.subprocess import PIPE
from collections.abc import AsyncIterator, Mapping
from pathlib import Path

import pytest

from tests.client import TIMEOUT_S, client
from tests.gateway_process import gateway_process
from tests.relay.conftest import Relay
from tests.sources.zenoh.authority import Authority
from tests.sources.zenoh.outside import free_port

PASSWORDS = {"r1": "password-of-r1", "west": "password-of-west"}
LOCAL = "127.0.0.1"


class Place:
    """A router with its file, and the flags of those that connect to it."""

    def __init__(self, folder: Path, *, certified: bool) -> None:
        self.folder = folder
        self.authority = Authority(folder, "authority")
        self.other = Authority(folder, "other")
        self.address = f"tls/{LOCAL}:{free_port()}"
        self.certified = certified
        self.signed = {name: self.authority.sign(name) for name in PASSWORDS}

    def lines(self, *hosts: str) -> str:
        cert, key = self.authority.sign("router", *hosts or (LOCAL,))
        lines = [f'listen = ["{self.address}"]', f'cert = "{cert}"', f'key = "{key}"']
        if self.certified:
            lines.append(f'client_ca = "{self.authority.cert}"')
        for table, name in (("robots", "r1"), ("relays", "west")):
            proof = f'{{ certificate = "{name}" }}' if self.certified else f'"{PASSWORDS[name]}"'
            lines += [f"[{table}]", f"{name} = {proof}"]
        return "\n".join(lines)

    @contextlib.asynccontextmanager
    async def router(self, *hosts: str) -> AsyncIterator[None]:
        file = self.folder / "router.toml"
        file.touch(mode=0o600)
        file.write_text(self.lines(*hosts))
        command = (sys.executable, "-m", "gateway", "router", "--config", str(file))
        process = await asyncio.create_subprocess_exec(*command, stdout=PIPE)
        try:
            assert process.stdout is not None
            async with asyncio.timeout(TIMEOUT_S):
                assert b"routing on" in await process.stdout.readline()
            yield
        finally:
            process.terminate()
            await process.wait()

    def proof(self, section: str, name: str, **changed: str | None) -> list[str]:
        """Return the flags by which a robot or a relay signs in, some of them changed."""
        given: dict[str, str | None] = {"ca": self.authority.cert}
        if self.certified:
            given["cert"], given["key"] = self.signed[name]
        else:
            given |= {"user": name, "user_file": self.password(name, PASSWORDS[name])}
        settings = {key: value for key, value in (given | changed).items() if value is not None}
        return [
            part for key, each in settings.items() for part in ("--set", f"{section}.{key}={each}")
        ]

    def password(self, name: str, text: str) -> str:
        file = self.folder / name
        file.write_text(text)
        return str(file)

    def uplink(self, **changed: str | None) -> list[str]:
        address = changed.pop("address", None) or self.address
        return ["--uplink", address, "--robot-name", "r1", *self.proof("uplink", "r1", **changed)]


async def reason_of(place: Place, **changed: str | None) -> str:
    """Return why the health of a gateway says that its uplink does not work."""
    robot = ("demo", "--recorded", "--no-browser", *place.uplink(**changed))
    async with gateway_process(*robot) as gateway, asyncio.timeout(TIMEOUT_S):
        url = f"http{gateway.url.removeprefix('ws').rstrip('/')}/healthz"
        while True:
            health = json.loads(await asyncio.to_thread(read, url))
            about = [each for each in health["reasons"] if "Zenoh router" in each]
            if about and "is connecting" not in about[0]:
                assert health["status"] == "degraded"
                return str(about[0])
            await asyncio.sleep(0.1)


async def reasons_of(place: Place, cases: Mapping[str, dict[str, str | None]]) -> dict[str, str]:
    """Return the reasons of several gateways, which run at the same time."""
    found = await asyncio.gather(*(reason_of(place, **changed) for changed in cases.values()))
    return dict(zip(cases, found, strict=True))


def read(url: str) -> bytes:
    with urllib.request.urlopen(url, timeout=TIMEOUT_S) as response:  # noqa: S310  # ours
        return bytes(response.read())


@pytest.mark.parametrize("certified", [False, True])
async def test_a_robot_and_a_relay_meet_over_tls(tmp_path: Path, certified: bool):
    place = Place(tmp_path, certified=certified)
    relay_flags = ("--set", "relay.drain_s=0", *place.proof("relay", "west"))
    robot = ("demo", "--recorded", "--no-browser", *place.uplink())
    async with contextlib.AsyncExitStack() as stack:
        await stack.enter_async_context(place.router())
        await stack.enter_async_context(gateway_process(*robot))
        opened = gateway_process("relay", place.address, *relay_flags)
        relay = Relay(place, await stack.enter_async_context(opened))  # type: ignore[arg-type]
        await relay.until("r1")
        async with client(f"{relay.url}/r1/") as viewer:
            await viewer.send(op="subscribe", topic="/odom")
            await viewer.message("/odom")


async def test_a_refusal_of_a_password_or_of_the_router_has_its_cause_and_a_remedy(tmp_path: Path):
    place = Place(tmp_path, certified=False)
    wrong = place.password("wrong", "another-password")
    plain = place.address.replace("tls/", "tcp/")
    cases: dict[str, dict[str, str | None]] = {
        "refuses the name 'r1' or its password: compare uplink.user": {"user_file": wrong},
        "refuses the name 'r9' or its password": {"user": "r9"},
        "asks for a name and a password: set uplink.user": {"user": None, "user_file": None},
        "issuer certificate: set uplink.ca to the certificate": {"ca": place.other.cert},
        "needs TLS: write tls/ in place of tcp/": {"address": plain},
        # a robot that signs in as a relay
        "use the credentials of this robot's name": {
            "user": "west",
            "user_file": place.password("west", PASSWORDS["west"]),
        },
    }
    async with place.router():
        for words, reason in (await reasons_of(place, cases)).items():
            assert words in reason
            assert not any(each in reason for each in PASSWORDS.values())
    assert "cannot be reached, connection refused: start the router" in await reason_of(place)
    async with place.router("192.0.2.1"):
        reason = await reason_of(place)
        assert f"make another one with ros2-gateway cert --name {LOCAL}" in reason


async def test_a_refusal_of_a_certificate_has_its_cause_and_a_remedy(tmp_path: Path):
    place = Place(tmp_path, certified=True)
    foreign, old = place.other.sign("r1"), place.authority.sign("r1", days=-1)
    stranger = place.authority.sign("r9")
    cases: dict[str, dict[str, str | None]] = {
        "asks for a certificate of this computer: set uplink.cert": {"cert": None, "key": None},
        "unknown ca: have uplink.cert signed": dict(zip(("cert", "key"), foreign, strict=True)),
        "certificate expired: ": dict(zip(("cert", "key"), old, strict=True)),
        "use the credentials": dict(zip(("cert", "key"), stranger, strict=True)),
    }
    async with place.router():
        for words, reason in (await reasons_of(place, cases)).items():
            assert words in reason
