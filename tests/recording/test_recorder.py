# SPDX-License-Identifier: Apache-2.0
"""The content of a recording of a robot."""

import json
import random
import threading

import pytest
from rosbags.rosbag2 import Reader

from gateway.access.permissions import UNLIMITED, Identity, Policy
from gateway.config.access import AccessConfig, ViewerConfig
from gateway.core.errors import ProtocolError
from gateway.recording import writer
from gateway.recording.active_recording import Mark, RecordingPlan
from gateway.recording.mcap_file import RecordingFile
from gateway.sources.source import Qos
from tests.client import eventually
from tests.core.conftest import GRID, IMAGE, ODOMETRY, STRING
from tests.metrics.states import DRIVE
from tests.recording.conftest import MakeStudio, Studio
from tests.recording.readers import EVENTS, by_all, by_rosbags, decoded, files, notes


async def test_each_message_is_in_the_file_as_it_came(studio: Studio):
    bench = studio.bench
    bench.ros.add_publisher("/chatter", STRING)
    odometry = bench.ros.add_publisher("/odom", ODOMETRY)
    camera = bench.ros.add_publisher("/image", IMAGE)
    folder = await studio.start()
    pixels = bytes(range(256)) * 2400
    sent = {
        "/chatter": [bench.cdr(STRING, data=f"{number}") for number in range(100)],
        "/odom": [bench.cdr(ODOMETRY, child_frame_id="base") for _ in range(100)],
        "/image": [bench.cdr(IMAGE, width=640, height=320, step=1920, data=list(pixels))] * 3,
    }
    for cdr in sent["/chatter"]:
        bench.ros.publish("/chatter", cdr)
    for cdr in sent["/odom"]:
        odometry.publish(cdr)
    for cdr in sent["/image"]:
        camera.publish(cdr)
    await studio.stop()
    assert by_all(folder) == sent
    status = studio.recorder.status()
    assert (status.topics, status.dropped, status.lost) == (3, 0, 0)
    assert status.size == sum(path.stat().st_size for path in files(folder))


async def test_a_topic_that_comes_later_is_recorded_too(studio: Studio):
    folder = await studio.start()
    publisher = studio.bench.ros.add_publisher("/late", STRING)
    await studio.bench.settle()
    publisher.publish(studio.bench.cdr(STRING, data="x"))
    await studio.stop()
    assert list(by_all(folder)) == ["/late"]


async def test_messages_that_a_topic_keeps_are_recorded_though_they_came_before(studio: Studio):
    bench = studio.bench
    publisher = bench.ros.add_publisher("/map", GRID, Qos(durability="transient_local", depth=1))
    watching = bench.sender(op="subscribe", topic="/map")
    publisher.publish(bench.cdr(GRID, data=[1, 2]))
    await watching.sees(1)  # so that the gateway has the topic already
    folder = await studio.start()
    await eventually(lambda: studio.recorder.status().messages > 2)
    await studio.stop()
    assert by_all(folder) == {"/map": [bench.cdr(GRID, data=[1, 2])]}


async def test_the_offered_qos_is_in_the_file(studio: Studio):
    bench = studio.bench
    offered = Qos("best_effort", "transient_local", deadline_ns=10**9, lifespan_ns=5 * 10**9)
    publisher = bench.ros.add_publisher("/scan", STRING, offered)
    folder = await studio.start()
    publisher.publish(bench.cdr(STRING, data="x"))
    await studio.stop()
    with Reader(folder) as reader:
        (found,) = (each for each in reader.connections if each.topic == "/scan")
    (qos,) = found.ext.offered_qos_profiles
    assert (qos.reliability.name, qos.durability.name) == ("BEST_EFFORT", "TRANSIENT_LOCAL")
    assert (qos.deadline.sec, qos.lifespan.sec) == (1, 5)
    assert qos.liveliness_lease_duration.sec > 10**9
    assert found.digest.startswith("RIHS01_")


@pytest.mark.parametrize(("distro", "told"), [("jazzy", "jazzy"), ("recording", "")])
async def test_only_a_distribution_of_ros_is_in_the_file(
    studio: Studio, monkeypatch: pytest.MonkeyPatch, distro: str, told: str
):
    monkeypatch.setattr(type(studio.bench.ros), "distro", distro)
    folder = await studio.start()
    await studio.stop()
    assert f'"ros_distro": "{told}"' in (folder / "metadata.yaml").read_text()


async def test_only_topics_of_the_globs_are_recorded(studio: Studio):
    bench = studio.bench
    names = ["/camera/image", "/camera/info", "/odom", "/_hidden"]
    for name in names:
        bench.ros.add_publisher(name, STRING)

    async def recorded(**plan: list[str]) -> set[str]:
        folder = await studio.start(**plan)
        for name in names:
            bench.say(name, "x")
        await studio.stop()
        return set(by_all(folder))

    assert await recorded() == set(names) - {"/_hidden"}
    assert await recorded(topics=["/camera/**", "/_hidden"]) == {*names[:2], "/_hidden"}


async def test_a_role_records_only_what_it_may_subscribe_to(studio: Studio):
    config = AccessConfig(viewer=ViewerConfig(deny_subscribe=("/secret",)))
    identity = Identity("tablet", Policy(config).of("viewer"))
    for name in ("/secret", "/odom"):
        studio.bench.ros.add_publisher(name, STRING)
    folder = await studio.start(identity=identity)
    studio.bench.say("/secret", "x")
    studio.bench.say("/odom", "x")
    await studio.stop()
    assert set(by_all(folder)) == {"/odom"}


async def test_a_topic_that_cannot_be_recorded_is_named(studio: Studio):
    for type_name in (STRING, ODOMETRY):
        studio.bench.ros.add_publisher("/odd", type_name)
    await studio.start()
    await studio.stop()
    (problem,) = studio.recorder.status().problems.values()
    assert "topic /odd has types" in problem


async def test_a_topic_that_changes_its_type_keeps_the_first_one_in_the_file(studio: Studio):
    bench = studio.bench
    publisher = bench.ros.add_publisher("/x", STRING)
    folder = await studio.start()
    bench.say("/x", "a")
    await bench.settle()
    publisher.close()
    await bench.settle()
    other = bench.ros.add_publisher("/x", ODOMETRY)
    await bench.settle()
    other.publish(bench.cdr(ODOMETRY))
    await studio.stop()
    assert by_all(folder) == {"/x": [bench.cdr(STRING, data="a")]}
    assert "/x is in the file with type std_msgs/msg/String" in str(studio.recorder.status())


async def test_a_long_recording_continues_in_other_files(make_studio: MakeStudio):
    studio = make_studio(max_file_bytes=1024**2)
    bench = studio.bench
    camera = bench.ros.add_publisher("/image", IMAGE)
    folder = await studio.start()
    sent = []
    for number in range(12):
        noise = random.Random(number).randbytes(300_000)
        sent.append(bench.cdr(IMAGE, data=list(noise), width=number))
        camera.publish(sent[-1])
        await bench.settle()
        wanted = number + 2  # with an event
        await eventually(lambda: studio.recorder.status().messages >= wanted)  # noqa: B023
    await studio.stop()
    assert len(files(folder)) > 1
    assert by_all(folder) == {"/image": sent}
    with Reader(folder) as reader:
        assert reader.message_count == len(sent) + len(by_rosbags(folder)[EVENTS])


async def test_a_second_recording_is_refused_until_the_first_has_ended(studio: Studio):
    folder = await studio.start()
    with pytest.raises(ProtocolError) as refused:
        studio.recorder.start(RecordingPlan())
    text = f"at most 1 recording at a time, and {folder.name} is under way: stop it first"
    assert str(refused.value) == text
    await studio.stop()
    assert await studio.start() != folder
    await studio.stop()


async def test_without_a_recording_nothing_can_be_stopped_or_marked(studio: Studio):
    with pytest.raises(ProtocolError, match="start a recording first"):
        await studio.stop()


async def test_without_the_package_mcap_recording_is_refused(
    studio: Studio, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr("gateway.recording.recorder.find_spec", lambda _: None)
    with pytest.raises(ProtocolError, match="pip install"):
        studio.recorder.start(RecordingPlan())


async def test_drivers_and_recordings_are_in_the_topic_of_events(studio: Studio):
    studio.audit.record("before")
    folder = await studio.start()
    studio.audit.record("stop", topic="/cmd_vel", cause="client left")
    await studio.stop()
    studio.audit.record("after")
    events = [json.loads(each.data) for each in decoded(folder)[EVENTS]]
    assert [each["event"] for each in events] == [
        *("control", "recording_started", "stop", "recording_stopped")
    ]
    assert events[2]["topic"] == "/cmd_vel"


async def test_a_flood_of_episodes_is_refused_until_the_disk_has_them(
    studio: Studio, monkeypatch: pytest.MonkeyPatch
):
    assert writer.MAX_WAITING_NOTES == 1000  # 400 kB
    folder = await studio.start()
    goes_on = threading.Event()
    plain = RecordingFile.note
    monkeypatch.setattr(RecordingFile, "note", lambda *given: goes_on.wait(60) and plain(*given))
    begun = 0
    with pytest.raises(ProtocolError) as refused:  # noqa: PT012
        while begun < 2000:
            studio.recorder.mark(Mark(episode="start"), UNLIMITED)
            begun += 1
    assert str(refused.value) == (
        "at most 1000 starts and ends of episodes wait for the disk: mark fewer of them per second"
    )
    goes_on.set()
    await studio.stop()
    assert len(notes(folder)) == 2 + 2 * begun


async def test_the_clock_of_who_drives_already_is_an_event(
    studio: Studio, monkeypatch: pytest.MonkeyPatch
):
    drives = (DRIVE._replace(clock_offset_ms=12.5), DRIVE._replace(clock_offset_ms=None))
    control = studio.bench.router.control()._replace(drives=drives)
    monkeypatch.setattr(studio.bench.router, "control", lambda: control)
    folder = await studio.start()
    await studio.stop()
    events = [json.loads(each.data) for each in decoded(folder)[EVENTS]]
    found = [each.get("clock_offset_ms") for each in events if each["event"] == "control"]
    assert found == [12.5, None]


async def test_episodes_are_metadata_records(studio: Studio):
    folder = await studio.start(task="pick", operator="tablet")
    studio.recorder.mark(Mark(text="oops", episode="end", success=False), UNLIMITED)
    with pytest.raises(ProtocolError, match="no episode is open"):
        studio.recorder.mark(Mark(episode="end"), UNLIMITED)
    studio.recorder.mark(Mark(episode="start"), UNLIMITED)
    studio.recorder.mark(Mark(episode="start", task="place", success=True), UNLIMITED)
    assert studio.recorder.status().episode == 2
    await studio.stop(success=True)
    found = {name: {**each, "time_ns": ""} for name, each in notes(folder).items()}
    first = {"task": "pick", "operator": "tablet", "time_ns": ""}
    assert found == {
        "episode/0/start": first,
        "episode/0/end": {"success": "false", "time_ns": ""},
        "episode/1/start": first,
        "episode/1/end": {"success": "true", "time_ns": ""},
        "episode/2/start": first | {"task": "place"},
        "episode/2/end": {"success": "true", "time_ns": ""},
    }
    marks = [json.loads(each.data) for each in decoded(folder)[EVENTS]]
    assert [each["text"] for each in marks if each["event"] == "mark"] == ["oops", "", ""]
