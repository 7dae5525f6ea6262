# SPDX-License-Identifier: Apache-2.0
"""The check of the TCP ports that the gateway listens on."""

import contextlib
import errno
import http.client
import json
import re
import socket
import ssl
from collections.abc import Iterator
from pathlib import Path
from typing import Final

from gateway.access.posture import posture_of
from gateway.cli.doctor.finding import Finding, Note, Results
from gateway.cli.doctor.machine import Machine
from gateway.cli.service import UNIT
from gateway.errors import BindError

_TABLES: Final = (Path("/proc/net/tcp"), Path("/proc/net/tcp6"))
_LISTENS: Final = "0A"  # TCP_LISTEN
_ANSWER_S: Final = 2
_SERVES: Final = re.compile(r"(/ros2-gateway|-m gateway) (serve|demo|play)\b")
_SOCKET: Final = re.compile(r"socket:\[(\d+)\]")


def ports(machine: Machine) -> Results:
    """Check whether the gateway can listen on its ports, and name the program that already does."""
    config = machine.config
    for port in (config.port, config.tls.port):
        if not port:  # unset, or any free one
            continue
        faults = [fault for host in posture_of(config).hosts if (fault := _fault(host, port))]
        if not faults:
            yield Note(f"port {port} is free")
        elif faults[0][1].errno == errno.EADDRINUSE and _is_gateway(faults[0][0], port):
            yield Note(f"a gateway listens on port {port}")
        else:
            yield _finding(faults[0], port)


def gateway_runs(machine: Machine) -> bool:
    """Return whether a gateway answers on the port of the configuration."""
    port = machine.config.port
    hosts = posture_of(machine.config).hosts
    return bool(port) and any(_is_gateway(host, port) for host in hosts)


def _fault(host: str, port: int) -> tuple[str, OSError] | None:
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    try:
        with socket.socket(family, socket.SOCK_STREAM) as probe:
            probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            if family == socket.AF_INET6:
                probe.setsockopt(socket.IPPROTO_IPV6, socket.IPV6_V6ONLY, 1)
            probe.bind((host, port))
            probe.listen()
    except OSError as error:
        has_no_ipv6 = family == socket.AF_INET6 and error.errno != errno.EADDRINUSE
        return None if has_no_ipv6 else (host, error)
    return None


def _finding(fault: tuple[str, OSError], port: int) -> Finding:
    host, error = fault
    what, _, why = str(BindError(host, port, error)).partition(", ")
    if error.errno != errno.EADDRINUSE:
        return Finding("error", what, why, "Set `host` and `port` to what this machine can open")
    process, command = next(_holders(port), ("", ""))
    holder = f"process {process} ({command[:80]})"
    if _SERVES.search(command):
        return Finding(
            "error",
            f"the gateway on port {port} does not answer",
            f"P{holder[1:]} hangs or is stopped",
            f"Read its log, and restart it. For a service: `sudo systemctl restart {UNIT.stem}`",
        )
    if not process:
        holder = "a program that this user cannot see, so try with sudo"
    advice = "End that program, or choose another port with --port or in a file"
    return Finding("error", what, f"It is in use by {holder}", advice)


def _holders(port: int) -> Iterator[tuple[str, str]]:
    """Yield id and command of what listens on a port. Only root sees those of other users."""
    inodes = set(_inodes(port))
    for process in Path("/proc").glob("[0-9]*"):
        with contextlib.suppress(OSError):  # it has ended, or belongs to another user
            if inodes & set(_sockets(process)):
                command = (process / "cmdline").read_bytes().decode(errors="replace")
                yield process.name, command.replace("\0", " ").strip()


def _sockets(process: Path) -> Iterator[str]:
    for link in (process / "fd").iterdir():
        with contextlib.suppress(OSError):  # it is closed by now
            found = _SOCKET.fullmatch(str(link.readlink()))
            if found:
                yield found[1]


def _inodes(port: int) -> Iterator[str]:
    for table in _TABLES:
        try:
            rows = table.read_text(encoding="ascii").splitlines()[1:]
        except OSError:
            continue
        for row in rows:
            columns = row.split()
            if columns[3] == _LISTENS and int(columns[1].rpartition(":")[2], 16) == port:
                yield columns[9]


def _is_gateway(host: str, port: int) -> bool:
    """Return whether one answers there, with TLS or without."""
    host = {"0.0.0.0": "127.0.0.1", "::": "::1"}.get(host, host)  # noqa: S104  # it is not bound
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
    context.check_hostname = False
    context.verify_mode = ssl.CERT_NONE  # it is asked for nothing but its health
    plain = http.client.HTTPConnection(host, port, timeout=_ANSWER_S)
    secure = http.client.HTTPSConnection(host, port, timeout=_ANSWER_S, context=context)
    return _answers(plain) or _answers(secure)


def _answers(connection: http.client.HTTPConnection) -> bool:
    try:
        connection.request("GET", "/healthz")
        answer = json.loads(connection.getresponse().read(64 * 1024))
    except (OSError, http.client.HTTPException, ValueError):
        return False
    finally:
        connection.close()
    return isinstance(answer, dict) and {"live", "ready", "reasons"} <= answer.keys()
