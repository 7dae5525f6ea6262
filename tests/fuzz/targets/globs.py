# SPDX-License-Identifier: Apache-2.0
"""Patterns of names, tokens, and the headers that say who a client is."""

import ipaddress

from websockets.datastructures import Headers
from websockets.exceptions import InvalidHeader

from gateway.access.credentials import CredentialsError, check_target, token_in
from gateway.access.permissions import compile_globs
from gateway.access.tokens import TokenFileError, from_json, to_json
from gateway.access.web_rules import WebRules, is_plain
from gateway.transport.forwarded import client_address
from gateway.transport.http import offered_subprotocols
from tests.access.test_globs import takes
from tests.fuzz.choices import Choices
from tests.fuzz.target import Target, check

ALLOWED = ("https://ui.example", "null")
RULES = WebRules(["localhost", "robot"], ["ui.example"], ALLOWED, allows_local=True)
PROXIES = [ipaddress.ip_network("127.0.0.0/8"), ipaddress.ip_network("fe80::/10")]
FILE = (
    b'{"version":1,"tokens":[{"name":"tablet","role":"operator","created":"2026-01-01",'
    b'"sha256":"' + b"0a" * 32 + b'"}]}'
)


def run(data: bytes) -> None:
    choices = Choices(data)
    match choices.byte() % 4:
        case 0:
            match_globs(choices)
        case 1:
            read_tokens(choices.rest())
        case 2:
            read_headers(choices)
        case 3:
            apply_rules(choices)


def match_globs(choices: Choices) -> None:
    globs = [glob(choices) for _ in range(choices.below(4))]
    name = "".join("/" + (segment(choices) or "a") for _ in range(1 + choices.below(6)))
    pattern = compile_globs(globs)
    got = pattern is not None and pattern.fullmatch(name) is not None
    expected = any(takes(each, name) for each in globs)
    check(got == expected, globs, name)


def glob(choices: Choices) -> str:
    segments = ["**" if choices.happens(64) else pattern(choices) for _ in range(choices.below(5))]
    return "**" if not segments else "".join(f"/{each}" for each in segments)


def pattern(choices: Choices) -> str:
    return "".join(choices.pick("aab*aab*.+[(") for _ in range(1 + choices.below(3)))


def segment(choices: Choices) -> str:
    return "".join(choices.pick("aab.") for _ in range(choices.below(4)))


def read_tokens(text: bytes) -> None:
    try:
        tokens = from_json(text)
    except TokenFileError as error:
        check(str(error))
        return
    check(from_json(to_json(tokens)) == tokens)
    names = [token.name for token in tokens.known]
    check(len(set(names)) == len(names), "two tokens of one name")
    check(tokens.find(text.decode("utf-8", "surrogateescape")) is None)


def read_headers(choices: Choices) -> None:
    headers = Headers()
    for _ in range(choices.below(5)):
        name = choices.pick(
            ("Forwarded", "X-Forwarded-For", "Sec-WebSocket-Protocol", "Authorization")
        )
        try:
            headers[name] = choices.octets().decode("latin-1")
        except InvalidHeader:  # the library would have refused the request
            return
    address = client_address("127.0.0.1", headers, PROXIES)
    check(address and len(address) < 64, address)
    try:
        token = token_in(headers.get_all("Authorization"), offered_subprotocols(headers))
    except CredentialsError:
        return
    check(token is None or token in " ".join(value for _, value in headers.raw_items()))


def apply_rules(choices: Choices) -> None:
    host = choices.octets().decode("latin-1")
    origin = choices.octets().decode("latin-1")
    target = choices.octets().decode("latin-1")
    is_plain(origin)
    try:
        is_own = RULES.is_own_host(host)
        standing = RULES.standing(origin, host, is_encrypted=bool(len(target) % 2))
        check_target(target)
    except ValueError:  # CredentialsError is one. Both are answered with 400
        return
    if standing != "foreign" and is_own:
        check(origin in ALLOWED or "http" in origin.lower(), origin)
    if standing == "local":
        check(any(name in origin for name in ("//localhost", "//127.0.0.1", "//[::1]")), origin)


def corpus() -> list[bytes]:
    return [
        b"\x01" + FILE,
        b"\x01{}",
        # /**/a/**/b and /ab/a/b: what is taken first must be a whole segment
        b"\x00\x01\x04\xff\x00\x00\x00\xff\x00\x00\x02" + b"\x02\x02\x00\x02\x01\x00\x01\x02",
        *(bytes((0, 1, number % 5)) + bytes(range(number, 255, 7)) for number in range(20)),
        b"\x00\x02\x02\xff\x02\x00\x02\x01\x01\x03\x00\x00\x01\x01\x01\x02\x00\x01",
        b'\x02\x02\x00\x2dfor=192.0.2.60;proto=http, for="[2001:db8::1]:47"',
        b"\x02\x01\x01\x1a192.0.2.60, 127.0.0.1, junk",
        b"\x02\x02\x02\x1eros2-gateway, bearer.r2g_secret\x03\x10Bearer r2g_secret",
        b"\x03\x0elocalhost:9090\x15http://localhost:9090/\x10/?token=r2g_abc1",
        b"\x03\x0b[::1]:90909\x12https://ui.example\x01/",
    ]


TARGET = Target("names match as the globs say, and no header or file raises", run, corpus)
