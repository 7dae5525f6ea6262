# SPDX-License-Identifier: Apache-2.0
"""The router lets robots and relays do what they need, and nothing else."""

import contextlib
import json
import socket
import stat
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
import zenoh

from gateway.cli.certificate import make_certificate
from gateway.errors import BindError, ConfigError
from gateway.relay import router as routers
from gateway.relay.router_file import MIN_PASSWORD, RouterConfig, checked, read_router_file
from tests.client import TIMEOUT_S, client
from tests.gateway_process import gateway_process
from tests.relay.conftest import Relay
from tests.sources.zenoh.outside import free_port, session

PASSWORDS = {"r1": "password-of-r1", "r2": "password-of-r2", "west": "password-of-west"}
QUIET_S = 0.3  # in which what is refused does not come, though what is allowed has come


def config_of(**given: Any) -> RouterConfig:
    robots = {name: PASSWORDS[name] for name in ("r1", "r2")}
    relays = {"west": PASSWORDS["west"]}
    listen = [f"tcp/127.0.0.1:{free_port()}"]
    return checked({"listen": listen, "robots": robots, "relays": relays, **given}, "test")


class Network:
    """A router with two robots and a relay, as sessions that try everything."""

    def __init__(self, address: str) -> None:
        self.address = address
        self.r1, self.r2, self.west = (self.open(name) for name in PASSWORDS)
        self.other = self.open("west")  # a session gets from itself without the router

    def open(self, name: str | None, password: str | None = None) -> Any:
        settings: dict[str, Any] = {"connect/endpoints": [self.address], "listen/endpoints": []}
        if name is not None:
            settings["transport/auth/usrpwd/user"] = name
            settings["transport/auth/usrpwd/password"] = password or PASSWORDS[name]
        return session(mode="client", **settings)

    def close(self) -> None:
        for each in (self.r1, self.r2, self.west, self.other):
            each.close()

    def gets(self, listener: Any, key: str, sender: Any, put: str) -> bool:
        """Return whether a subscription gets what another session puts."""
        got: list[str] = []
        with listener.declare_subscriber(key, lambda sample: got.append(str(sample.key_expr))):
            return eventually(lambda: sender.put(put, b"x"), lambda: bool(got))

    def answers(self, server: Any, key: str, asker: Any) -> bool:
        with server.declare_queryable(key, lambda query: query.reply(query.key_expr, b"yes")):
            got: list[Any] = []

            def ask() -> None:
                got.extend(reply for reply in asker.get(key, timeout=QUIET_S) if reply.ok)

            return eventually(ask, lambda: bool(got))

    def sees(self, watcher: Any, key: str, owner: Any, token: str) -> bool:
        got: list[str] = []
        declared = owner.liveliness().declare_token(token)

        def arrive(sample: Any) -> None:
            got.append(str(sample.key_expr))

        with watcher.liveliness().declare_subscriber(key, arrive, history=True):
            found = eventually(lambda: None, lambda: token in got)
        declared.undeclare()
        return found


def eventually(act: Callable[[], object], is_done: Callable[[], bool]) -> bool:
    """Try until it is done. Give up after a short time."""
    end_s = time.monotonic() + QUIET_S
    while time.monotonic() < end_s and not is_done():
        act()
        time.sleep(0.01)
    return is_done()


@pytest.fixture(scope="module")
def network() -> Iterator[Network]:
    config = config_of()
    with (
        routers.routing(config),
        contextlib.closing(Network(config.listen[0])) as opened,
    ):
        yield opened


ODOM = "gw/r1/0/odom/nav_msgs::msg::dds_::Odometry_/RIHS01_1"


@pytest.mark.parametrize("name", ["no name", "a wrong password", "an unknown name"])
def test_nobody_connects_without_signing_in(network: Network, name: str):
    user, password = {
        "no name": (None, None),
        "a wrong password": ("r1", "password-of-r2"),
        "an unknown name": ("r3", "password-of-r1"),
    }[name]
    with pytest.raises(zenoh.ZError):
        network.open(user, password)


@pytest.mark.parametrize("key", [ODOM, "gw/r1/beat", "gw/r1/control/c1"])
def test_a_relay_gets_what_a_robot_puts_and_may_not_put_it_itself(network: Network, key: str):
    assert network.gets(network.west, key, network.r1, key)
    assert not network.gets(network.r1, key, network.west, key)


def test_a_relay_hands_over_commands(network: Network):
    key = "gw/r1/cmd/c1"
    assert network.gets(network.r1, "gw/r1/cmd/*", network.west, key)
    assert not network.gets(network.r2, "gw/r1/cmd/*", network.west, key)
    assert not network.gets(network.other, "gw/r1/cmd/*", network.west, key)


@pytest.mark.parametrize("key", ["**", "gw/**", "gw/r1/**", "gw/r1/0/**"])
def test_nobody_subscribes_to_everything(network: Network, key: str):
    assert not network.gets(network.west, key, network.r1, ODOM)
    if key in {"**", "gw/**"}:
        assert not network.gets(network.r2, key, network.r1, ODOM)


def test_a_robot_has_its_own_namespace_alone(network: Network):
    own = "gw/r2/0/odom/nav_msgs::msg::dds_::Odometry_/RIHS01_1"
    assert network.gets(network.west, own, network.r2, own)
    assert not network.gets(network.west, ODOM, network.r2, ODOM)
    assert not network.gets(network.r2, ODOM, network.r1, ODOM)
    assert not network.answers(network.r2, "gw/r1/lease", network.west)
    assert not network.sees(network.west, "gw/*/alive", network.r2, "gw/r1/alive")


def test_a_relay_asks_for_control_and_services_alone(network: Network):
    service = "gw/r1/0/reset/std_srvs::srv::dds_::Trigger_/RIHS01_1"
    for key in ("gw/r1/lease", "gw/r1/lease/stop", service, f"{ODOM}/@adv/pub/1/1/_"):
        assert network.answers(network.r1, key, network.west), key
    assert not network.answers(network.r1, "gw/r1/secret", network.west)
    assert not network.answers(network.west, "gw/r1/lease", network.r1)


def test_a_relay_finds_robots_and_shows_its_subscriptions(network: Network):
    shown = "gw/r1/@ros2_lv/0/1/0/1/MS/%/%/relay/%odom/t/h/::,10:,:,:,,"
    assert network.sees(network.west, "gw/*/alive", network.r1, "gw/r1/alive")
    assert network.sees(network.r1, "gw/r1/@ros2_lv/0/**", network.west, shown)
    assert network.sees(network.r1, "gw/r1/client/*", network.west, "gw/r1/client/c1")
    assert not network.sees(network.other, "gw/*/alive", network.west, "gw/r1/alive")


def test_relays_publish_on_topics_if_the_file_says_so():
    config = config_of(relays_publish=True)
    with (
        routers.routing(config),
        contextlib.closing(Network(config.listen[0])) as network,
    ):
        assert network.gets(network.r1, ODOM, network.west, ODOM)
        assert not network.gets(network.r1, "gw/r1/beat", network.west, "gw/r1/beat")
        assert not network.gets(network.west, "gw/r1/**", network.r1, ODOM)


async def test_robots_and_relays_work_behind_the_rules(tmp_path: Path):
    port = free_port()
    lines = [f'listen = ["tcp/127.0.0.1:{port}"]', "[robots]", f'r1 = "{PASSWORDS["r1"]}"']
    lines += ["[relays]", f'west = "{PASSWORDS["west"]}"']
    (tmp_path / "router.toml").write_text("\n".join(lines))
    for name in ("r1", "west"):
        (tmp_path / name).write_text(PASSWORDS[name])
    config = read_router_file(tmp_path / "router.toml")
    signed = {
        section: [
            *("--set", f"{section}.user={name}"),
            *("--set", f"{section}.user_file={tmp_path / name}"),
        ]
        for section, name in (("uplink", "r1"), ("relay", "west"))
    }
    address = config.listen[0]
    with routers.routing(config) as router:
        opened = gateway_process("relay", address, "--set", "relay.drain_s=0", *signed["relay"])
        demo = ("demo", "--recorded", "--no-browser", "--uplink", address, "--robot-name", "r1")
        async with opened as process, gateway_process(*demo, *signed["uplink"]):
            relay = Relay(router, process)
            await relay.until("r1")
            async with client(f"{relay.url}/r1/") as viewer:
                for topic in ("/odom", "/robot_description"):
                    await viewer.send(op="subscribe", topic=topic)
                    await viewer.message(topic)
                await viewer.send(
                    op="call_service", service="/rosbag2_player/is_paused", id="s", args={}
                )
                answer = await viewer.receive(lambda frame: frame["op"] == "service_response")
                assert answer["result"], answer


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"robots": {"R1": "password-of-r1"}}, "robots.R1"),
        ({"robots": {"r1": "short"}}, f"at least {MIN_PASSWORD} characters"),
        ({"robots": {"west": "password-of-r1"}}, "west is a robot and a relay"),
        ({"listen": ["tls/[::]:7447"]}, "cert and key are missing"),
        ({"cert": "cert.pem"}, "cert and key belong together"),
        ({"relays": {"west": {"certificate": "west"}}}, "client_ca is missing"),
        ({"robot": {}}, "robot"),
    ],
)
def test_a_mistake_in_the_file_is_named_without_a_password(given: dict[str, Any], words: str):
    with pytest.raises(ConfigError, match=words) as caught:
        config_of(**given)
    assert not any(each in str(caught.value) for each in (*PASSWORDS.values(), "short"))


def test_a_router_is_not_open_to_a_network_by_mistake(tmp_path: Path):
    away = RouterConfig(listen=(f"tcp/0.0.0.0:{free_port()}",))
    with pytest.raises(ConfigError, match="or add --open"):
        routers.check(away, allows_everybody=False)
    routers.check(away, allows_everybody=True)
    assert len(list(routers.warnings(away, None))) == 2
    here = RouterConfig(listen=(f"tcp/127.0.0.1:{free_port()}",))
    routers.check(here, allows_everybody=False)
    assert not list(routers.warnings(here, None))
    file = tmp_path / "router.toml"
    file.write_text("")
    file.chmod(0o644)
    assert any("chmod 600" in each for each in routers.warnings(config_of(), file))
    file.chmod(stat.S_IRUSR)
    assert not list(routers.warnings(config_of(), file))


def test_files_that_do_not_fit_and_ports_in_use_are_reported(tmp_path: Path):
    with pytest.raises(ConfigError, match=r"missing.toml cannot be read, no such file"):
        read_router_file(tmp_path / "missing.toml")
    for name in ("one", "two"):
        (tmp_path / name).mkdir()
        make_certificate(tmp_path / name, [], replace=False)
    cert, key = str(tmp_path / "one" / "cert.pem"), str(tmp_path / "two" / "key.pem")
    with pytest.raises(ConfigError, match="cert and key do not fit together"):
        routers.check(config_of(cert=cert, key=key), allows_everybody=False)
    with pytest.raises(ConfigError, match="cannot be read, no such file"):
        routers.check(config_of(cert=cert, key=str(tmp_path / "no")), allows_everybody=False)
    with socket.create_server(("127.0.0.1", 0)) as server:
        port = server.getsockname()[1]
        with pytest.raises(BindError, match=f"127.0.0.1:{port}"):
            routers.check(config_of(listen=[f"tcp/127.0.0.1:{port}"]), allows_everybody=False)


def test_the_settings_can_be_printed_without_passwords(tmp_path: Path):
    file = tmp_path / "router.toml"
    file.write_text(f'[robots]\nr1 = "{PASSWORDS["r1"]}"\n')
    command = [sys.executable, "-m", "gateway", "router", "--config", str(file), "--print-config"]
    printed = subprocess.run(
        command, capture_output=True, text=True, check=True, timeout=TIMEOUT_S
    ).stdout
    assert PASSWORDS["r1"] not in printed
    settings = json.loads(printed)
    assert settings["access_control"]["default_permission"] == "deny"
    assert settings["transport/unicast/max_sessions"] == routers.MAX_SESSIONS == 10_000


def test_with_tls_clients_need_the_certificate_that_signed_the_router(tmp_path: Path):
    make_certificate(tmp_path, [], replace=False)
    cert, key = str(tmp_path / "cert.pem"), str(tmp_path / "key.pem")
    config = config_of(listen=[f"tls/localhost:{free_port()}"], cert=cert, key=key)
    routers.check(config, allows_everybody=False)
    settings: dict[str, Any] = {
        "connect/endpoints": list(config.listen),
        "listen/endpoints": [],
        "transport/auth/usrpwd/user": "r1",
        "transport/auth/usrpwd/password": PASSWORDS["r1"],
    }
    with routers.routing(config):
        with pytest.raises(zenoh.ZError):
            session(mode="client", **settings)
        trusted = {"transport/link/tls/root_ca_certificate": cert}
        with contextlib.closing(session(mode="client", **settings, **trusted)) as opened:
            assert opened.info.routers_zid()
