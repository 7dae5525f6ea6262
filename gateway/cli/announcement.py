# SPDX-License-Identifier: Apache-2.0
"""The announcement of a gateway that listens: lines that can be pasted into clients, a QR code."""

import io
import os
import shlex
import socket
import sys
import threading
import time
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Final
from urllib.parse import urlsplit

from gateway.access.posture import EVERYWHERE, LOOPBACKS
from gateway.cli.logs import json_line
from gateway.cli.tokens import how_to_add

if TYPE_CHECKING:
    from gateway.app import Listening


_WARNING: Final = "WARNING: "
_NO_ADDRESS: Final = "no default route: run `ip -br address` to see this machine's addresses"
_WHO: Final = {"viewer": "watch", "operator": "drive the robot", "admin": "do everything"}


def announcement(listening: "Listening") -> str:
    """Return the lines for people."""
    return "\n".join(_lines(listening, own_addresses()))


def in_json(listening: "Listening", text: str) -> Iterator[str]:
    """Yield the lines of a text in JSON."""
    for line in text.splitlines():
        level = "warning" if line.startswith(_WARNING) else "info"
        message = line.removeprefix(_WARNING).strip()
        yield json_line(time.time(), level, "gateway", message, url=own_url(listening))


def filled(hint: str, listening: "Listening") -> str:
    """Return a hint, in which WSCAT and PAGE stand for how to connect from this machine."""
    page = own_page(listening) + _fragment(listening)
    return hint.replace("WSCAT", _wscat(listening, own_url(listening))).replace("PAGE", page)


def own_page(listening: "Listening") -> str:
    """Return the address of the page on this machine, without a token."""
    return _page_url(listening, urlsplit(own_url(listening)).hostname or "", "/")


def qr_text(listening: "Listening", addresses: Sequence[str]) -> str | None:
    """Return the content of the QR code, ``None`` if there is no address for it.

    A phone's camera opens only web addresses, not ``ws://``, so this is the address of a page. A
    token is in the fragment, which browsers do not send. It is there only if it is new, because
    then it also stands next to the code in clear text.
    """
    host = next((host for host in _hosts(listening, addresses) if host not in EVERYWHERE), None)
    if host is None:
        return None
    return _page_url(listening, host, listening.path) + _fragment(listening)


def qr_code(text: str) -> str:
    """Draw a QR code for a terminal."""
    import segno

    drawn = io.StringIO()
    segno.make(text, micro=False).terminal(out=drawn, compact=True)
    return drawn.getvalue()


def own_url(listening: "Listening") -> str:
    """Return the address that a person on this machine types."""
    host = listening.addresses[0][0]
    return _url(listening, "localhost" if host in EVERYWHERE or host == "127.0.0.1" else host)


def own_addresses() -> list[str]:
    """Return this machine's address on its default route, if it has one."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            # connecting a datagram socket sends nothing: it asks the routing table
            probe.connect(("192.0.2.1", 9))
        except OSError:
            return []
        return [probe.getsockname()[0]]


def open_page(url: str) -> bool:
    """Open a page if the output goes to a terminal of a desktop, and return whether that is tried.

    It runs in a thread, because a browser may take seconds to start. Its failure does not matter,
    because the address is also printed.
    """
    desktop = os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")
    if not desktop or not sys.stdout.isatty():
        return False
    import webbrowser

    threading.Thread(target=webbrowser.open, args=(url,), name="browser", daemon=True).start()
    return True


def _lines(listening: "Listening", addresses: Sequence[str]) -> Iterator[str]:
    """Yield where to connect: with an address that can be typed into a headset, if there is one."""
    if any(host in EVERYWHERE for host, _ in listening.addresses):
        yield f"listening on every network of this machine, port {listening.port}"
        yield f"  on this machine   {own_url(listening)}"
        for address in addresses:
            yield f"  from a headset    {_url(listening, address)}"
        if not addresses:
            yield f"  from a headset    {_url(listening, 'ADDRESS')}   {_NO_ADDRESS}"
    else:
        for host, _ in listening.addresses[:1] if _is_here(listening) else listening.addresses:
            yield f"listening on {_url(listening, host)}"
    if listening.tls_port is not None:
        page = _tls_page(listening, addresses)
        yield f"  for VR, by TLS    {page}   the browser warns about its certificate once"
    if listening.posture.needs_token:
        yield from _token_lines(listening, addresses)
    elif listening.posture.is_open:
        role = listening.posture.anonymous_role or ""
        yield f"{_WARNING}without a token, everybody on the network may {_WHO.get(role, 'watch')}"


def _token_lines(listening: "Listening", addresses: Sequence[str]) -> Iterator[str]:
    host = next(iter(_hosts(listening, addresses)), "localhost")
    url = _url(listening, "localhost" if host in EVERYWHERE else host)
    why = "other machines can connect, so " if listening.posture.is_open else ""
    if listening.new_token:
        yield f"{why}clients need a token. This one is for an operator, and shown only once:"
    elif listening.token_in:
        yield f"{why}clients need a token. A new one, for an operator, is in {listening.token_in}"
    else:
        yield f"{why}clients need a token. The hashes of the valid ones are in {listening.tokens}"
    yield f"  wscat   {_wscat(listening, url)}"
    token = f"in {listening.token_in}" if listening.token_in else listening.new_token or "TOKEN"
    yield f"  Unity   Address: {url}   Token: {token}"
    yield f"  more    {how_to_add(listening.tokens, os.environ)}"


def _wscat(listening: "Listening", url: str) -> str:
    command = f"npx wscat -c {url}"
    if listening.is_encrypted:
        command += f" --ca {shlex.quote(listening.certificate or '')}"
    if listening.token_in:
        command += f' -H "Authorization: Bearer $(cat {shlex.quote(str(listening.token_in))})"'
    elif listening.posture.needs_token:
        command += f" -H 'Authorization: Bearer {listening.new_token or 'TOKEN'}'"
    return command


def _tls_page(listening: "Listening", addresses: Sequence[str]) -> str:
    host = next(
        (each for each in _hosts(listening, addresses) if each not in EVERYWHERE), "localhost"
    )
    return f"https://{_host(host)}:{listening.tls_port}/"


def _page_url(listening: "Listening", host: str, path: str) -> str:
    scheme = "https" if listening.is_encrypted else "http"
    return f"{scheme}://{_host(host)}:{listening.port}{path}"


def _fragment(listening: "Listening") -> str:
    return f"#token={listening.new_token}" if listening.new_token else ""


def _hosts(listening: "Listening", addresses: Sequence[str]) -> list[str]:
    hosts = [host for host, _ in listening.addresses]
    return [*addresses, *hosts] if any(host in EVERYWHERE for host in hosts) else hosts


def _is_here(listening: "Listening") -> bool:
    """Return whether its addresses are two names of this machine alone."""
    return {host for host, _ in listening.addresses} == set(LOOPBACKS)


def _url(listening: "Listening", host: str) -> str:
    scheme = "wss" if listening.is_encrypted else "ws"
    return f"{scheme}://{_host(host)}:{listening.port}{listening.path}"


def _host(host: str) -> str:
    return f"[{host}]" if ":" in host else host
