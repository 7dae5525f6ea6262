# SPDX-License-Identifier: Apache-2.0
"""The services of rosbag2's player, and no others: rosbag2_interfaces/srv, below its node."""

from collections.abc import Callable, Mapping
from typing import Any, Final, cast

from typing_extensions import Never

from gateway.codec.cdr import compile_decoder, compile_encoder
from gateway.sources.graph import ServerInfo
from gateway.sources.recording.player import Player
from gateway.sources.services import Service, ServiceRequest
from gateway.sources.source import RosError
from schemas.installed import InstalledDefinitions

PLAYER_NODE: Final = "/rosbag2_player"
REFUSAL: Final = (
    "this is a recording, and nothing in it can be moved or called: connect to the gateway of a"
    " robot"
)
MAX_STEPS: Final = 10_000  # at once

_NS_PER_S: Final = 1_000_000_000

Values = dict[str, Any]


class Controls:
    """Implements `gateway.sources.services.Services`."""

    def __init__(self, player: Player, definitions: InstalledDefinitions) -> None:
        self._player = player
        self._definitions = definitions
        handlers: dict[str, tuple[str, Callable[[Values], Values]]] = {
            "pause": ("Pause", self._pause),
            "resume": ("Resume", self._resume),
            "toggle_paused": ("TogglePaused", self._toggle),
            "is_paused": ("IsPaused", lambda _: {"paused": player.is_paused}),
            "get_rate": ("GetRate", lambda _: {"rate": player.rate}),
            "set_rate": ("SetRate", lambda asked: {"success": player.set_rate(asked["rate"])}),
            "play_next": ("PlayNext", lambda _: {"success": bool(player.step(1))}),
            "burst": ("Burst", self._burst),
            "seek": ("Seek", lambda asked: {"success": player.seek(_ns(asked["time"]))}),
            "play": ("Play", self._play),
            "stop": ("Stop", self._stop),
        }
        self._handlers = {f"{PLAYER_NODE}/{name}": each for name, each in handlers.items()}
        self.types: Mapping[str, str] = {
            name: f"rosbag2_interfaces/srv/{short}" for name, (short, _) in self._handlers.items()
        }

    def servers(self) -> tuple[ServerInfo, ...]:
        """Return them as the graph shows them."""
        return tuple(
            ServerInfo(name, (type_name,), (PLAYER_NODE,))
            for name, type_name in sorted(self.types.items())
        )

    def client(self, service: str, type_name: str) -> "ControlClient":
        """Create a client.

        Raises:
            RosError: the player does not have this service.
        """
        if service not in self.types:
            refuse()
        if type_name != self.types[service]:
            raise RosError("type_conflict", f"service {service} has type {self.types[service]}")
        get = self._definitions.get
        decode = compile_decoder(get(f"{type_name}_Request"), self._definitions)
        encode = compile_encoder(get(f"{type_name}_Response"), self._definitions)
        handle = self._handlers[service][1]

        def answer(request: bytes) -> bytes:
            return encode(handle(cast("Values", decode(request))), lambda: self._player.position_ns)

        return ControlClient(answer)

    def serve(self, _: str, __: str, ___: Callable[[ServiceRequest], None]) -> Service:
        """Refuse to provide a service.

        Raises:
            RosError: always.
        """
        refuse()

    def _pause(self, _: Values) -> Values:
        self._player.pause()
        return {}

    def _resume(self, _: Values) -> Values:
        self._player.resume()
        return {}

    def _toggle(self, _: Values) -> Values:
        return self._resume(_) if self._player.is_paused else self._pause(_)

    def _burst(self, asked: Values) -> Values:
        """Answer at once, also if fewer messages are left than will be played."""
        count = min(int(asked["num_messages"]), MAX_STEPS)
        return {"actually_burst": self._player.step(count)}

    def _play(self, asked: Values) -> Values:
        """Begin at an offset. An end that is asked for is not kept: pause instead."""
        found = self._player.seek(self._player.start_ns + _ns(asked["start_offset"]))
        if found:
            self._player.resume()
        return {"success": found}

    def _stop(self, _: Values) -> Values:
        self._player.pause()
        self._player.seek(self._player.start_ns)
        return {}


class ControlClient:
    """Implements `gateway.sources.services.ServiceClient`."""

    def __init__(self, answer: Callable[[bytes], bytes]) -> None:
        self._answer = answer

    async def call(self, request: bytes) -> bytes:
        """Carry out a request."""
        return self._answer(request)

    def close(self) -> None:
        """End it."""


def refuse() -> Never:
    """Refuse whatever would move or change something.

    Raises:
        RosError: always.
    """
    raise RosError("not_found", REFUSAL)


def _ns(stamp: Mapping[str, int]) -> int:
    return stamp["sec"] * _NS_PER_S + stamp["nanosec"]
