# SPDX-License-Identifier: Apache-2.0
"""The messages of an action's services as CDR, made and read without decoding what they carry."""

import struct
from collections.abc import Callable
from typing import Final

from gateway.sources.goal_ids import goal_id_of, with_goal_id, without_goal_id
from gateway.sources.realignment import Realignment

_HEADER: Final = b"\0\1\0\0"  # of little-endian CDR
_HEADER_BYTES: Final = len(_HEADER)
_ANSWER: Final = struct.Struct("<?3xiI")  # SendGoal_Response: accepted, and a stamp
_STATUS_BYTES: Final = 1
_UNKNOWN: Final = b"\0"  # action_msgs/msg/GoalStatus
_NO_STAMP: Final = bytes(8)


class ActionCdr:
    """*result* is the layout of the result, and *empty_result* returns CDR of an empty one."""

    def __init__(
        self, type_name: str, result: Realignment, empty_result: Callable[[], bytes]
    ) -> None:
        self.type_name = type_name
        self._result = result
        self._empty_result = empty_result

    def to_goal_request(self, goal_id: bytes, goal: bytes) -> bytes:
        """Return the request that sends a goal."""
        return with_goal_id(goal_id, goal)

    def read_goal_request(self, request: bytes) -> tuple[bytes, bytes]:
        """Return the goal's id, shorter than 16 bytes if it is malformed, and the goal."""
        return goal_id_of(request), without_goal_id(request)

    def to_goal_response(self, accepted_ns: int | None) -> bytes:
        """Return the response to a goal that was accepted at a time, or was rejected."""
        stamp = divmod(accepted_ns or 0, 10**9)
        return _HEADER + _ANSWER.pack(accepted_ns is not None, *stamp)

    def is_accepted(self, response: bytes) -> bool:
        """Return the server's answer to a goal."""
        return any(response[_HEADER_BYTES : _HEADER_BYTES + 1])

    def to_result_request(self, goal_id: bytes) -> bytes:
        """Return the request for the result of a goal."""
        return _HEADER + goal_id

    def to_cancel_request(self, goal_id: bytes) -> bytes:
        """Return the request that cancels a goal."""
        return _HEADER + goal_id + _NO_STAMP

    def read_result_request(self, request: bytes) -> bytes:
        """Return the id of the goal whose result is asked for."""
        return goal_id_of(request)

    def to_result_response(self, status: int, result: bytes | None = None) -> bytes:
        """Return the response with a result, or with an empty one.

        Raises:
            RosError: ``internal``: the result is not CDR of the type.
        """
        cdr = self._empty_result() if result is None else result
        return self._moved(cdr, 0, struct.pack("b", status))

    def read_result_response(self, response: bytes) -> tuple[int, bytes]:
        """Return the status and the result.

        Raises:
            RosError: ``internal``: the response is not CDR of the type.
        """
        first = response[_HEADER_BYTES : _HEADER_BYTES + _STATUS_BYTES] or _UNKNOWN
        (status,) = struct.unpack("b", first)
        return status, self._moved(response, _STATUS_BYTES, b"")

    def _moved(self, cdr: bytes, start: int, before: bytes) -> bytes:
        header, body = cdr[:_HEADER_BYTES], cdr[_HEADER_BYTES:]
        is_little_endian = header[1:2] == _HEADER[1:2]
        return header + self._result.move(body, start, before, is_little_endian=is_little_endian)
