# SPDX-License-Identifier: Apache-2.0
"""A router of Zenoh in this process, which robots and relays connect to."""

import contextlib
import ipaddress
import json
import logging
import os
import signal
import socket
import ssl
import stat
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, Final

import zenoh

from gateway.ending_signals import ENDING
from gateway.errors import BindError, ConfigError, RosStartError, system_reason
from gateway.relay.router_file import RouterConfig
from gateway.relay.router_rules import access_control
from gateway.sources.zenoh.session import LEASE_MS, close_session, first_line
from gateway.sources.zenoh.unusable import address_of

logger = logging.getLogger("gateway")

# Each robot has 3 sessions, and a relay one for each robot
MAX_SESSIONS: Final = 10_000
_STREAMS: Final = frozenset({"tcp", "tls", "ws", "wss"})


def settings_of(config: RouterConfig, passwords: str | None = None) -> dict[str, Any]:
    """Return the settings of Zenoh. *passwords* is the file with a line for each name."""
    settings: dict[str, Any] = {
        "mode": "router",
        "listen/endpoints": list(config.listen),
        "scouting/multicast/enabled": False,
        "timestamping/enabled": True,
        "transport/shared_memory/enabled": False,
        "transport/link/tx/lease": LEASE_MS,
        "transport/unicast/max_sessions": MAX_SESSIONS,
    }
    tls = "transport/link/tls"
    if config.cert is not None:
        settings[f"{tls}/listen_certificate"] = config.cert
        settings[f"{tls}/listen_private_key"] = config.key
    if config.client_ca is not None:
        settings[f"{tls}/root_ca_certificate"] = config.client_ca
        settings[f"{tls}/enable_mtls"] = True
    if passwords is not None:
        settings["transport/auth/usrpwd/dictionary_file"] = passwords
    if not config.is_open:
        settings["access_control"] = access_control(config)
    return settings


def check(config: RouterConfig, *, allows_everybody: bool) -> None:
    """Check what Zenoh would not report well, or at all.

    Raises:
        ConfigError: a file is unusable, or the router would be open to a network.
        BindError: a port is in use.
    """
    if config.is_open and not allows_everybody and not all(map(_is_local, config.listen)):
        raise ConfigError(
            "everybody who reaches the router could see and drive the robots: name robots and"
            " relays in --config, or listen on 127.0.0.1, or add --open"
        )
    if config.cert is not None and config.key is not None:
        try:
            ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER).load_cert_chain(config.cert, config.key)
        except ssl.SSLError as error:
            what = f"cert and key do not fit together, {error.reason or error}"
            raise ConfigError(f"{what}: make both again, such as with ros2-gateway cert") from error
        except OSError as error:
            text = f"cert or key cannot be read, {system_reason(error)}: {config.cert}"
            raise ConfigError(f"{text}, {config.key}") from error
    if config.client_ca is not None and not Path(config.client_ca).is_file():
        raise ConfigError(f"client_ca: {config.client_ca} is missing: name the file that signs")
    for endpoint in config.listen:
        _check_port(endpoint)


def warnings(config: RouterConfig, file: Path | None) -> Iterator[str]:
    """Yield what is dangerous, though it may be meant."""
    away = [each for each in config.listen if not _is_local(each)]
    if config.is_open and away:
        yield f"everybody who reaches {away[0]} can see and drive the robots"
    if any(each.partition("/")[0] != "tls" for each in away):
        yield "without tls/, others on the network can read and change what is sent"
    if file is not None and config.passwords and os.name == "posix":
        mode = stat.S_IMODE(file.stat().st_mode)
        if mode & 0o077:
            yield f"other users can read the passwords in {file}: run  chmod 600 {file}"


@contextlib.contextmanager
def routing(config: RouterConfig) -> Iterator[Any]:
    """Run a router inside the context.

    Raises:
        RosStartError: Zenoh refuses the settings.
    """
    with contextlib.ExitStack() as stack:
        passwords = None
        if config.passwords:
            passwords = stack.enter_context(_password_file(config.passwords))
        made = zenoh.Config()
        try:
            for key, value in settings_of(config, passwords).items():
                made.insert_json5(key, json.dumps(value))
            session = zenoh.open(made)
        except zenoh.ZError as error:
            text = f"the router cannot start, {first_line(error)}"
            raise RosStartError(f"{text}: check its addresses and certificates") from error
        stack.callback(close_session, session)
        yield session


def run(config: RouterConfig, announce: Callable[[], None]) -> int:
    """Run a router until a signal. Return the exit code."""
    signal.pthread_sigmask(signal.SIG_BLOCK, ENDING)
    with routing(config):
        announce()
        signal.sigwait(ENDING)
        logger.info("shutting down")
    return 0


@contextlib.contextmanager
def _password_file(passwords: dict[str, str]) -> Iterator[str]:
    """Write the passwords where only this user can read them. Zenoh reads them once."""
    with tempfile.NamedTemporaryFile("w", prefix="ros2-gateway-", encoding="utf-8") as file:
        file.writelines(f"{name}:{password}\n" for name, password in passwords.items())
        file.flush()
        yield file.name


def _host_and_port(endpoint: str) -> tuple[str, int]:
    address = address_of(endpoint)
    if address.port is None:
        raise ConfigError(f"--listen: got {endpoint}, expected a port such as tcp/127.0.0.1:7447")
    return address.host, address.port


def _is_local(endpoint: str) -> bool:
    host, _ = _host_and_port(endpoint)
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return host == "localhost"


def _check_port(endpoint: str) -> None:
    if endpoint.partition("/")[0] not in _STREAMS:
        return
    host, port = _host_and_port(endpoint)
    try:
        family, _, _, _, address = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0]
        with socket.socket(family) as probe:
            probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            probe.bind(address)
    except OSError as error:
        raise BindError(host, port, error) from error
