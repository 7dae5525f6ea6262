# SPDX-License-Identifier: Apache-2.0
"""The cause why a Zenoh router cannot be used. Zenoh itself says only that it cannot.

A connection by hand goes as far as it can: name, TCP, TLS, and the first message of Zenoh.
"""

import contextlib
import secrets
import socket
import ssl
from collections.abc import Mapping
from typing import Any, Final, NamedTuple

from gateway.errors import system_reason

STEP_S: Final = 3.0  # for each of name and TCP, TLS, and the first message
TLS: Final = "transport/link/tls"
USER: Final = "transport/auth/usrpwd"

# The first message of a session, and the answers to it: the length, and behind it the kind.
_LENGTH: Final = 2
_INIT, _CLOSE, _KIND = 0x01, 0x03, 0x1F
_VERSION: Final = 9
_CLIENT: Final = 0b10
_INVALID: Final = 2  # the reason of a close: the message is not understood
_ALERT: Final = b"\x15\x03"  # the answer of a port with TLS to anything else
_UNTRUSTED: Final = frozenset({18, 19, 20, 21})  # codes of OpenSSL: nobody who is trusted signed it
_EXPIRED: Final = frozenset({9, 10})
_OTHER_NAME: Final = frozenset({62, 64})


class Unusable(NamedTuple):
    """The fault, as the rest of a sentence that begins with the router, and the remedy."""

    what: str
    remedy: str  # begins with a verb


class Address(NamedTuple):
    """The parts of an address of Zenoh."""

    protocol: str
    host: str
    port: int | None


def address_of(endpoint: str) -> Address:
    """Return the parts of an address such as ``tls/router:7447``. The port may be missing."""
    protocol, _, rest = endpoint.partition("/")
    host, _, port = rest.partition("?")[0].partition("#")[0].rpartition(":")
    is_port = port.isdecimal() and int(port) < 2**16
    return Address(protocol, host.strip("[]"), int(port) if is_port else None)


def unusable(router: str, settings: Mapping[str, Any], section: str, start: str) -> Unusable | None:
    """Return why a router cannot be used. None: nothing is wrong as far as this goes.

    *settings* are those of Zenoh. A *section* of the configuration has given them, or if it is
    empty the variable of the environment. *start* is the remedy if nothing is there. This blocks.
    """
    address = address_of(router)
    if address.protocol not in {"tcp", "tls"} or address.port is None:
        return None
    named = _Named(section)
    try:
        raw = socket.create_connection((address.host, address.port), STEP_S)
    except socket.gaierror as error:
        what = f"cannot be reached, the name {address.host} is not known ({system_reason(error)})"
        return Unusable(what, "check the name, and the name server of this computer")
    except OSError as error:
        return Unusable(f"cannot be reached, {system_reason(error)}", start)
    with contextlib.closing(raw):
        raw.settimeout(STEP_S)
        if address.protocol == "tcp":
            return _asked(raw, settings, named)
        try:
            context = _context(settings)
        except OSError as error:
            what = f"cannot be asked, a file of its TLS is unusable ({system_reason(error)})"
            return Unusable(what, f"check {named('ca')}, {named('cert')} and {named('key')}")
        try:
            with context.wrap_socket(raw, server_hostname=address.host) as encrypted:
                return _asked(encrypted, settings, named)
        except ssl.SSLCertVerificationError as error:
            return _untrusted(error, address, named)
        except (OSError, EOFError):
            what = "does not answer with TLS"
            remedy = "give the router cert and key, or write tcp/ if its network is trusted"
            return Unusable(what, remedy)


class _Named:
    """The names of settings, for people."""

    _KEYS: Final = {
        "ca": f"{TLS}/root_ca_certificate",
        "cert": f"{TLS}/connect_certificate",
        "key": f"{TLS}/connect_private_key",
        "user": f"{USER}/user",
        "user_file": f"{USER}/password",
    }

    def __init__(self, section: str) -> None:
        self._section = section

    def __call__(self, name: str) -> str:
        return f"{self._section}.{name}" if self._section else self._KEYS[name]


def _context(settings: Mapping[str, Any]) -> ssl.SSLContext:
    context = ssl.create_default_context(cafile=settings.get(f"{TLS}/root_ca_certificate"))
    context.verify_flags &= ~ssl.VERIFY_X509_STRICT  # Zenoh accepts what openssl makes by default
    certificate = settings.get(f"{TLS}/connect_certificate")
    if certificate is not None:
        context.load_cert_chain(certificate, settings.get(f"{TLS}/connect_private_key"))
    return context


def _untrusted(error: ssl.SSLCertVerificationError, address: Address, named: _Named) -> Unusable:
    what = f"has a certificate that is refused here, {error.verify_message}"
    if error.verify_code in _UNTRUSTED:
        return Unusable(what, f"set {named('ca')} to the certificate that signed the router's")
    if error.verify_code in _OTHER_NAME:
        return Unusable(
            what, f"make another one with ros2-gateway cert --name {address.host} --replace"
        )
    if error.verify_code in _EXPIRED:
        return Unusable(what, "make another one for the router, and compare both clocks")
    return Unusable(what, "make another one for the router")


def _asked(link: socket.socket, settings: Mapping[str, Any], named: _Named) -> Unusable | None:
    """Begin a session of Zenoh without signing in, and see what the router says."""
    itself = secrets.token_bytes(16)
    begin = bytes([_INIT, _VERSION, (len(itself) - 1) << 4 | _CLIENT]) + itself
    try:
        link.sendall(len(begin).to_bytes(_LENGTH, "little") + begin)
        answer = link.recv(1024)
    except ssl.SSLError as error:
        return _refused_certificate(error, settings, named)
    except OSError as error:
        return Unusable(
            f"does not answer, {system_reason(error)}", "check that a router listens there"
        )
    return _answered(answer, settings, named)


def _answered(answer: bytes, settings: Mapping[str, Any], named: _Named) -> Unusable | None:
    if not answer:
        remedy = "check address and port, and how many sessions the router has and allows"
        return Unusable("closes the connection without an answer", remedy)
    if answer.startswith(_ALERT):
        return Unusable("needs TLS", "write tls/ in place of tcp/")
    kind = answer[_LENGTH] & _KIND if len(answer) > _LENGTH else None
    if kind == _INIT:
        return None
    if kind != _CLOSE:
        return Unusable("is another program", "check the address and the port")
    if answer[_LENGTH + 1 : _LENGTH + 2] == bytes([_INVALID]):
        return Unusable("has another version of Zenoh", "install the same version on both sides")
    user = settings.get(f"{USER}/user")
    if user is None:
        remedy = f"set {named('user')} and {named('user_file')}"
        return Unusable("asks for a name and a password", remedy)
    remedy = f"compare {named('user')} and {named('user_file')} with the file of the router"
    return Unusable(f"refuses the name {user!r} or its password", remedy)


def _refused_certificate(
    error: ssl.SSLError, settings: Mapping[str, Any], named: _Named
) -> Unusable:
    if settings.get(f"{TLS}/connect_certificate") is None:
        remedy = f"set {named('cert')} and {named('key')}"
        return Unusable("asks for a certificate of this computer", remedy)
    reason = (error.reason or str(error)).lower().replace("_", " ").rpartition("alert ")[2]
    what = f"refuses the certificate of this computer, {reason}"
    return Unusable(what, f"have {named('cert')} signed by the client_ca of the router")
