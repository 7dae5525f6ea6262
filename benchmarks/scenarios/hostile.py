# SPDX-License-Identifier: Apache-2.0
"""The longest that one legal frame holds the event loop, for the worst frames there are.

The router and ROS are real, in this process. The time is that of the thread, so other processes do
not matter. The first round of a frame also makes what its type needs: codecs and a publisher.
"""

import asyncio
import contextlib
import gc
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from typing import Final

from benchmarks.bombs import Bomb, bombs
from benchmarks.figures import Figure
from benchmarks.hostile_frames import HostileFrame, plain_frames
from benchmarks.plan import Plan
from gateway.codec.error_text import CodecError
from gateway.codec.json import loads
from gateway.codec.types import Types
from gateway.config.limits import Limits
from gateway.core.peer import ClientTurns, Peer
from gateway.core.rosapi import interfaces_prefix
from gateway.core.router import Router
from gateway.fronts.rosbridge.front import RosbridgeFront
from gateway.memory import keep_large_blocks
from gateway.sources.rclpy import RosOptions, open_ros
from schemas.installed import InstalledDefinitions, installed_prefixes
from schemas.table import Table

BAR_MS: Final = 20.0

_SCENARIO: Final = "hostile"
_SHOWN: Final = 12  # of the frames that the search finds
_TRIED: Final = 40  # in full, of those that cost most per container when small
_SMALL: Final = 200  # elements
_REPEATS: Final = 5


def measure(_: Plan) -> list[Figure]:
    """Print a table and return the figures."""
    keep_large_blocks()  # as the gateway does
    return asyncio.run(_measure())


async def _measure() -> list[Figure]:
    definitions = InstalledDefinitions([*installed_prefixes(), interfaces_prefix()])
    types = Types(definitions)
    worst = _worst_bombs(definitions, types)
    async with open_ros(RosOptions()) as ros:
        with ThreadPoolExecutor(1) as workers:
            router = Router(
                ros, types, Table.load(), limits=Limits(), workers=workers, version="benchmark"
            )
            front = RosbridgeFront(router)
            with contextlib.closing(router):
                gc.freeze()  # as the gateway does when it is ready
                found = sorted(
                    (_held_ms(front, frame) for frame in _full_size(worst)), reverse=True
                )
                plain = sorted((_held_ms(front, frame) for frame in plain_frames()), reverse=True)
                gc.unfreeze()
    print(f"CPU ms of the event loop for one frame, best of {_REPEATS}, and the first time")
    print(f"  {'ms':>8}{'first':>8}{'bytes':>10}  frame")
    figures = []
    for held_ms, first_ms, frame in [*found[:_SHOWN], *plain]:
        mark = "  OVER" if held_ms > BAR_MS else ""
        print(f"  {held_ms:8.1f}{first_ms:8.1f}{len(frame.data):10}  {frame.name[:70]}{mark}")
        figures.append(Figure(_SCENARIO, frame.name, held_ms, "ms"))
    most_ms = max(held_ms for held_ms, _, _ in [*found, *plain])
    print(f"  longest of {len(found) + len(plain)}: {most_ms:.1f} ms, the bar is {BAR_MS:g}")
    return figures


def _worst_bombs(definitions: InstalledDefinitions, types: Types) -> list[Bomb]:
    """Return those that cost most per character and per container, tried with few elements."""

    def cost(bomb: Bomb) -> float:
        value = loads(bomb.frame(_SMALL).data)
        assert isinstance(value, dict)
        encode = types.get(bomb.type_name).encode

        def encode_it() -> None:
            with contextlib.suppress(CodecError):
                encode(value["msg"], 0)

        encode_it()
        return _thread_ms(encode_it) * max(bomb.counts())

    return sorted(bombs(definitions), key=cost, reverse=True)[:_TRIED]


def _full_size(worst: list[Bomb]) -> Iterator[HostileFrame]:
    for bomb in worst:
        for count in bomb.counts():
            yield bomb.frame(count)


class _CountedTurns(ClientTurns):
    def __init__(self) -> None:
        self.left: list[Callable[[], None]] = []  # for the next turn of the loop

    def next_turn(self, work: Callable[[], None]) -> None:
        self.left.append(work)


def _held_ms(front: RosbridgeFront, frame: HostileFrame) -> tuple[float, float, HostileFrame]:
    """Return the thread's time for a frame that comes again, and for the first."""
    turns = _CountedTurns()
    session, left = front.open(Peer(wake=lambda: None, turns=turns)), turns.left
    try:

        def longest_ms() -> float:
            """Return the longest one of the turns in which it is read and carried out."""
            longest_ms = _thread_ms(lambda: front.receive(session, frame.data))
            while left:
                longest_ms = max(longest_ms, _thread_ms(left.pop(0)))
            return longest_ms

        def receive_ms() -> float:
            try:
                return longest_ms()
            finally:
                left.clear()

        first_ms = receive_ms()
        return min(receive_ms() for _ in range(_REPEATS)), first_ms, frame
    finally:
        front.core.leave(session)


def _thread_ms(work: Callable[[], object]) -> float:
    started_s = time.thread_time()
    work()
    return (time.thread_time() - started_s) * 1e3
