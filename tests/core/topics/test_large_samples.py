# SPDX-License-Identifier: Apache-2.0
"""Large samples, of about 300 kB here, over the fake ROS. Each turn of the loop does one step."""

import asyncio
import json
from collections import Counter
from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any

import pytest

from gateway.codec.chunks import Chunks
from gateway.codec.json_slices import SLICE_NUMBERS
from gateway.codec.nonfinite import writer
from gateway.core.entries import NOT_READY
from gateway.core.topics import encoders, slices
from gateway.core.topics.encoding import Encoding, SharedFrame
from gateway.core.topics.large_samples import (
    LARGE_ELEMENTS_BYTES,
    LARGE_SAMPLE_BYTES,
    EncodedTopic,
    EncodingResources,
    LargeSamples,
    _Job,
)
from gateway.core.topics.subscription import EncodingKey
from gateway.fronts.rosbridge.framing import RosbridgeFraming
from gateway.sources.source import Qos, Sample
from tests.client import eventually
from tests.core.conftest import GRID, STRING, Bench, Socketless
from tests.core.topics.test_encoding import text_in
from tests.wire import untagged, websocket_frames

NUMBERS = "std_msgs/msg/Float64MultiArray"
LATCHED = Qos(durability="transient_local", depth=1)
CELLS = [-1, 0, 100] * 100_000
ROS_SHARP = 2**31 - 1


@pytest.fixture(autouse=True)
def one_step_a_turn(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(slices, "TURN_NS", 0)


@pytest.fixture
def encoded(monkeypatch: pytest.MonkeyPatch) -> Iterator[Counter[str]]:
    """Count the large samples that are encoded, by their form."""
    count: Counter[str] = Counter()
    make_slices = encoders.to_json_slices

    def counted(message_type: Any, key: Any) -> Any:
        encode = make_slices(message_type, key)

        def counting(cdr: bytes) -> Any:
            count[key.nonfinite] += 1
            return encode(cdr)

        return counting

    monkeypatch.setattr(encoders, "to_json_slices", counted)
    return count


def grid(bench: Bench, cells: list[int] = CELLS) -> bytes:
    return bench.cdr(GRID, data=cells)


def subscribed(bench: Bench, type_name: str = GRID, **options: Any) -> Socketless:
    """Return a client of a topic that a node publishes, or has published before."""
    if not any(each.topic == "/t" for each in bench.ros.publishers):
        bench.ros.add_publisher("/t", type_name)
    return bench.sender(op="subscribe", topic="/t", type=type_name, **options)


def encodings(bench: Bench) -> list[Any]:
    topics = bench.router._subscriptions._topics.values()
    return [encoding for topic in topics for encoding in topic._encodings.values()]


async def begun(encoding: Any) -> None:
    """Return in the turn of the loop in which a large sample begins to be encoded."""
    for _ in range(1000):
        if encoding._large._job is not None:
            return
        await asyncio.sleep(0)
    raise AssertionError("nothing is encoded")


def payload(client: Socketless) -> bytes:
    """Return the payload of all that a client has got, which is one frame."""
    (frame,) = websocket_frames(b"".join(client.wires))
    return bytes(frame.data)


async def test_a_large_message_is_the_text_that_a_small_one_would_be(bench: Bench):
    client = subscribed(bench)
    bench.ros.publish("/t", grid(bench))
    await client.sees(1)
    whole = writer("null")(bench.types.get(GRID).decode(grid(bench)))
    assert payload(client) == b'{"op":"publish","topic":"/t","msg":' + whole + b"}"


async def test_others_have_their_turn_while_a_large_message_is_encoded(bench: Bench):
    bench.ros.add_publisher("/small", STRING)
    client = subscribed(bench)
    other = bench.client()
    (encoding,) = encodings(bench)
    other.send(op="subscribe", topic="/small", type=STRING)
    bench.ros.publish("/t", grid(bench))
    await begun(encoding)
    bench.say("/small", "x")
    await bench.settle()
    assert (len(other.messages), len(client.messages)) == (1, 0)
    await client.sees(1)


async def test_small_samples_are_encoded_at_once(bench: Bench, encoded: Counter[str]):
    client = subscribed(bench)
    assert LARGE_SAMPLE_BYTES == 262_144
    overhead = len(grid(bench, []))
    for size in (LARGE_SAMPLE_BYTES - overhead, LARGE_SAMPLE_BYTES - overhead + 1):
        bench.ros.publish("/t", grid(bench, [0] * size))
        await eventually(lambda: len(client.messages) == 1)
        client.frames.clear()
    assert encoded == {"null": 1}


TEXTS = "sensor_msgs/msg/JointState"


@pytest.mark.parametrize(
    ("compression", "more", "is_large"),
    [("none", 0, False), ("none", 1, True), ("cbor", 1, True), ("cbor-raw", 1, False)],
)
async def test_messages_of_elements_are_large_earlier(
    bench: Bench, compression: str, more: int, is_large: bool
):
    assert LARGE_ELEMENTS_BYTES == 32_768
    client = subscribed(bench, TEXTS, compression=compression)
    (encoding,) = encodings(bench)
    asked: list[Any] = []
    encode = encoding._large.encode
    encoding._large.encode = lambda shared: asked.append(shared) or encode(shared)
    bare = len(bench.cdr(TEXTS, effort=[], name=["a"]))
    text = "a" * (LARGE_ELEMENTS_BYTES - bare + 1 + more)
    cdr = bench.cdr(TEXTS, name=[text])
    cdr = cdr + bytes(max(0, LARGE_ELEMENTS_BYTES + more - len(cdr)))
    bench.ros.publish("/t", cdr[: LARGE_ELEMENTS_BYTES + more])
    await eventually(lambda: bool(client.frames))
    assert bool(asked) == is_large


async def test_a_small_sample_does_not_overtake_a_large_one(bench: Bench):
    client = subscribed(bench, queue_length=3)
    for cells in (CELLS, [1], [2]):
        bench.ros.publish("/t", grid(bench, cells))
    await client.sees(3)
    assert [len(message["data"]) for message in client.messages] == [len(CELLS), 1, 1]


async def test_of_samples_that_come_while_one_is_encoded_the_newest_is_next(bench: Bench):
    client = subscribed(bench, meta=True)
    (encoding,) = encodings(bench)
    bench.ros.publish("/t", grid(bench))
    await begun(encoding)
    for _ in range(3):
        bench.ros.publish("/t", grid(bench))
        await asyncio.sleep(0)
    await client.sees(2)
    await bench.settle()
    first, last = client.of("publish")
    assert (first["seq"], last["seq"], last["dropped"]) == (1, 4, 2)


async def test_one_large_sample_of_an_encoding_is_encoded_at_a_time():
    key = EncodingKey(RosbridgeFraming(), "/t", None, None)
    ready: list[None] = []
    topic = EncodedTopic("/t", lambda: ready.append(None), lambda: False, lambda: 0)
    workers: Any = None
    large = LargeSamples(
        lambda cdr: iter([cdr] * 3), lambda error: None, topic, EncodingResources(workers)
    )
    encoding = Encoding(key, bytes, lambda error: None, large)
    cdr = bytes(LARGE_SAMPLE_BYTES + 1)
    one, other = (SharedFrame(encoding, Sample(cdr, 0), seq) for seq in (1, 2))
    assert [each.frame() for each in (one, other, one, other)] == [NOT_READY] * 4
    assert [one.is_being_encoded, other.is_being_encoded] == [True, False]
    await eventually(lambda: bool(ready))
    frame = one.frame()
    assert isinstance(frame, Chunks)
    assert len(frame) > 3 * len(cdr)
    assert other.frame() is NOT_READY
    assert other.is_being_encoded


async def test_a_frame_stays_in_pieces_and_its_message_is_shared(bench: Bench):
    shared = [subscribed(bench) for _ in range(2)]
    meta = subscribed(bench, meta=True)
    bench.ros.publish("/t", grid(bench))
    for client in (*shared, meta):
        await client.sees(1)
    one, other = (client.wires for client in shared)
    assert all(mine is theirs for mine, theirs in zip(one, other, strict=True))
    assert all(mine is theirs for mine, theirs in zip(one[1:], meta.wires[1:], strict=True))
    assert {len(piece) >= 64 * 1024 for piece in one[1:-2]} == {True}
    assert (shared[0].session.outbox.sent, meta.of("publish")[0]["seq"]) == (1, 1)


def test_small_pieces_are_joined_up_to_64_kib():
    shared: Any = type("Shared", (), {})()
    job = _Job(shared, iter([b"x" * 1024] * 130), lambda _: None)
    while job.step():
        pass
    assert [len(part) for part in job.parts] == [64 * 1024, 64 * 1024, 2 * 1024]


@pytest.mark.parametrize("form", ["null", "string", "token"])
async def test_non_finite_numbers_have_the_form_that_was_asked_for(bench: Bench, form: str):
    cdr = bench.cdr(NUMBERS, data=[1.5, "NaN", "-Infinity"] * 15_000)
    client = subscribed(bench, NUMBERS, nonfinite=form)
    bench.ros.publish("/t", cdr)
    await client.sees(1)
    expected = writer(form)(bench.types.get(NUMBERS).decode(cdr))  # type: ignore[arg-type]
    assert expected in payload(client)


@pytest.mark.parametrize("compression", ["cbor", "cbor-raw"])
async def test_cbor_is_not_copied(bench: Bench, compression: str):
    plain = subscribed(bench, compression=compression)
    meta = subscribed(bench, compression=compression, meta=True)
    cdr = grid(bench)
    bench.ros.publish("/t", cdr)
    for client in (plain, meta):
        (frame,) = await client.sees(1)
        message = frame["msg"]
        if compression == "cbor":
            assert untagged(message["data"]) == CELLS
        else:
            assert message["bytes"] == cdr
            assert set(message) == {"secs", "nsecs", "bytes"}
        largest = max(client.wires, key=len)
        assert largest is cdr or largest.obj is cdr  # type: ignore[attr-defined]  # a view
    assert meta.of("publish")[0]["seq"] == 1


@pytest.mark.parametrize("type_name", [NUMBERS, GRID])
async def test_a_worker_that_makes_a_png_lets_others_run_between_slices(
    bench: Bench, monkeypatch: pytest.MonkeyPatch, type_name: str
):
    pauses: list[float] = []
    monkeypatch.setattr(encoders, "time", SimpleNamespace(sleep=pauses.append))
    client = subscribed(bench, type_name, compression="png", nonfinite="string")
    values: dict[str, Any] = {"data": CELLS}
    if type_name == NUMBERS:
        values = {"data": ["NaN", 1.5] * 30_000, "layout": {"dim": [{"label": "größe"}]}}
    bench.ros.publish("/t", bench.cdr(type_name, **values))
    (frame,) = await client.sees(1, "png")
    text = text_in(frame["data"])
    assert text.isascii()
    message = json.loads(text)["msg"]
    assert message["data"] == values["data"]
    assert type_name == GRID or message["layout"]["dim"][0]["label"] == "größe"
    assert len(pauses) > len(values["data"]) // SLICE_NUMBERS
    assert min(pauses) > 0


async def test_fragments_of_a_large_message_amount_to_it(bench: Bench):
    client = subscribed(bench, fragment_size=100_000)
    bench.ros.publish("/t", grid(bench))
    fragments = await client.sees(9, "fragment")
    assert fragments[0]["total"] == len(fragments)
    assert json.loads("".join(each["data"] for each in fragments))["msg"]["data"] == CELLS


async def test_ros_sharp_gets_escapes_in_a_large_message_too(bench: Bench):
    client = subscribed(bench, STRING, compression="none", fragment_size=ROS_SHARP, queue_length=0)
    text = "größe \U0001f916" * 30_000
    bench.ros.publish("/t", bench.cdr(STRING, data=text))
    assert (await client.sees(1))[0]["msg"]["data"] == text
    assert payload(client).isascii()


@pytest.mark.parametrize("compression", ["none", "cbor"])
async def test_a_large_sample_that_cannot_be_decoded_is_reported_once(
    bench: Bench, compression: str
):
    client = subscribed(bench, compression=compression)
    for _ in range(3):
        bench.ros.publish("/t", grid(bench)[:-1])
        await bench.settle()
    bench.ros.publish("/t", grid(bench))
    await client.sees(1)
    assert [code for code, _ in client.statuses] == ["invalid_value"]
    assert client.session.outbox.sent == 2  # the status and the good one


async def test_a_sample_that_turns_out_to_be_broken_late_is_reported(bench: Bench):
    path = "nav_msgs/msg/Path"
    client = subscribed(bench, path)
    bench.ros.publish("/t", bench.cdr(path, poses=[{}] * 5000)[:-1])
    await client.sees(1, "status")
    assert client.statuses[0][0] == "invalid_value"
    assert client.messages == []


async def test_a_fault_of_ours_is_logged_with_the_topic(
    bench: Bench, caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr(encoders, "json_slices", lambda *_: 1 // 0)
    subscribed(bench)
    bench.ros.publish("/t", grid(bench))
    await eventually(lambda: bool(caplog.records))
    (record,) = caplog.records
    assert (record.getMessage(), vars(record)["topic"]) == ("encoding a sample failed", "/t")


async def test_late_subscribers_with_equal_options_cause_one_encoding(
    bench: Bench, encoded: Counter[str]
):
    bench.ros.add_publisher("/t", GRID, LATCHED)
    early = subscribed(bench)
    bench.ros.publish("/t", grid(bench))
    await early.sees(1)
    for meta in (False, True):
        late = subscribed(bench, meta=meta)
        await late.sees(1)
        assert late.messages == early.messages
        assert late.wires[1] is early.wires[1]
    other = subscribed(bench, nonfinite="string")
    await other.sees(1)
    assert encoded == {"null": 1, "string": 1}


async def test_a_newer_sample_takes_the_place_of_the_kept_one(bench: Bench, encoded: Counter[str]):
    bench.ros.add_publisher("/t", GRID, LATCHED)
    early = subscribed(bench)
    for count, cells in enumerate((CELLS, CELLS[1:]), 1):
        bench.ros.publish("/t", grid(bench, cells))
        await early.sees(count)
    late = subscribed(bench)
    await late.sees(1)
    assert late.messages == [early.messages[1]]
    assert encoded == {"null": 2}


async def test_nothing_is_kept_of_a_topic_that_is_not_latched(bench: Bench):
    client = subscribed(bench)
    bench.ros.publish("/t", grid(bench))
    await client.sees(1)
    assert bench.router._subscriptions._resources.kept.size == 0


async def test_kept_messages_go_with_the_last_subscription(bench: Bench):
    bench.ros.add_publisher("/t", GRID, LATCHED)
    client = subscribed(bench)
    bench.ros.publish("/t", grid(bench))
    await client.sees(1)
    kept = bench.router._subscriptions._resources.kept
    assert kept.size > len(CELLS)
    client.send(op="unsubscribe", topic="/t")
    assert kept.size == 0


async def test_a_message_that_is_ready_after_the_last_subscription_is_not_kept(bench: Bench):
    bench.ros.add_publisher("/t", GRID, LATCHED)
    client = subscribed(bench)
    (encoding,) = encodings(bench)
    bench.ros.publish("/t", grid(bench))
    await begun(encoding)
    client.send(op="subscribe", topic="/t", nonfinite="string")  # waiting samples still come
    await client.sees(1)
    assert client.messages[0]["data"] == CELLS
    assert bench.router._subscriptions._resources.kept.find(encoding._large, (0, None)) is None
    assert encoding._large not in bench.router._subscriptions._resources.kept._kept


async def test_a_message_that_nobody_waits_for_is_not_encoded_to_the_end(bench: Bench):
    client = subscribed(bench)
    (encoding,) = encodings(bench)
    bench.ros.publish("/t", grid(bench))
    await begun(encoding)
    job = encoding._large._job
    client.send(op="unsubscribe", topic="/t")
    await eventually(lambda: job.is_over)
    assert sum(map(len, job.parts)) < 2 * len(CELLS)


async def test_more_topics_than_may_be_encoded_at_once_have_their_turn(
    bench: Bench, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr(slices, "MAX_JOBS", 1)
    clients = []
    for number in range(3):
        bench.ros.add_publisher(f"/t{number}", GRID)
        client = bench.sender(op="subscribe", topic=f"/t{number}", type=GRID)
        clients.append(client)
    for number in range(3):
        bench.ros.publish(f"/t{number}", grid(bench))
    for client in clients:
        await client.sees(1)
        assert client.messages[0]["data"] == CELLS
