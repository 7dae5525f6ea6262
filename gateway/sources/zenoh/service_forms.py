# SPDX-License-Identifier: Apache-2.0
"""Services as Zenoh carries them: CDR, with the hash of their type, checked before it is sent.

A request that is not of its type ends the process of a server in rclpy. So nothing goes out that
does not read as its definition says.
"""

from collections.abc import Callable
from dataclasses import dataclass

from gateway.codec.cdr import Decoder
from gateway.codec.error_text import CodecError
from gateway.codec.types import Types
from gateway.sources.name_checks import split_type
from gateway.sources.source import RosError
from gateway.sources.zenoh.keys import NO_TYPE_HASH
from schemas.definition import DefinitionError
from schemas.installed import UnknownTypeError


@dataclass(frozen=True, slots=True)
class ServiceWire:
    """A service type. Its messages are checked by *read_request* and *read_response*."""

    type_name: str  # pkg/srv/Name, or what is derived from an action
    type_hash: str
    read_request: Callable[[bytes], object]
    read_response: Callable[[bytes], object]


def service_wire(types: Types, type_name: str) -> ServiceWire:
    """Return the form of ``pkg/srv/Name``.

    Raises:
        RosError: ``bad_type``: the name is malformed, or no definition is known.
    """
    split_type(type_name, "srv")
    try:
        found = types.service(type_name)
        request, response = found.request.decode, found.response.decode
    except (UnknownTypeError, DefinitionError) as error:
        raise RosError("bad_type", str(error)) from error
    type_hash = found.definition.type_hash or NO_TYPE_HASH
    return ServiceWire(type_name, type_hash, request, response)


def check(subject: str, read: Callable[[bytes], object] | Decoder, cdr: bytes) -> None:
    """Check that bytes are CDR of a type.

    Raises:
        RosError: ``internal``: they are not.
    """
    try:
        read(cdr)
    except CodecError as error:
        raise RosError("internal", f"{subject}: {error}") from error
