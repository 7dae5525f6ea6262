# SPDX-License-Identifier: Apache-2.0
"""The topics of the player itself: its clock, and its state for those who show a slider."""

import asyncio
import json
import struct
from dataclasses import replace
from typing import Final

from gateway.codec.cdr import Cdr
from gateway.sources.recording.player import Player
from gateway.sources.recording.subscriptions import RecordingSubscriptions
from gateway.sources.recording.tracks import DEFAULT_QOS, Track

CLOCK: Final = Track("/clock", "rosgraph_msgs/msg/Clock")
STATE: Final = Track(
    "/rosbag2_player/state",
    "std_msgs/msg/String",
    replace(DEFAULT_QOS, durability="transient_local", depth=1),
)
CLOCK_PERIOD_S: Final = 0.01  # while a client gets the clock
STATE_PERIOD_S: Final = 0.2

OWN_TYPES: Final = {
    "builtin_interfaces/msg/Time": "int32 sec\nuint32 nanosec\n",
    "builtin_interfaces/msg/Duration": "int32 sec\nuint32 nanosec\n",
    CLOCK.type_name: "builtin_interfaces/Time clock\n",
    STATE.type_name: "string data\n",
}
"""The types that the player needs. They may not be installed where no ROS is."""

_CDR_LE: Final = b"\0\1\0\0"
_CLOCK: Final = struct.Struct("<4xiI")
_STAMP: Final = struct.Struct("<II")  # as ROS wraps it from 2038 on
_MAX_UINT32: Final = 0xFFFFFFFF
_NS_PER_S: Final = 1_000_000_000


class OwnTopics:
    """Publishes them until closed. The clock is left to the recording if that *has_clock*."""

    def __init__(
        self, player: Player, subscriptions: RecordingSubscriptions, *, has_clock: bool
    ) -> None:
        self._player = player
        self._subscriptions = subscriptions
        self._has_clock = has_clock
        self._state = ""
        self._state_due_s = 0.0
        self._loop = asyncio.get_running_loop()
        self._timer: asyncio.Handle = self._loop.call_soon(self._tick)

    def close(self) -> None:
        """Publish no more."""
        self._timer.cancel()

    def _tick(self) -> None:
        is_clock_wanted = not self._has_clock and self._subscriptions.has(CLOCK.stream)
        period_s = CLOCK_PERIOD_S if is_clock_wanted else STATE_PERIOD_S
        self._timer = self._loop.call_later(period_s, self._tick)
        if self._loop.time() >= self._state_due_s:
            self._state_due_s = self._loop.time() + STATE_PERIOD_S
            self._tell_state()
        if is_clock_wanted:
            seconds, rest = divmod(self._player.position_ns, _NS_PER_S)
            self._publish(CLOCK, _CDR_LE + _STAMP.pack(seconds & _MAX_UINT32, rest))

    def _tell_state(self) -> None:
        player = self._player
        values = {
            "start": player.start_ns / _NS_PER_S,
            "end": player.end_ns / _NS_PER_S,
            "position": player.position_ns / _NS_PER_S,
            "rate": player.rate,
            "paused": player.is_paused,
        }
        state = json.dumps(values)
        if state != self._state:
            self._state = state
            text = state.encode() + b"\0"
            self._publish(STATE, _CDR_LE + struct.pack("<I", len(text)) + text)

    def _publish(self, track: Track, cdr: bytes) -> None:
        sample = self._subscriptions.sample(cdr, self._player.position_ns)
        self._subscriptions.deliver(track, [sample])


def clock_ns(cdr: Cdr) -> int | None:
    """Return the time of a rosgraph_msgs/msg/Clock, or ``None`` if it is cut off."""
    if len(cdr) < _CLOCK.size:
        return None
    seconds, nanoseconds = _CLOCK.unpack_from(cdr)
    return int(seconds * _NS_PER_S + nanoseconds)
