# SPDX-License-Identifier: Apache-2.0
"""A session with the router of a robot, and the nodes and tokens of this gateway in it."""

import itertools
import json
import threading
from collections.abc import Callable
from typing import Any, Final

import zenoh

from gateway.errors import RosStartError
from gateway.sources.source import Qos
from gateway.sources.zenoh.keys import DataKey
from gateway.sources.zenoh.options import ZenohOptions
from gateway.sources.zenoh.tokens import (
    PREFIX,
    EndpointKind,
    NodeToken,
    endpoint_token,
)
from gateway.sources.zenoh.unusable import unusable

# The router announces the end of a gateway that hangs after this time. rmw_zenoh's is 60 s.
LEASE_MS: Final = 2000
CLOSE_S: Final = 0.5
_SETTINGS: Final[dict[str, object]] = {
    "mode": "client",
    "listen/endpoints": [],
    "scouting/multicast/enabled": False,
    "timestamping/enabled": True,  # or latched publishers keep nothing
    "transport/shared_memory/enabled": False,  # as rmw_zenoh has it
    "transport/link/tx/lease": LEASE_MS,
}


class RouterError(RosStartError):
    """Raised if a router cannot be used. *what* is a sentence, and *remedy* begins with a verb."""

    def __init__(self, what: str, remedy: str) -> None:
        super().__init__(f"{what}: {remedy}")
        self.what, self.remedy = what, remedy


def open_session(options: ZenohOptions) -> Any:
    """Connect to the router. This blocks until then.

    Raises:
        RosStartError: the router cannot be reached or refuses, or an override is wrong.
    """
    config = zenoh.Config()
    settings = {**_SETTINGS, "connect/endpoints": [options.router], **options.settings}
    if options.namespace:
        settings["namespace"] = options.namespace
    values = {key: json.dumps(value) for key, value in settings.items()}
    for assignment in filter(None, map(str.strip, options.overrides.split(";"))):
        key, _, value = assignment.partition("=")
        values[key] = value
    for key, value in values.items():
        try:
            config.insert_json5(key, value)
        except zenoh.ZError as error:
            what = f"Zenoh does not accept {key}={value}"
            remedy = f"correct {options.given_by}"
            raise RosStartError(f"{what} ({first_line(error)}): {remedy}") from error
    try:
        return zenoh.open(config)
    except zenoh.ZError as error:
        what, remedy = f"cannot be reached ({first_line(error)})", options.remedy
        read = {key: _value(text) for key, text in values.items()}
        found = unusable(options.router, read, options.section, options.remedy)
        if found is not None:
            what, remedy = found
        raise RouterError(f"the Zenoh router {options.router} {what}", remedy) from error


def _value(text: str) -> Any:
    try:
        return json.loads(text)
    except ValueError:  # Zenoh accepts more than JSON
        return text.strip("'")


class ZenohSession:
    """The session of a gateway: its nodes, and the tokens by which others see its endpoints."""

    def __init__(self, session: Any, domain_id: int) -> None:
        self.zenoh = session
        self.domain_id = domain_id
        self.id = str(session.info.zid())
        self._liveliness = session.liveliness()
        self._ids = itertools.count()
        self.nodes: dict[str, NodeToken] = {}
        self.tokens: dict[str, Any] = {}  # ours that are declared

    @property
    def is_connected(self) -> bool:
        """True while the router answers."""
        return bool(self.zenoh.info.routers_zid())

    def add_node(self, node: str) -> NodeToken:
        """Declare a node by its full name."""
        token = NodeToken(self.domain_id, self.id, next(self._ids), node)
        self.nodes[node] = token
        self._declare(token.text)
        return token

    def add_endpoint(
        self, node: str, kind: EndpointKind, key: DataKey, qos: Qos, backends: str | None = None
    ) -> str:
        """Declare an endpoint of a node. Return its token, which `remove` takes."""
        text = endpoint_token(self.nodes[node], next(self._ids), kind, key, qos, backends)
        self._declare(text)
        return text

    def remove(self, token: str) -> None:
        """Withdraw a token. Twice is harmless."""
        declared = self.tokens.pop(token, None)
        if declared is not None:
            declared.undeclare()

    def watch_tokens(self, on_token: Callable[[str, bool], None], which: str = "**") -> Any:
        """Report each token of the domain that is there, comes or goes, on Zenoh's threads.

        *which* is their part after the domain.
        """

        def arrive(sample: Any) -> None:
            on_token(str(sample.key_expr), sample.kind == zenoh.SampleKind.PUT)

        key = f"{PREFIX}/{self.domain_id}/{which}"
        return self._liveliness.declare_subscriber(key, arrive, history=True)

    def data_key(self, name: str, type_name: str, type_hash: str) -> DataKey:
        """Return the key of a topic or a service."""
        return DataKey(self.domain_id, name, type_name, type_hash)

    def close(self, within_s: float = CLOSE_S) -> None:
        """End the session, and so all that it has."""
        tokens, self.tokens = self.tokens, {}
        close_session(self.zenoh, tokens, within_s)

    def _declare(self, text: str) -> None:
        self.tokens[text] = self._liveliness.declare_token(text)


def close_session(
    session: Any, tokens: dict[str, Any] | None = None, within_s: float = CLOSE_S
) -> None:
    """End a session of Zenoh. This takes some milliseconds.

    A router that hangs keeps Zenoh for 10 s. Then its threads may call for longer than this.
    """

    def close() -> None:
        if tokens is not None:
            tokens.clear()  # a token withdraws itself
        session.close()

    closing = threading.Thread(target=close, name="zenoh_close", daemon=True)
    closing.start()
    closing.join(within_s)


def first_line(error: Exception) -> str:
    """Return what people can read of an error: a place in Zenoh's own source follows it."""
    return str(error).strip().split("\n", 1)[0].partition(" at /")[0].strip()[:200]
