# SPDX-License-Identifier: Apache-2.0
"""The liveliness tokens of rmw_zenoh: the nodes and endpoints of the graph, each a key.

``@ros2_lv/domain/session/node id/id/kind/enclave/namespace/node``, and for an endpoint also
``/name/type/hash/qos``. In each part, ``/`` is written as ``%``.
"""

import re
import struct
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final, Literal, NamedTuple, get_args

import xxhash

from gateway.sources.source import Qos
from gateway.sources.zenoh.keys import (
    MAX_KEY_CHARACTERS,
    DataKey,
    WireError,
    checked_hash,
    dds_type,
    number,
    ros_type,
)
from gateway.sources.zenoh.qos_text import TokenQos, parse_qos, qos_text

EndpointKind = Literal["MP", "MS", "SS", "SC"]  # publisher, subscription, server, client
PREFIX: Final = "@ros2_lv"
NODE_KIND: Final = "NN"
_KINDS: Final[Mapping[str, EndpointKind]] = {each: each for each in get_args(EndpointKind)}
_NODE_PARTS: Final = 9
_ENDPOINT_PARTS: Final = 13  # since Lyrical one more, which says where buffers may be
_BACKENDS: Final = "backends:"
CPU: Final = f"{_BACKENDS}cpu:"  # of a subscription that reads buffers where the CPU can
_ROOT: Final = "%"  # the namespace, and the enclave that nobody has set

_NAME: Final = re.compile(r"(?:%[A-Za-z_][A-Za-z0-9_]*)+", re.ASCII)
_NODE: Final = re.compile(r"[A-Za-z_][A-Za-z0-9_]*", re.ASCII)
_SESSION: Final = re.compile(r"[0-9a-f]{1,32}", re.ASCII)


class NodeToken(NamedTuple):
    """The token of a node, or the beginning of that of an endpoint."""

    domain_id: int
    session: str
    node_id: int  # within its session
    node: str  # the full name
    enclave: str = "/"

    @property
    def text(self) -> str:
        """The token of the node. See also `parse_token`."""
        return self.text_of(NODE_KIND, self.node_id)

    def text_of(self, kind: str, entity_id: int) -> str:
        """Return the beginning of a token of this node, without a slash at its end."""
        namespace, _, name = self.node.rpartition("/")
        parts = (self.domain_id, self.session, self.node_id, entity_id, kind)
        names = (_escaped(self.enclave), _escaped(namespace or "/"), name)
        return "/".join((PREFIX, *map(str, parts), *names))


@dataclass(frozen=True, slots=True)
class EndpointToken:
    """A publisher, a subscription, a server or a client."""

    of: NodeToken
    entity_id: int
    kind: EndpointKind
    key: DataKey
    qos: TokenQos
    gid: bytes  # its id in attachments
    has_buffers: bool = False  # of Lyrical


def parse_token(text: str) -> NodeToken | EndpointToken:
    """Return the node or the endpoint that a token stands for.

    Raises:
        WireError: it is another token.
    """
    if len(text) > MAX_KEY_CHARACTERS:
        raise WireError(f"token has {len(text)} characters, at most {MAX_KEY_CHARACTERS}")
    parts = text.split("/")
    if len(parts) < _NODE_PARTS or parts[0] != PREFIX:
        raise WireError(f"not a token of ROS: {text[:80]!r}")
    _, domain, session, node_id, entity_id, kind, enclave, namespace, name = parts[:_NODE_PARTS]
    is_named = (namespace == _ROOT or _NAME.fullmatch(namespace)) and _NODE.fullmatch(name)
    if not is_named or not _SESSION.fullmatch(session):
        raise WireError(f"not a node of ROS: {text[:120]!r}")
    before = "" if namespace == _ROOT else _unescaped(namespace)
    node = NodeToken(
        number(domain, "domain"),
        session,
        number(node_id, "node"),
        f"{before}/{name}",
        _unescaped(enclave),
    )
    entity = number(entity_id, "entity")
    if kind == NODE_KIND and len(parts) == _NODE_PARTS:
        return node
    if kind not in _KINDS or len(parts) < _ENDPOINT_PARTS:
        raise WireError(f"not a kind of endpoint: {text[:120]!r}")
    return _endpoint(node, entity, _KINDS[kind], parts[_NODE_PARTS:], text)


def endpoint_token(
    node: NodeToken,
    entity_id: int,
    kind: EndpointKind,
    key: DataKey,
    qos: Qos,
    backends: str | None = None,
) -> str:
    """Return the token of an endpoint of this gateway."""
    parts = [_escaped(key.name), dds_type(key.type_name), key.type_hash, qos_text(qos)]
    parts += [] if backends is None else [backends]
    return "/".join((node.text_of(kind, entity_id), *parts))


def tokens_of(topic: str) -> str:
    """Return the pattern of a topic's tokens: their part after the domain."""
    return "/".join(("*",) * (_NODE_PARTS - 2) + (_escaped(topic), "**"))


def gid_of(token: str) -> bytes:
    """Return the id that an endpoint with this token has in attachments."""
    value = xxhash.xxh3_128_intdigest(token.encode())
    return struct.pack("<QQ", value & 0xFFFF_FFFF_FFFF_FFFF, value >> 64)


def _endpoint(
    node: NodeToken, entity_id: int, kind: EndpointKind, parts: list[str], text: str
) -> EndpointToken:
    name, type_name, type_hash, qos, *more = parts
    if not _NAME.fullmatch(name):
        raise WireError(f"not a name of ROS: {name[:80]!r}")
    key = DataKey(
        node.domain_id, _unescaped(name), ros_type(_unescaped(type_name)), checked_hash(type_hash)
    )
    has_buffers = any(each.startswith(_BACKENDS) for each in more[:1])
    return EndpointToken(node, entity_id, kind, key, parse_qos(qos), gid_of(text), has_buffers)


def _escaped(text: str) -> str:
    return text.replace("/", "%")


def _unescaped(text: str) -> str:
    return text.replace("%", "/")
