# SPDX-License-Identifier: Apache-2.0
"""The player: what comes when, pauses, steps, jumps, and the end."""

import asyncio
import contextlib
from collections.abc import AsyncIterator
from pathlib import Path

import pytest
from mcap.writer import Writer

from gateway.sources.recording.options import MAX_RATE, MIN_RATE, PlayOptions
from gateway.sources.recording.player import MAX_PER_TURN, Player
from gateway.sources.recording.read_ahead import (
    BATCH_BYTES,
    BATCH_MESSAGES,
    BATCHES,
    ReadAhead,
    ReadBatch,
)
from gateway.sources.recording.recording import Recording, open_recording
from gateway.sources.recording.tracks import Recorded
from tests import recordings
from tests.client import eventually
from tests.recordings import START_NS, STEP_NS, string_cdr
from tests.sources.recording.test_files import LATCHED, numbers

FAST = PlayOptions(rate=MAX_RATE)


class Watched:
    """A player, and what it has given."""

    def __init__(self, recording: Recording, options: PlayOptions) -> None:
        self.turns: list[list[bytes]] = []
        self.latched: list[list[bytes]] = []
        self.jumps = 0
        self.player = Player(
            recording, options, self._play, lambda found: self._show(found), self._jump
        )

    @property
    def cdrs(self) -> list[bytes]:
        return [each for turn in self.turns for each in turn]

    def _play(self, messages: list[Recorded]) -> None:
        self.turns.append([each.cdr for each in messages])

    def _show(self, messages: list[Recorded]) -> None:
        self.latched.append([each.cdr for each in messages])

    def _jump(self) -> None:
        self.jumps += 1
        self.turns.append([b"jump"])


@contextlib.asynccontextmanager
async def playing(file: Path, options: PlayOptions) -> AsyncIterator[Watched]:
    watched = Watched(open_recording([file], str), options)
    try:
        yield watched
    finally:
        watched.player.close()


@pytest.fixture
def file(tmp_path: Path) -> Path:
    return recordings.write_mcap(tmp_path / "a.mcap", numbers(300), qos=LATCHED)


def cdrs(*numbers: int) -> list[bytes]:
    return [string_cdr(str(each)) for each in numbers]


async def test_all_messages_come_once_in_order_and_some_at_a_time(file: Path) -> None:
    async with playing(file, FAST) as watched:
        player = watched.player
        await eventually(lambda: player.is_over and player.is_paused)
        assert watched.cdrs == cdrs(*range(300))
        assert max(map(len, watched.turns)) <= MAX_PER_TURN
        assert player.position_ns == player.end_ns
        player.resume()  # from the beginning
        await eventually(lambda: player.is_over and player.is_paused)
        assert watched.cdrs == [*cdrs(*range(300)), b"jump", *cdrs(*range(300))]


async def test_nothing_comes_before_its_time(file: Path) -> None:
    async with playing(file, PlayOptions(rate=10)) as watched:
        for _ in range(20):
            await asyncio.sleep(0.005)
            played = len(watched.cdrs)
            assert START_NS + (played - 1) * STEP_NS <= watched.player.position_ns


async def test_a_paused_player_steps_and_its_position_stands(file: Path) -> None:
    async with playing(file, PlayOptions(rate=MAX_RATE, is_paused=True)) as watched:
        player = watched.player
        assert player.step(3) == 3
        await eventually(lambda: len(watched.cdrs) == 3)
        assert player.position_ns == START_NS + 2 * STEP_NS
        await asyncio.sleep(0.05)
        assert watched.cdrs == cdrs(0, 1, 2)
        player.resume()
        assert player.step(1) == 0
        await eventually(lambda: player.is_over)
        assert watched.cdrs == cdrs(*range(300))


async def test_steps_beyond_the_end_are_forgotten(file: Path) -> None:
    async with playing(file, PlayOptions(is_paused=True)) as watched:
        watched.player.step(1000)
        await eventually(lambda: watched.player.is_over)
        assert watched.cdrs == cdrs(*range(300))
        assert watched.player.seek(START_NS)
        await eventually(lambda: len(watched.latched) == 2)
        assert watched.cdrs == [*cdrs(*range(300)), b"jump"]


async def test_many_steps_are_played_in_turns_and_resuming_forgets_the_rest(
    tmp_path: Path,
) -> None:
    file = recordings.write_mcap(tmp_path / "a.mcap", numbers(3 * MAX_PER_TURN))
    async with playing(file, PlayOptions(is_paused=True)) as watched:
        watched.player.step(3 * MAX_PER_TURN - 2)
        await eventually(lambda: len(watched.cdrs) == 3 * MAX_PER_TURN - 2)
        watched.player.step(1000)
        watched.player.resume()
        assert watched.player._steps == 0


async def test_a_bug_of_a_subscriber_does_not_end_it(file: Path) -> None:
    async with playing(file, FAST) as watched:
        faulty = watched._play

        def fail(messages: list[Recorded]) -> None:
            faulty(messages)
            raise ValueError("of the test")

        watched.player._on_messages = fail
        asyncio.get_running_loop().set_exception_handler(lambda *_: None)
        await eventually(lambda: watched.player.is_over)
        assert watched.cdrs == cdrs(*range(300))


async def test_a_jump_gives_what_latched_topics_hold_and_goes_on_there(file: Path) -> None:
    async with playing(file, PlayOptions(is_paused=True)) as watched:
        player = watched.player
        await eventually(lambda: watched.latched == [[]])
        assert player.seek(START_NS + 100 * STEP_NS)
        assert watched.jumps == 0  # time went on
        await eventually(lambda: watched.latched[1:] == [cdrs(*range(99, 100))])
        player.step(2)
        await eventually(lambda: watched.cdrs == cdrs(100, 101))
        assert player.seek(START_NS + 50 * STEP_NS)
        assert watched.jumps == 1
        for outside_ns in (0, START_NS - 1, player.end_ns + 1):
            assert not player.seek(outside_ns)


async def test_a_start_is_from_the_first_message_on(file: Path) -> None:
    options = PlayOptions(rate=MAX_RATE, start_s=100 * STEP_NS / 1e9)
    async with playing(file, options) as watched:
        await eventually(lambda: watched.player.is_over)
        assert watched.cdrs == cdrs(*range(100, 300))


async def test_a_loop_begins_again_and_tells_of_the_jump(file: Path) -> None:
    async with playing(file, PlayOptions(rate=MAX_RATE, loop=True)) as watched:
        await eventually(lambda: watched.jumps >= 2)
        whole = [*cdrs(*range(300)), b"jump"]
        assert watched.cdrs[:602] == whole * 2


async def test_a_loop_of_one_message_goes_on_next_to_an_empty_topic(tmp_path: Path) -> None:
    file = tmp_path / "a.mcap"
    with file.open("wb") as stream:
        writer = Writer(stream)
        writer.start(profile="ros2", library="tests")
        schema = writer.register_schema(recordings.STRING, "ros2msg", b"string data\n")
        channels = [writer.register_channel(name, "cdr", schema) for name in ("/empty", "/one")]
        writer.add_message(channels[1], START_NS, string_cdr("1"), START_NS)
        writer.finish()
    async with playing(file, PlayOptions(loop=True)) as watched:
        await eventually(lambda: watched.jumps >= 2)
        assert watched.cdrs[:4] == [string_cdr("1"), b"jump"] * 2


async def test_a_jump_between_two_loops_is_not_taken_back(tmp_path: Path) -> None:
    file = recordings.write_mcap(tmp_path / "a.mcap", numbers(3))
    async with playing(file, PlayOptions(rate=MAX_RATE, loop=True)) as watched:
        player = watched.player
        await eventually(lambda: player.is_over)  # the next loop has not begun
        player.pause()
        assert player.seek(START_NS + STEP_NS)
        assert player._timer is None  # which would begin the loop


async def test_a_rate_has_bounds(file: Path) -> None:
    async with playing(file, PlayOptions()) as watched:
        player = watched.player
        for wrong in (0.0, -1.0, MIN_RATE * 0.9, MAX_RATE * 1.1, float("nan"), float("inf")):
            assert not player.set_rate(wrong)
            assert player.rate == 1
        assert player.set_rate(MAX_RATE)
        await eventually(lambda: player.is_over)
        assert watched.cdrs == cdrs(*range(300))


async def test_a_damaged_file_is_played_up_to_the_damage_and_not_again(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    file = recordings.write_mcap(tmp_path / "a.mcap", numbers(3000), chunk_bytes=8192)
    content = bytearray(file.read_bytes())
    middle = len(content) // 2
    content[middle : middle + 200] = bytes(200)
    file.write_bytes(content)
    async with playing(file, PlayOptions(rate=MAX_RATE, loop=True)) as watched:
        await eventually(lambda: watched.player.is_over and watched.player.is_paused)
        played = watched.cdrs
        assert played == cdrs(*range(len(played)))
        assert len(played) > 500
        assert "the recording is damaged, it ends here: " in caplog.text


async def test_reading_ahead_is_bounded_in_messages_and_bytes(tmp_path: Path) -> None:
    size = BATCH_BYTES // 4
    cdr = string_cdr("x" * size)
    large = [(START_NS + at, "/chatter", cdr) for at in range(40)]
    for messages, most in ((numbers(5000), BATCH_MESSAGES), (large, 4)):
        file = recordings.write_mcap(tmp_path / "a.mcap", messages)
        ahead = ReadAhead(open_recording([file], str), lambda: None)
        ahead.seek(START_NS)
        batches: list[ReadBatch] = []

        def take(ahead: ReadAhead = ahead, batches: list[ReadBatch] = batches) -> bool:
            while (batch := ahead.take()) is not None:
                batches.append(batch)
            assert len(ahead._waiting) <= BATCHES
            return sum(len(batch.messages) for batch in batches) == len(messages)  # noqa: B023  # awaited here

        await eventually(take)
        ahead.close()
        read = [each.cdr for batch in batches for each in batch.messages]
        assert read == [cdr for *_, cdr in messages]
        assert max(len(batch.messages) for batch in batches) == most
