# SPDX-License-Identifier: Apache-2.0
"""Checks of a running gateway, by its public health, and by the questions of a viewer."""

import argparse
import http.client
import json
import ssl
import time
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from typing import Any, Final
from urllib.parse import urlsplit

from gateway.cli.doctor.finding import Finding, FindingLevel, Note, Result, Results
from gateway.cli.doctor.ros_checks import is_of_robot
from gateway.cli.remote_connection import (
    Gateway,
    RemoteConnection,
    connected,
    gateway_of,
    tls_context,
)
from gateway.errors import GatewayError, UsageError, system_reason
from gateway.log_fields import counted

APART_S: Final = 0.5  # between two clocks: transforms and commands then look old
MAX_HEALTH_BYTES: Final = 64 * 1024
_SCHEMES: Final = {"ws": "ws", "http": "ws", "wss": "wss", "https": "wss"}
_LEVELS: Final[Mapping[int, FindingLevel]] = {1: "warning", 2: "error"}
_LOG: Final = "Read the log on the robot, such as `journalctl -u ros2-gateway -e`"
_ONLY_THERE: Final = (
    "a gateway does not tell about shared memory, permissions, ports, NumPy, DDS profile, uplink,"
    " or disk: run `ros2-gateway doctor` on the robot"
)


def remote_gateway(arguments: argparse.Namespace, environment: Mapping[str, str]) -> Gateway:
    """Return the gateway that ``--from`` names, also by the address of its page.

    Raises:
        UsageError: it is not an address.
    """
    gateway = gateway_of(arguments, environment)
    scheme, _, rest = gateway.url.partition("://")
    if scheme not in _SCHEMES or not rest:
        raise UsageError(f"--from: got {gateway.url!r}, expected ws://HOST:PORT or wss://HOST:PORT")
    return replace(gateway, url=f"{_SCHEMES[scheme]}://{rest}")


def remote_results(gateway: Gateway) -> list[tuple[str, list[Result]]]:
    """Ask a gateway one thing after another. Each answer has the timeout of the gateway."""
    health = list(_health(gateway))
    results: list[tuple[str, list[Result]]] = [("health", health)]
    if any(isinstance(each, Note) for each in health):
        results += _asked(gateway)
    return [*results, ("on the robot", [Note(_ONLY_THERE)])]


def _asked(gateway: Gateway) -> Iterator[tuple[str, list[Result]]]:
    try:
        with connected(gateway) as connection:
            connection.ask(_call("/rosapi/get_time"))
            for name, check in CHECKS.items():
                yield name, list(_answered(check, connection))
    except GatewayError as error:
        why = "The gateway does not answer questions of this client"
        advice = "Make a token on the robot by `token create`, and name its file by --token-file"
        yield (
            "access",
            [Finding("error", str(error), why, advice)],
        )


def _answered(
    check: Callable[[RemoteConnection], Results], connection: RemoteConnection
) -> Results:
    try:
        yield from check(connection)
    except (KeyError, TypeError, ValueError) as error:
        what = f"the answer is not that of ros2-gateway ({type(error).__name__}: {error})"
        why = "Another program, or another version of the gateway, answers"
        yield Finding("error", what, why, "Check the address, and use the same version here")
    except GatewayError as error:
        why = "The gateway refused this, or did not answer in time"
        yield Finding(
            "warning", str(error), why, "Use a token whose role may do this, or try again"
        )


def _health(gateway: Gateway) -> Results:
    try:
        answer = _read_health(gateway)
        status, ready, reasons = answer["status"], answer["ready"], answer["reasons"]
    except (OSError, http.client.HTTPException, ValueError, KeyError, TypeError) as error:
        yield _unreachable(gateway.url, error)
        return
    yield Note(f"version {answer.get('version', 'unknown')}, {status}")
    for reason in reasons:
        level: FindingLevel = "warning" if ready else "error"
        yield Finding(level, str(reason), f"The gateway is {status}", _LOG)


def _read_health(gateway: Gateway) -> dict[str, Any]:
    parts = urlsplit(gateway.url)
    host, timeout_s = parts.hostname or "", gateway.timeout_s
    tls = tls_context(gateway)
    connection = (
        http.client.HTTPConnection(host, parts.port, timeout=timeout_s)
        if tls is None
        else http.client.HTTPSConnection(host, parts.port, timeout=timeout_s, context=tls)
    )
    try:
        connection.request("GET", "/healthz")
        response = connection.getresponse()
        text = response.read(MAX_HEALTH_BYTES).decode(errors="replace")
    finally:
        connection.close()
    if not text.lstrip().startswith("{"):
        raise ValueError(f"{response.status} {response.reason}, {text.strip()[:200]}".rstrip(", "))
    answer: dict[str, Any] = json.loads(text)
    return answer


def _unreachable(url: str, error: Exception) -> Finding:
    reason = system_reason(error) if isinstance(error, OSError) else str(error)
    what = f"{url} does not answer as a gateway ({reason or type(error).__name__})"
    if isinstance(error, ssl.SSLError):
        why = "The certificate is not trusted here, or the port has no TLS"
        return Finding("error", what, why, "Name its cert.pem by --ca, or use ws:// without TLS")
    if isinstance(error, ConnectionResetError) or not isinstance(error, OSError):
        why = "Another program answers there, the port needs wss://, or this name is not allowed"
        return Finding("error", what, why, "Use the address and the port that the gateway shows")
    why = "It does not run, listens only on its machine, or a firewall is between"
    if urlsplit(url).port is None:
        advice = f"Add the port of the gateway, such as {url.rstrip('/')}:9090"
    else:
        advice = "Start it with --lan, and allow its TCP port in the firewall of the robot"
    return Finding("error", what, why, advice)


def _ros(connection: RemoteConnection) -> Results:
    answer = connection.ask(_call("/rosapi/get_ros_version"))
    yield Note(f"the robot has ROS 2 {answer['values']['distro']}")


def _clock(connection: RemoteConnection) -> Results:
    before_s = time.time()
    stamp = connection.ask(_call("/rosapi/get_time"))["values"]["time"]
    after_s = time.time()
    apart_s = stamp["sec"] + stamp["nanosec"] / 1e9 - (before_s + after_s) / 2
    text = f"the clock of the robot differs by {apart_s:+.1f} s"
    if abs(apart_s) > APART_S + (after_s - before_s) / 2:
        why = "One of the two clocks is wrong, or the robot has the time of a simulation"
        yield Finding("warning", text, why, "Synchronize both computers with one time server")
    else:
        yield Note(text)


def _discovery(connection: RemoteConnection) -> Results:
    nodes = connection.ask(_call("/rosapi/nodes"))["values"]["nodes"]
    # the gateway lists itself also as rosapi, as rosbridge does
    others = [each for each in nodes if is_of_robot(each, "ros2_gateway") and each != "/rosapi"]
    if others:
        yield Note(f"the gateway sees {counted(len(others), 'node')} of the robot")
        return
    yield Finding(
        "warning",
        "the gateway sees no node of a robot",
        "The robot is not started, or has another domain, middleware, or network",
        "Run `ros2-gateway doctor` on the robot, in the shell that starts its nodes",
    )


def _diagnosis(connection: RemoteConnection) -> Results:
    message = connection.first_message("/diagnostics", _is_of_gateway)
    for status in message["status"]:
        level = _LEVELS.get(status["level"])
        if level is not None:
            component = status["name"].partition(": ")[2]
            why = "The gateway reports this on /diagnostics"
            yield Finding(level, f"{component}: {status['message']}", why, _LOG)
    yield Note(f"{len(message['status'])} components of the gateway report")


def _is_of_gateway(message: Mapping[str, Any]) -> bool:
    return any(each["name"].endswith(": event loop") for each in message["status"])


def _call(service: str) -> dict[str, object]:
    return {"op": "call_service", "service": service, "args": {}}


CHECKS: Final[Mapping[str, Callable[[RemoteConnection], Results]]] = {
    "ROS": _ros,
    "clock": _clock,
    "discovery": _discovery,
    "diagnosis": _diagnosis,
}
