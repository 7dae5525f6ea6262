# SPDX-License-Identifier: Apache-2.0
"""The `status` frames that a client gets, by what it has sent."""

from collections.abc import Iterable, Mapping
from typing import Final

from gateway.codec.error_text import MAX_ECHO, misspelt, suggestion, truncate
from gateway.core.errors import SEVERITY, Level, ProtocolError
from gateway.fronts.rosbridge.operations import OPERATIONS, rosbridge

# Of one connection: to compare a key takes 0.1 ms, and a program sends the same ones again.
MAX_KEYS_COMPARED: Final = 64

_NO_KEYS: Final = frozenset[str]()
_KNOWN: Final[Mapping[str, frozenset[str]]] = {
    op: rosbridge.KEYS.get(op, frozenset({"op"})) | model.model_fields.keys()
    for op, model in OPERATIONS.items()
}

# They act by defaults without `args`: SetBool would switch a motor off instead of on.
_WITH_ARGUMENTS: Final = frozenset({"call_service", "send_action_goal"})


class Dialect:
    """Decides which `status` frames a client gets.

    rosbridge sends none, and its clients take one for the answer to something else, or fail. So a
    client that speaks only rosbridge's protocol gets errors alone: its refused operations that
    have no other answer. Warnings begin when it asks for them, or sends what only this gateway
    knows. A misspelt key also counts: no library of rosbridge sends one, but people do.
    """

    def __init__(self) -> None:
        self._level: Level = "error"
        self._is_chosen = False
        self._silent = rosbridge.KEYS  # the keys that say nothing new, by operation
        self._compared: set[tuple[str, str]] = set()

    def choose(self, level: Level) -> None:
        """Send frames of this severity or worse from now on, whatever the client sends."""
        self._level = level
        self._is_chosen = True
        self._silent = _KNOWN

    def hears(self, level: Level) -> bool:
        """Return whether the client gets a `status` of this severity."""
        return SEVERITY[level] <= SEVERITY[self._level]

    def note(self, op: str, values: Mapping[str, object]) -> str:
        """Look at the keys of a known operation. Return a text on those that are misspelt.

        It takes 0.2 us for an operation whose keys say nothing new.

        Raises:
            ProtocolError: the arguments of a call or a goal are under another key than `args`.
        """
        silent = self._silent.get(op, _NO_KEYS)
        if silent.issuperset(values):
            return ""
        unknown = [key for key, value in values.items() if key not in silent and value is not None]
        if op in _WITH_ARGUMENTS and values.get("args") is None:
            _refuse_arguments(op, unknown, values)
        text = "; ".join(filter(None, (self._compare(op, key, values) for key in unknown)))
        is_own = op not in rosbridge.KEYS or any(key in _KNOWN[op] for key in unknown)
        if not self._is_chosen and (text or is_own):
            self.choose("warning")
        return text

    def _compare(self, op: str, key: str, values: Mapping[str, object]) -> str:
        """Return a text on a key that resembles one of the operation, once for each key.

        A long one resembles none, and is not kept.
        """
        if key in _KNOWN[op] or (op, key) in self._compared:
            return ""
        if len(self._compared) == MAX_KEYS_COMPARED or len(key) > MAX_ECHO:
            return ""
        self._compared.add((op, key))
        near = misspelt(key, _KNOWN[op] - values.keys())
        return f"{key}: unknown, and ignored{suggestion(near)}" if near else ""


def _refuse_arguments(op: str, unknown: Iterable[str], values: Mapping[str, object]) -> None:
    for key in unknown:
        if key not in _KNOWN[op] and isinstance(values[key], dict | list):
            text = f"{truncate(key)}: unknown, and {op} has no args; did you mean args?"
            raise ProtocolError("bad_request", text)
