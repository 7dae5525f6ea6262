# SPDX-License-Identifier: Apache-2.0
"""Files of all formats, whole, cut off, foreign and broken."""

import os
import random
import re
import shutil
import sqlite3
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from mcap.writer import Writer
from rosbags.rosbag2 import CompressionMode, StoragePlugin

from gateway.sources.recording import bag_file
from gateway.sources.recording.errors import RecordingError
from gateway.sources.recording.mcap_file import McapFile
from gateway.sources.recording.recording import (
    FIRST_WINDOW_NS,
    Recording,
    open_recording,
)
from gateway.sources.recording.tracks import MAX_HELD, TF_STATIC, Recorded
from tests import recordings
from tests.recordings import COUNT, NAME, ODOMETRY, START_NS, STEP_NS, STRING, string_cdr

WRITERS: dict[str, Callable[[Path], Path]] = {
    "mcap": lambda folder: recordings.write_bag2(folder / "bag", StoragePlugin.MCAP),
    "one mcap": lambda folder: next(WRITERS["mcap"](folder).glob("*.mcap")),
    "sqlite3": lambda folder: recordings.write_bag2(folder / "bag", StoragePlugin.SQLITE3),
    "one db3": lambda folder: next(WRITERS["sqlite3"](folder).glob("*.db3")),
    "ros1": lambda folder: recordings.write_bag1(folder / "drive.bag"),
}
LATCHED = (
    "- {history: 1, depth: 1, reliability: 1, durability: 1, deadline: {sec: 0, nsec: 0},"
    " lifespan: {sec: 0, nsec: 0}, liveliness: 1, liveliness_lease_duration: {sec: 0, nsec: 0},"
    " avoid_ros_namespace_conventions: false}"
)


def opened(*paths: Path) -> Recording:
    return open_recording(paths, lambda text: pytest.fail(text))


def read(recording: Recording, start_ns: int = START_NS) -> list[tuple[int, str, bytes]]:
    found = [(each.time_ns, each.track.topic, each.cdr) for each in recording.messages(start_ns)]
    recording.close()
    return found


def numbers(count: int, topic: str = "/chatter") -> list[tuple[int, str, bytes]]:
    return [(START_NS + at * STEP_NS, topic, string_cdr(str(at))) for at in range(count)]


@pytest.mark.parametrize("form", WRITERS)
def test_each_message_of_each_format_is_equal_byte_for_byte(form: str, tmp_path: Path) -> None:
    recording = opened(WRITERS[form](tmp_path))
    assert {(each.topic, each.type_name, each.is_latched) for each in recording.tracks} == {
        ("/map_name", STRING, True),
        ("/chatter", STRING, False),
        ("/odom", ODOMETRY, False),
    }
    assert (recording.start_ns, recording.end_ns) == (START_NS, START_NS + 99 * STEP_NS + 3)
    fields = recording.definitions["std_msgs/msg/Header"].fields
    assert [field.name for field in fields] == ["stamp", "frame_id"]  # the seq of ROS 1 is gone
    assert read(recording) == recordings.expected()


@pytest.mark.parametrize("form", WRITERS)
def test_reading_begins_anywhere_and_knows_what_latched_topics_hold(
    form: str, tmp_path: Path
) -> None:
    recording = opened(WRITERS[form](tmp_path))
    middle_ns = START_NS + COUNT // 2 * STEP_NS
    held = recording.latched_before(middle_ns)
    assert [(each.track.topic, each.cdr) for each in held] == [("/map_name", string_cdr(NAME))]
    assert recording.latched_before(START_NS) == []
    rest = [each for each in recordings.expected() if each[0] >= middle_ns]
    assert read(recording, middle_ns) == rest


def test_files_are_played_together(tmp_path: Path) -> None:
    first = recordings.write_mcap(tmp_path / "a.mcap", numbers(9))
    second = recordings.write_mcap(tmp_path / "b.mcap", numbers(9, "/other"))
    together = sorted(numbers(9) + numbers(9, "/other"), key=lambda each: each[0])
    assert sorted(read(opened(first, second))) == sorted(together)
    assert [at for at, *_ in read(opened(tmp_path))] == [at for at, *_ in together]  # a folder


def test_all_static_transforms_are_held_and_the_last_of_other_topics(tmp_path: Path) -> None:
    latched = [*numbers(5), *numbers(MAX_HELD + 5, TF_STATIC)]
    file = recordings.write_mcap(tmp_path / "a.mcap", latched, qos=LATCHED)
    recording = opened(file)
    assert (recording.end_ns - START_NS) > FIRST_WINDOW_NS  # several windows
    held = recording.latched_before(recording.end_ns)
    recording.close()
    static = [each.cdr for each in held if each.track.topic == TF_STATIC]
    assert static == [string_cdr(str(at)) for at in range(5, MAX_HELD + 5)]
    assert [each.cdr for each in held if each.track.topic != TF_STATIC] == [string_cdr("4")]


@pytest.mark.parametrize("percent", [0, 1, 40, 80, 99])
def test_a_file_whose_writer_was_killed_is_played_as_far_as_it_goes(
    percent: int, tmp_path: Path
) -> None:
    whole = recordings.write_mcap(tmp_path / "a.mcap", numbers(500)).read_bytes()
    file = tmp_path / "a.mcap.active"
    file.write_bytes(whole[: len(whole) * percent // 100])
    if percent == 0:
        with pytest.raises(RecordingError, match="is empty"):
            opened(file)
        return
    notes: list[str] = []
    if percent == 1:
        with pytest.raises(RecordingError, match="no message to play"):
            open_recording([file], notes.append)
    else:
        found = read(open_recording([file], notes.append))
        assert found == numbers(500)[: len(found)]
        assert len(found) > 100
    assert notes == [f"{file} was not finished, all that is complete in it is played"]


def test_a_large_unfinished_file_shows_the_progress_and_can_be_given_up(tmp_path: Path) -> None:
    large = [(START_NS + at, "/chatter", os.urandom(16 * 1024**2)) for at in range(6)]
    file = recordings.write_mcap(tmp_path / "a.mcap", large)
    file.write_bytes(file.read_bytes()[:-1])
    shown: list[str] = []
    open_recording([file], str, shown.append).close()
    assert shown == [f"{file} has no index, 67 of 100 MB are read"]

    def give_up(_: str) -> None:
        raise RecordingError("of the test")

    with pytest.raises(RecordingError, match="of the test"):
        open_recording([file], str, give_up)


def test_a_damaged_end_is_left_out_of_an_unfinished_file(tmp_path: Path) -> None:
    whole = recordings.write_mcap(tmp_path / "a.mcap", numbers(500)).read_bytes()
    file = tmp_path / "b.mcap"
    file.write_bytes(whole[: len(whole) // 2] + bytes(10_000))  # a disk that lost power
    found = read(open_recording([file], str))
    assert found == numbers(500)[: len(found)] != []


@pytest.mark.parametrize(
    ("content", "why"),
    [
        (b"", "is empty"),
        (b"# a page about robots\n", "is no recording"),
        (b"SQLite format 3\0" + bytes(90), "cannot read"),
        (b"#ROSBAG V2.0\n" + bytes(90), "cannot read"),
        (b"\x89MCAP0\r\n" + bytes(90), "no message to play"),
        (b"\x28\xb5\x2f\xfd" + bytes(90), "is compressed"),
    ],
)
def test_foreign_and_broken_files_are_refused(content: bytes, why: str, tmp_path: Path) -> None:
    file = tmp_path / "some.db3"
    file.write_bytes(content)
    with pytest.raises(RecordingError, match=f"{re.escape(str(file))}.*: [a-z]") as refused:
        open_recording([file], str)
    assert why in str(refused.value)


def test_missing_files_and_other_folders_are_refused(tmp_path: Path) -> None:
    other_ending = tmp_path / "some.sqlite"
    other_ending.write_bytes(b"SQLite format 3\0")
    for path, why in (
        (tmp_path / "none", "no such file"),
        (tmp_path, "has no recording: name"),
        (other_ending, "rename it to .db3"),
    ):
        with pytest.raises(RecordingError, match=why):
            opened(path)


def test_topics_that_are_not_cdr_are_left_out_with_the_reason(tmp_path: Path) -> None:
    good = recordings.write_mcap(tmp_path / "a.mcap", numbers(3))
    for change, why in (
        ({"of_message": "json"}, "it has json encoding, not cdr"),
        (
            {"definition": "string 9data"},
            "its definition cannot be read",
        ),
    ):
        other = recordings.write_mcap(tmp_path / "b.mcap", numbers(3, "/other"), **change)
        notes: list[str] = []
        assert read(open_recording([good, other], notes.append)) == numbers(3)
        assert len(notes) == 1
        assert notes[0].startswith(f"topic /other is not played, {why}")


def test_two_definitions_of_one_type_are_refused(tmp_path: Path) -> None:
    first = recordings.write_mcap(tmp_path / "a.mcap", numbers(3))
    changed = "# of another version\nstring data\nint32 more\n"
    second = recordings.write_mcap(tmp_path / "b.mcap", numbers(3), definition=changed)
    with pytest.raises(RecordingError, match=f"define {STRING} in two ways"):
        opened(first, second)


def test_definitions_may_be_idl(tmp_path: Path) -> None:
    modules = "module std_msgs { module msg { struct String { string data; }; }; };"
    idl = f"{'=' * 80}\nIDL: {STRING}\n{modules}"
    file = recordings.write_mcap(
        tmp_path / "a.mcap", numbers(3), definition=idl, encoding="ros2idl"
    )
    recording = opened(file)
    assert [field.name for field in recording.definitions[STRING].fields] == ["data"]
    assert read(recording) == numbers(3)


def test_a_file_that_begins_later_is_not_read_before(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    begun: list[object] = []
    read_file = McapFile.messages

    def noted(file: McapFile, *arguments: Any) -> Iterator[Recorded]:
        begun.append(file)
        yield from read_file(file, *arguments)

    monkeypatch.setattr(McapFile, "messages", noted)
    second = [(at + 10 * STEP_NS, *rest) for at, *rest in numbers(9)]
    files = [
        recordings.write_mcap(tmp_path / f"{name}.mcap", each)
        for name, each in (("a", second), ("b", numbers(9)))
    ]
    recording = opened(*files)
    messages = recording.messages(START_NS)
    assert [next(messages).time_ns for _ in range(8)] == [at for at, *_ in numbers(8)]
    assert len(begun) == 1
    assert len(list(messages)) == 10
    recording.close()


def test_names_that_ros_does_not_allow_are_left_out(tmp_path: Path) -> None:
    file = recordings.write_mcap(tmp_path / "a.mcap", [*numbers(2), *numbers(2, "/two words")])
    notes: list[str] = []
    assert read(open_recording([file], notes.append)) == numbers(2)
    assert notes == ["topic /two words is not played, ROS 2 does not allow its name"]
    only = recordings.write_mcap(tmp_path / "b.mcap", numbers(2, "camera"))
    with pytest.raises(RecordingError, match="no message to play"):
        open_recording([only], str)


def test_a_pipe_is_refused(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(RecordingError, match="is not a file"):
        opened(tmp_path / "pipe")


def test_messages_outside_of_chunks_are_refused_with_the_remedy(tmp_path: Path) -> None:
    file = recordings.write_mcap(tmp_path / "a.mcap", numbers(2), use_chunking=False)
    with pytest.raises(RecordingError, match=r"not in chunks: repair it, .*mcap recover"):
        opened(file)


def test_two_definitions_in_one_file_leave_out_the_second(tmp_path: Path) -> None:
    file = tmp_path / "a.mcap"
    with file.open("wb") as stream:
        writer = Writer(stream)
        writer.start(profile="ros2", library="tests")
        for topic, text in (("/chatter", "string data\n"), ("/other", "int32 data\n")):
            schema = writer.register_schema(STRING, "ros2msg", text.encode())
            channel = writer.register_channel(topic, "cdr", schema)
            writer.add_message(channel, START_NS, string_cdr("0"), START_NS)
        writer.finish()
    notes: list[str] = []
    assert read(open_recording([file], notes.append)) == numbers(1)
    assert notes == [f"topic /other is not played, the file defines {STRING} in two ways"]


@pytest.mark.parametrize("form", ["one mcap", "one db3", "ros1"])
def test_a_file_may_have_any_name(form: str, tmp_path: Path) -> None:
    written = WRITERS[form](tmp_path)
    not_utf8 = os.fsdecode(b"\xff\xfe")
    for name in ("a#b", "a?mode=x", "a b", "a%20b", "a%b", "a\nb", "-x", "\u00fc", not_utf8):
        file = tmp_path / name / f"{name}{written.suffix}"  # of the folder as well
        file.parent.mkdir()
        shutil.copy(written, file)
        assert read(opened(file)) == recordings.expected(), name
        assert read(opened(file.parent)) == recordings.expected(), name


@pytest.mark.parametrize("plugin", StoragePlugin)
@pytest.mark.parametrize("mode", [CompressionMode.FILE, CompressionMode.MESSAGE])
def test_messages_that_rosbag2_compressed_are_equal_byte_for_byte(
    plugin: StoragePlugin, mode: CompressionMode, tmp_path: Path
) -> None:
    folder = recordings.write_bag2(tmp_path / "bag", plugin, mode)
    assert read(opened(folder)) == recordings.expected()
    if mode == CompressionMode.MESSAGE:
        (folder / "metadata.yaml").unlink()  # as after a crash: only the messages tell
        assert read(opened(folder)) == recordings.expected()


@pytest.mark.parametrize("is_finished", [True, False])
def test_stamps_that_go_back_are_played_in_order(is_finished: bool, tmp_path: Path) -> None:
    shuffled = numbers(500)
    random.Random(1).shuffle(shuffled)
    file = recordings.write_mcap(tmp_path / "a.mcap", shuffled)
    if not is_finished:
        file.write_bytes(file.read_bytes()[:-1])
    assert read(open_recording([file], str)) == numbers(500)


def test_a_file_that_is_named_twice_is_played_once(tmp_path: Path) -> None:
    file = recordings.write_mcap(tmp_path / "a.mcap", numbers(3))
    (tmp_path / "newest.mcap").symlink_to(file)
    notes: list[str] = []
    assert read(open_recording([file, tmp_path], notes.append)) == numbers(3)
    same = "is the same file as another one, it is played once"
    assert notes == [f"{file} {same}", f"{tmp_path / 'newest.mcap'} {same}"]


def test_a_long_time_between_files_is_told(tmp_path: Path) -> None:
    first = recordings.write_mcap(tmp_path / "a.mcap", [(START_NS, "/chatter", string_cdr("1"))])
    for gap_s, is_told in ((60, False), (61, True)):
        later = (START_NS + 1 + gap_s * 1_000_000_000, "/chatter", string_cdr("2"))
        second = recordings.write_mcap(tmp_path / "b.mcap", [later])
        notes: list[str] = []
        open_recording([second, first], notes.append).close()
        told = f"nothing was recorded for {gap_s} s before {second}, seek there or play it alone"
        assert notes == ([told] if is_told else [])


def test_a_database_without_messages_is_refused(tmp_path: Path) -> None:
    file = WRITERS["one db3"](tmp_path)
    with sqlite3.connect(file) as database:
        database.execute("DELETE FROM messages")
    database.close()
    with pytest.raises(RecordingError, match="no message to play"):
        opened(file)


def test_a_type_of_ros_1_is_learned_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    learned: list[str] = []
    learn = bag_file.get_types_from_msg

    def noted(text: str, name: str) -> Any:
        learned.append(name)
        return learn(text, name)

    monkeypatch.setattr(bag_file, "get_types_from_msg", noted)
    opened(WRITERS["ros1"](tmp_path)).close()
    assert sorted(learned) == [ODOMETRY, STRING]  # of three topics
