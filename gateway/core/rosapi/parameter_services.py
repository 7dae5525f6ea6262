# SPDX-License-Identifier: Apache-2.0
"""The services about parameters: names are ``node:parameter``, values are JSON in a string.

Failures are in ``reason``: clients look there, and not all of them wait for an error.
"""

from collections.abc import Mapping

from gateway.codec.error_text import CodecError, truncate
from gateway.codec.json import dumps, loads
from gateway.core.errors import ProtocolError
from gateway.core.rosapi.node_parameters import (
    ALL_NODES_TIMEOUT_S,
    Parameters,
    SetResult,
    node_timeout_s,
)

_Request = Mapping[str, str]
_Answer = dict[str, object]

# Clients parse this if there is no value. They would fail on an empty string.
_NO_VALUE = "null"


class ParameterServices:
    """The services about parameters.

    *timeout_s* is the client's, or ``None`` if it gives none. See `node_timeout_s`.
    """

    def __init__(self, parameters: Parameters) -> None:
        self._parameters = parameters

    async def get_param(self, request: _Request, timeout_s: float | None) -> _Answer:
        """Return a value, or the client's default."""
        try:
            value = await self._value(request["name"], timeout_s)
            reason = "" if value is not None else "the parameter has no value"
        except ProtocolError as error:
            value, reason = None, str(error)
        text = _default(request["default_value"]) if value is None else dumps(value).decode()
        return {"value": text, "successful": not reason, "reason": reason}

    async def set_param(self, request: _Request, timeout_s: float | None) -> _Answer:
        """Set a value."""
        try:
            value = loads(request["value"])
        except CodecError:
            reason = f"value: expected JSON, got {truncate(request['value'])!r}"
            return _set_answer(SetResult(successful=False, reason=reason))
        return await self._set(request["name"], value, timeout_s)

    async def delete_param(self, request: _Request, timeout_s: float | None) -> _Answer:
        """Undeclare a parameter."""
        return await self._set(request["name"], None, timeout_s)

    async def has_param(self, request: _Request, timeout_s: float | None) -> _Answer:
        """Answer whether a parameter has a value. After any failure, the answer is no."""
        try:
            return {"exists": await self._value(request["name"], timeout_s) is not None}
        except ProtocolError:
            return {"exists": False}

    async def get_param_names(self, _: _Request, timeout_s: float | None) -> _Answer:
        """List the parameters of all nodes that answer in time."""
        found = await self._parameters.names_by_node(node_timeout_s(timeout_s, ALL_NODES_TIMEOUT_S))
        return {"names": [f"{node}:{name}" for node, names in found.items() for name in names]}

    async def _value(self, requested: str, timeout_s: float | None) -> object:
        node, name = _split(requested)
        return (await self._parameters.get(node, [name], node_timeout_s(timeout_s)))[name]

    async def _set(self, requested: str, value: object, timeout_s: float | None) -> _Answer:
        try:
            node, name = _split(requested)
            results = await self._parameters.set(node, {name: value}, node_timeout_s(timeout_s))
        except ProtocolError as error:
            return _set_answer(SetResult(successful=False, reason=str(error)))
        return _set_answer(results[name])


def _split(requested: str) -> tuple[str, str]:
    node, _, name = requested.partition(":")
    if not node or not name:
        raise ProtocolError(
            "bad_name", f"name: expected node:parameter, got {truncate(requested)!r}"
        )
    return node, name


def _default(text: str) -> str:
    """Return a client's default as JSON. rosbridge takes plain text as well."""
    if not text:
        return _NO_VALUE
    try:
        loads(text, takes_tokens=False)  # which clients do not read
    except CodecError:
        return dumps(text).decode()
    return text


def _set_answer(result: SetResult) -> _Answer:
    return {"successful": result.successful, "reason": result.reason}
