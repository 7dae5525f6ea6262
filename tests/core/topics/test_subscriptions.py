# SPDX-License-Identifier: Apache-2.0
import base64

import cv2
import numpy as np
import pytest

from gateway.sources.source import Qos, RosError
from tests.client import eventually
from tests.core.conftest import ODOMETRY, STRING, Bench

MANY = "at most 4 subscriptions per client: end one, or raise limits.max_subscriptions"
LATCHED = Qos(durability="transient_local", depth=1)


async def test_a_sample_reaches_a_subscriber_as_a_publish_frame(bench: Bench):
    client = bench.listener("/chatter", STRING)
    bench.say("/chatter", "hello")
    assert await client.sees(1) == [
        {"op": "publish", "topic": "/chatter", "msg": {"data": "hello"}}
    ]


async def test_a_topic_comes_back_as_the_client_spelt_it(bench: Bench):
    bench.ros.add_publisher("/chatter", STRING)
    one, other = bench.client(), bench.client()
    one.send(op="subscribe", topic="chatter")
    other.send(op="subscribe", topic="/chatter")
    bench.ros.publish("/chatter", bench.cdr(STRING))
    assert (await one.sees(1))[0]["topic"] == "chatter"
    assert (await other.sees(1))[0]["topic"] == "/chatter"
    assert bench.ros.entity_count() == 1


@pytest.mark.parametrize("form", [9, "9", "nav_msgs/Odometry", "nav_msgs/msg/Odometry"])
async def test_a_type_may_be_a_number_or_a_name_in_both_forms(bench: Bench, form):
    client = bench.sender(op="subscribe", topic="/odom", type=form)
    assert [subscription.type_name for subscription in bench.ros.subscriptions] == [ODOMETRY]
    assert client.statuses == []


async def test_clients_share_one_ros_subscription_until_the_last_one_leaves(bench: Bench):
    clients = [bench.client() for _ in range(3)]
    for client in clients:
        client.send(op="subscribe", topic="/chatter", type=STRING)
    assert bench.ros.entity_count() == 1
    for client in clients[:2]:
        bench.router.leave(client.session)
    assert bench.ros.entity_count() == 1
    clients[2].send(op="unsubscribe", topic="/chatter")
    assert bench.ros.entity_count() == 0


async def test_another_qos_is_another_ros_subscription(bench: Bench):
    one, other = bench.client(), bench.client()
    one.send(op="subscribe", topic="/chatter", type=STRING)
    other.send(op="subscribe", topic="/chatter", type=STRING, qos={"reliability": "best_effort"})
    assert bench.ros.entity_count() == 2
    assert bench.ros.subscriptions[1].qos.reliability == "best_effort"


async def test_subscribing_twice_makes_one_stream_not_two(bench: Bench):
    bench.ros.add_publisher("/chatter", STRING)
    client = bench.sender(op="subscribe", id="a", topic="/chatter")
    client.send(op="subscribe", id="b", topic="/chatter")
    bench.say("/chatter", "once")
    await client.sees(1)
    await bench.settle()
    assert client.messages == [{"data": "once"}]


async def test_unsubscribing_by_id_leaves_the_other_subscription(bench: Bench):
    bench.ros.add_publisher("/odom", ODOMETRY)
    client = bench.sender(op="subscribe", id="all", topic="/odom")
    client.send(op="subscribe", id="part", topic="/odom", fields=["child_frame_id"])
    client.send(op="unsubscribe", id="all", topic="/odom")
    bench.ros.publish("/odom", bench.cdr(ODOMETRY, child_frame_id="base"))
    assert (await client.sees(1))[0]["msg"] == {"child_frame_id": "base"}


async def test_unsubscribing_what_is_not_subscribed_says_so(bench: Bench):
    client = bench.sender(op="unsubscribe", topic="/chatter")
    client.send(op="subscribe", id="a", topic="/chatter", type=STRING)
    client.send(op="unsubscribe", id="b", topic="/chatter")
    assert client.statuses == [
        ("not_found", "not subscribed to /chatter"),
        ("not_found", "not subscribed to /chatter with id 'b'"),
    ]
    assert bench.ros.entity_count() == 1


async def test_a_topic_that_nobody_knows_is_waited_for_with_a_word(bench: Bench):
    bench.ros.add_publisher("/odometry", ODOMETRY)
    client = bench.sender(op="subscribe", topic="/odometri")
    assert client.statuses == [
        ("not_found", "topic /odometri is not known yet, waiting for it; did you mean /odometry?")
    ]
    bench.ros.add_publisher("/odometri", STRING)
    await eventually(lambda: bench.ros.entity_count() == 1)
    bench.say("/odometri", "at last")
    assert (await client.sees(1))[0]["msg"] == {"data": "at last"}


async def test_a_topic_that_returns_with_another_type_is_followed(bench: Bench):
    first = bench.ros.add_publisher("/thing", STRING)
    client = bench.sender(op="subscribe", topic="/thing")
    await bench.settle()
    bench.ros.remove_publisher(first)
    bench.ros.add_publisher("/thing", "std_msgs/msg/Int32")
    await eventually(
        lambda: [own.type_name for own in bench.ros.subscriptions] == ["std_msgs/msg/Int32"]
    )
    bench.ros.publish("/thing", bench.cdr("std_msgs/msg/Int32", data=7))
    assert (await client.sees(1))[0]["msg"] == {"data": 7}


async def test_a_type_that_contradicts_the_topic_is_refused(bench: Bench):
    bench.ros.add_publisher("/odom", ODOMETRY)
    client = bench.sender(op="subscribe", id=1, topic="/odom", type=STRING)
    assert client.statuses == [("type_conflict", f"topic /odom has type {ODOMETRY}, not {STRING}")]
    assert bench.ros.entity_count() == 0


async def test_a_topic_that_ros_refuses_is_not_counted(
    bench: Bench, monkeypatch: pytest.MonkeyPatch
):
    def refuse(*_: object) -> None:
        raise RosError("internal", "no memory")

    monkeypatch.setattr(bench.ros, "subscribe", refuse)
    client = bench.sender(op="subscribe", topic="/t", type=STRING)
    assert client.statuses == [("internal", "no memory")]
    assert "/t" not in [counted.topic for counted in bench.router.traffic().topics]


@pytest.mark.parametrize(
    ("options", "code", "words"),
    [
        ({"type": "no/Such"}, "bad_type", "no definition of no/msg/Such"),
        ({"type": "nonsense"}, "bad_type", "is not a valid message type"),
        ({"type": 4711}, "bad_type", "no number 4711"),
        ({"type": STRING, "topic": "/a b"}, "bad_name", "is not a valid topic name"),
        ({"type": STRING, "fields": ["date"]}, "bad_request", "fields: "),
        ({"type": STRING, "qos": {"depth": 0}}, "bad_request", "qos.depth: expected at least 1"),
        ({"type": STRING, "qos": {"dept": 1}}, "bad_request", "qos.dept: unknown"),
        ({"type": 5, "image": {"quality": 101}}, "bad_request", "image.quality: expected at most"),
        ({"type": 5, "image": {"depth_range_m": [5, 1]}}, "bad_request", "depth_range_m"),
        ({"type": 5, "image": {"depth_range_m": [0, 5000]}}, "bad_request", "depth range"),
        ({"type": STRING, "throttle_rate": -1}, "bad_request", "throttle_rate: expected at least"),
    ],
)
async def test_a_subscription_that_cannot_be_is_refused_and_leaves_nothing(
    bench: Bench, options, code, words
):
    client = bench.sender(**{"op": "subscribe", "id": "s", "topic": "/t", **options})
    (answer,) = client.of("status")
    assert (answer["code"], answer["id"], answer["level"]) == (code, "s", "error")
    assert words in answer["msg"]
    assert bench.ros.entity_count() == 0


async def test_a_refused_change_leaves_the_subscription_as_it_was(bench: Bench):
    bench.ros.add_publisher("/odom", ODOMETRY)
    client = bench.sender(op="subscribe", id="a", topic="/odom", fields=["child_frame_id"])
    client.send(op="subscribe", id="a", topic="/odom", fields=["nonsense"])
    bench.ros.publish("/odom", bench.cdr(ODOMETRY, child_frame_id="base"))
    await client.sees(1)
    assert client.messages == [{"child_frame_id": "base"}]


async def test_subscriptions_are_limited_per_client(bench: Bench):
    client = bench.client()
    for number in range(5):
        client.send(op="subscribe", topic=f"/t{number}", type=STRING)
    assert client.statuses == [("limit_exceeded", MANY)]
    assert bench.ros.entity_count() == 4


async def test_each_request_counts_as_a_subscription(bench: Bench):
    client = bench.client()
    for number in range(5):
        client.send(op="subscribe", id=number, topic="/t", type=STRING)
    assert client.statuses == [("limit_exceeded", MANY)]


async def test_a_queue_is_no_longer_than_its_limit(bench: Bench):
    client = bench.client()
    for length in (1024, 1025):
        client.send(op="subscribe", topic=f"/t{length}", type=STRING, queue_length=length)
    (warning,) = client.of("status")
    assert (warning["level"], warning["code"]) == ("warning", "limit_exceeded")
    assert warning["msg"] == (
        "queue_length: 1025 is longer than allowed, 1024 messages wait: for more, raise "
        "limits.max_queue_length"
    )
    assert {each.options.queue_length for each in bench.router._subscriptions._all()} == {1024}


async def test_a_depth_larger_than_dds_keeps_is_accepted(bench: Bench):
    client = bench.sender(op="subscribe", topic="/t", type=STRING, qos={"depth": 5000})
    client.send(op="advertise", topic="/u", type=STRING, qos={"depth": 5000})
    client.send(op="advertise", topic="/v", type=STRING, queue_size=5000)
    assert client.statuses == []
    assert bench.ros.entity_count() == 3


async def test_names_in_a_subscription_come_back_truncated(bench: Bench):
    client = bench.sender(op="subscribe", topic="/a", type=STRING, compression="x" * 200)
    client.send(op="subscribe", topic="/b", type=STRING, fields=["x" * 200])
    assert client.statuses == [
        ("bad_request", f"compression: '{'x' * 125}...' is not available, sending plain JSON"),
        ("bad_request", f"fields: unknown field {'x' * 111}..."),
    ]


async def test_meta_numbers_samples_and_counts_what_was_dropped(bench: Bench):
    client = bench.listener("/chatter", STRING, meta=True, queue_length=2)
    client.is_paused = True
    bench.say("/chatter", *map(str, range(5)))
    await bench.settle()
    client.resume()
    assert [(frame["seq"], frame["dropped"]) for frame in client.of("publish")] == [(4, 3), (5, 3)]
    assert client.frames[0]["received"] == {"sec": 1_700_000_000, "nanosec": 0}


async def test_an_offer_that_does_not_match_is_told_to_everyone_concerned(bench: Bench):
    bench.ros.add_publisher("/scan", STRING, Qos(reliability="best_effort"))
    one, other = bench.client(), bench.client()
    one.send(op="subscribe", topic="/scan", qos={"reliability": "reliable"})
    await one.sees(1, "status")
    other.send(op="subscribe", topic="/scan", qos={"reliability": "reliable"})
    for client in (one, other):
        (status,) = await client.sees(1, "status")
        assert status["code"] == "qos_incompatible"
        assert "best_effort" in status["msg"]


async def test_samples_that_a_paused_client_loses_are_never_decoded(bench: Bench):
    client = bench.listener("/chatter", STRING, queue_length=1)
    client.is_paused = True
    bench.ros.publish("/chatter", b"\0\1\0\0\xff\xff\xff\xff")  # would be reported if decoded
    bench.say("/chatter", "newest")
    await bench.settle()
    client.resume()
    assert client.messages == [{"data": "newest"}]
    assert client.statuses == []


@pytest.mark.parametrize("queue_length", [0, 1])
async def test_on_a_latched_topic_each_publishers_last_sample_passes_a_throttle(
    bench: Bench, queue_length: int
):
    latched = Qos(durability="transient_local", depth=1)
    for name in "abcde":
        bench.ros.add_publisher("/tf_static", STRING, latched).publish(bench.cdr(STRING, data=name))
    for _ in range(2):  # the second one comes late
        client = bench.client()
        client.send(op="subscribe", topic="/tf_static", throttle_rate=50, queue_length=queue_length)
        await client.sees(5)
        assert [message["data"] for message in client.messages] == list("abcde")


async def test_a_change_while_a_sample_is_held_back_does_not_stop_the_stream(bench: Bench):
    bench.ros.add_publisher("/chatter", STRING)
    client = bench.sender(op="subscribe", id="a", topic="/chatter", throttle_rate=50)
    bench.say("/chatter", "first", "held")
    await client.sees(1)
    client.send(op="subscribe", id="a", topic="/chatter", throttle_rate=50, meta=True)
    await client.sees(2)
    bench.say("/chatter", "later")
    await client.sees(3)
    assert [message["data"] for message in client.messages] == ["first", "held", "later"]


async def test_samples_that_a_throttle_skips_count_as_dropped(bench: Bench):
    client = bench.listener("/chatter", STRING, throttle_rate=50, meta=True)
    bench.say("/chatter", *map(str, range(6)))
    await eventually(lambda: client.of("publish")[-1:] and client.of("publish")[-1]["seq"] == 6)
    last = client.of("publish")[-1]
    assert last["dropped"] == 6 - len(client.of("publish")) > 0


async def test_a_former_interval_does_not_cut_the_new_one_short(bench: Bench):
    bench.ros.add_publisher("/chatter", STRING)
    one, other = bench.client(), bench.client()
    one.send(op="subscribe", id="a", topic="/chatter", throttle_rate=20)
    other.send(op="subscribe", topic="/chatter", throttle_rate=60)
    bench.say("/chatter", "1", "2")
    await one.sees(1)
    one.send(op="subscribe", id="a", topic="/chatter", throttle_rate=3_600_000)
    bench.say("/chatter", "3", "4")
    await other.sees(2)  # by then the former interval is also over
    await one.sees(3)
    assert [message["data"] for message in one.messages] == ["1", "2", "3"]


async def test_a_change_of_qos_while_a_frame_is_in_the_works_does_not_stop_the_stream(
    bench: Bench,
):
    publisher = bench.ros.add_publisher("/map", STRING, LATCHED)
    other = bench.sender(op="subscribe", topic="/map")
    publisher.publish(bench.cdr(STRING, data="walls" * 100_000))
    await other.sees(1)
    client = bench.sender(op="subscribe", id="a", topic="/map", compression="png")
    client.send(op="subscribe", id="a", topic="/map", compression="none", qos={"depth": 1})
    await client.sees(1)
    publisher.publish(bench.cdr(STRING, data="doors"))
    await client.sees(2)
    assert [message["data"][:5] for message in client.messages] == ["walls", "doors"]
    assert client.of("png") == []


async def test_another_qos_on_a_latched_topic_delivers_what_waits_once(bench: Bench):
    publisher = bench.ros.add_publisher("/map", STRING, LATCHED)
    publisher.publish(bench.cdr(STRING, data="walls"))
    client = bench.client()
    client.is_paused = True
    client.send(op="subscribe", id="a", topic="/map")
    await bench.settle()
    client.send(op="subscribe", id="a", topic="/map", qos={"depth": 1})
    await bench.settle()
    client.resume()
    assert client.messages == [{"data": "walls"}]


async def test_a_warning_carries_the_id_of_the_newest_subscription_that_was_accepted(bench: Bench):
    client = bench.client()
    for name in ("first", "second", "third", "first"):
        qos = {"reliability": "reliable"}
        client.send(op="subscribe", id=name, topic="/t", type=STRING, qos=qos)
    client.send(op="subscribe", id="refused", topic="/t", fields=["nonsense"])
    client.send(op="unsubscribe", id="second", topic="/t")
    client.frames.clear()
    bench.ros.add_publisher("/t", STRING, Qos(reliability="best_effort"))
    (status,) = await client.sees(1, "status")
    assert (status["code"], status["id"]) == ("qos_incompatible", "first")


async def test_a_subscription_that_is_replaced_has_the_newest_word(bench: Bench):
    bench.ros.add_publisher("/camera", "sensor_msgs/msg/Image")
    client = bench.client()
    for name, width in (("a", 16), ("b", 32), ("a", 48)):
        client.send(op="subscribe", id=name, topic="/camera", image={"max_width": width})
    bench.ros.publish("/camera", picture_of(bench, (1, 2, 3)))
    assert (await client.sees(1))[0]["msg"]["width"] == 48


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"fields": ["nonsense"]}, "fields: "),
        ({"fields": ["data"], "compression": "cbor-raw"}, "cbor-raw sends whole messages"),
    ],
)
async def test_fields_are_checked_next_to_a_subscription_to_everything(
    bench: Bench, options, words
):
    client = bench.sender(op="subscribe", id="all", topic="/t", type=STRING)
    client.send(**{"op": "subscribe", "id": "wrong", "topic": "/t", **options})
    (status,) = client.of("status")
    assert (status["code"], status["id"]) == ("bad_request", "wrong")
    assert words in status["msg"]
    client.send(op="unsubscribe", id="wrong", topic="/t")
    assert client.statuses[-1][0] == "not_found"


def picture_of(bench: Bench, colour: tuple[int, int, int], width: int = 64) -> bytes:
    pixels = np.full((48, width, 3), colour, np.uint8)
    return bench.cdr(
        "sensor_msgs/msg/Image",
        header={"frame_id": "camera"},
        height=48,
        width=width,
        encoding="rgb8",
        step=width * 3,
        data=base64.b64encode(pixels.tobytes()).decode(),
    )


async def test_an_image_comes_as_jpeg_in_the_shape_of_compressed_image(bench: Bench):
    client = bench.listener("/camera", "sensor_msgs/msg/Image")
    bench.ros.publish("/camera", picture_of(bench, (200, 30, 10)))
    message = (await client.sees(1))[0]["msg"]
    assert list(message) == ["header", "format", "data", "width", "height"]
    assert message["header"]["frame_id"] == "camera"
    decoded = cv2.imdecode(
        np.frombuffer(base64.b64decode(message["data"]), np.uint8), cv2.IMREAD_COLOR
    )
    assert decoded.shape == (48, 64, 3)
    assert np.abs(decoded.mean(axis=(0, 1)) - (10, 30, 200)).max() < 4


async def test_raw_pixels_and_single_fields_of_an_image_come_when_asked_for(bench: Bench):
    bench.ros.add_publisher("/camera", "sensor_msgs/msg/Image")
    raw, fields = bench.client(), bench.client()
    raw.send(op="subscribe", topic="/camera", image={"format": "raw"})
    fields.send(op="subscribe", topic="/camera", fields=["width"])
    bench.ros.publish("/camera", picture_of(bench, (1, 2, 3)))
    assert base64.b64decode((await raw.sees(1))[0]["msg"]["data"])[:6] == bytes((1, 2, 3, 1, 2, 3))
    assert (await fields.sees(1))[0]["msg"] == {"width": 64}


async def test_a_compressed_image_is_encoded_again_only_on_request(bench: Bench):
    kind = "sensor_msgs/msg/CompressedImage"
    bench.ros.add_publisher("/camera", kind)
    done, png = cv2.imencode(".png", np.zeros((48, 64, 3), np.uint8))
    assert done
    plain, slower, raw, smaller = (bench.client() for _ in range(4))
    plain.send(op="subscribe", topic="/camera")
    slower.send(op="subscribe", topic="/camera", image={"max_fps": 30})
    raw.send(op="subscribe", topic="/camera", image={"format": "raw", "max_width": 32})
    smaller.send(op="subscribe", topic="/camera", image={"max_width": 32})
    data = base64.b64encode(png.tobytes()).decode()
    bench.ros.publish("/camera", bench.cdr(kind, format="rgb8; png", data=data))
    for client in (plain, slower, raw):
        message = (await client.sees(1))[0]["msg"]
        assert (message["format"], message["data"]) == ("rgb8; png", data)
    message = (await smaller.sees(1))[0]["msg"]
    assert (message["format"], message["width"], message["height"]) == ("jpeg", 32, 24)


async def test_a_client_that_asks_for_a_picture_learns_why_there_is_no_picture(bench: Bench):
    kind = "sensor_msgs/msg/CompressedImage"
    client = bench.listener("/camera", kind, image={"max_width": 32})
    bench.ros.publish("/camera", bench.cdr(kind, format="tiff", data=[1, 2, 3]))
    await client.sees(1, "status")
    assert client.statuses == [("invalid_value", "/camera: data is neither JPEG nor PNG")]


async def test_the_default_format_is_that_of_the_connection(bench: Bench):
    bench.ros.add_publisher("/camera", "sensor_msgs/msg/Image")
    usual, asking = bench.client(image_format="raw"), bench.client(image_format="raw")
    usual.send(op="subscribe", topic="/camera", image={"max_fps": 30})
    asking.send(op="subscribe", topic="/camera", image={"format": "png"})
    bench.ros.publish("/camera", picture_of(bench, (1, 2, 3)))
    assert (await usual.sees(1))[0]["msg"]["encoding"] == "rgb8"
    assert (await asking.sees(1))[0]["msg"]["format"] == "png"


async def test_while_one_picture_is_in_the_works_only_the_newest_waits(bench: Bench):
    client = bench.listener("/camera", "sensor_msgs/msg/Image", queue_length=1, meta=True)
    for shade in range(20):
        bench.ros.publish("/camera", picture_of(bench, (shade, shade, shade)))
    await eventually(lambda: any(frame["seq"] == 20 for frame in client.of("publish")))
    sent = [frame["seq"] for frame in client.of("publish")]
    assert sent == sorted(set(sent))
    assert len(sent) + client.of("publish")[-1]["dropped"] == 20


async def test_an_image_that_contradicts_itself_is_a_status_not_a_crash(bench: Bench):
    client = bench.listener("/camera", "sensor_msgs/msg/Image")
    wrong = bench.cdr("sensor_msgs/msg/Image", height=4, width=4, encoding="rgb8", step=3)
    bench.ros.publish("/camera", wrong)
    (status,) = await client.sees(1, "status")
    assert status["code"] == "invalid_value"
    assert "step" in status["msg"]
    bench.ros.publish("/camera", picture_of(bench, (0, 0, 0)))
    await client.sees(1)


async def test_an_unknown_compression_is_a_warning_and_plain_json(bench: Bench):
    client = bench.client()
    bench.ros.add_publisher("/chatter", STRING)
    client.send(op="subscribe", topic="/chatter", compression="zip")
    assert client.statuses == [
        ("bad_request", "compression: 'zip' is not available, sending plain JSON")
    ]
    assert client.of("status")[0]["level"] == "warning"
    bench.say("/chatter", "x")
    assert (await client.sees(1))[0]["msg"] == {"data": "x"}


@pytest.mark.parametrize("second", [{"id": "b"}, {"id": "b", "fields": ["data"]}, {"id": "a"}])
async def test_each_request_of_a_client_gets_what_a_latched_topic_keeps(bench: Bench, second):
    bench.ros.add_publisher("/map", STRING, LATCHED)
    client = bench.sender(op="subscribe", id="a", topic="/map")
    bench.say("/map", "walls")
    await client.sees(1)
    client.send(op="subscribe", topic="/map", **second)
    await client.sees(2)
    assert client.messages == [{"data": "walls"}] * 2
    bench.say("/map", "more")
    await client.sees(3)
    assert client.messages[2:] == [{"data": "more"}]


async def test_a_late_client_gets_a_sample_of_each_latching_publisher(bench: Bench):
    for number in range(3):
        publisher = bench.ros.add_publisher("/tf_static", STRING, LATCHED, node=f"/node{number}")
        publisher.publish(bench.cdr(STRING, data=str(number)))
    early, late = bench.client(), bench.client()
    early.send(op="subscribe", topic="/tf_static")
    await early.sees(3)
    late.send(op="subscribe", topic="/tf_static")
    await late.sees(3)
    assert sorted(map(str, late.messages)) == sorted(map(str, early.messages))


async def test_kept_samples_are_forgotten_once_the_topic_is_volatile(bench: Bench):
    latching = bench.ros.add_publisher("/map", STRING, LATCHED)
    latching.publish(bench.cdr(STRING, data="old"))
    early = bench.sender(op="subscribe", topic="/map")
    await early.sees(1)
    bench.ros.remove_publisher(latching)
    bench.ros.add_publisher("/map", STRING)
    await bench.settle()
    bench.say("/map", "new")
    await early.sees(2)
    late = bench.sender(op="subscribe", topic="/map")
    await bench.settle()
    assert late.messages == []


async def test_unsubscribing_a_throttled_topic_delivers_nothing_more(bench: Bench):
    client = bench.listener("/chatter", STRING, throttle_rate=20)
    bench.say("/chatter", "first", "held")
    await client.sees(1)
    client.send(op="unsubscribe", topic="/chatter")
    before = list(client.messages)
    other = bench.sender(op="subscribe", topic="/chatter", throttle_rate=50)
    for text in ("a", "b"):  # another client's interval is over later than ours would be
        bench.ros.publish("/chatter", bench.cdr(STRING, data=text))
    await other.sees(2)
    assert client.messages == before


async def test_subscribing_again_does_not_cut_a_throttle_interval_short(bench: Bench):
    bench.ros.add_publisher("/chatter", STRING)
    client = bench.client()
    for number in range(10):
        client.send(op="subscribe", id="a", topic="/chatter", throttle_rate=3_600_000)
        bench.ros.publish("/chatter", bench.cdr(STRING, data=str(number)))
        await bench.settle()
    assert client.messages == [{"data": "0"}]


async def test_a_subscription_may_be_replaced_at_the_limit(bench: Bench):
    client = bench.client()
    for number in range(4):
        client.send(op="subscribe", id=number, topic="/t", type=STRING)
    client.send(op="subscribe", id=3, topic="/t", type=STRING, throttle_rate=5)
    assert client.statuses == []


async def test_durations_of_qos_reach_ros(bench: Bench):
    client = bench.client()
    qos = {"deadline": {"secs": 1, "nsecs": 5}, "lifespan": 0.5, "history": "keep_last", "depth": 3}
    client.send(op="subscribe", topic="/t", type=STRING, qos={**qos, "reliability": "reliable"})
    client.send(op="subscribe", topic="/u", type=STRING, qos={"deadline": "infinite"})
    first, second = (subscription.asked for subscription in bench.ros.subscriptions)
    assert (first.deadline_ns, first.lifespan_ns, first.depth) == (1_000_000_005, 500_000_000, 3)
    assert (first.reliability, second.deadline_ns) == ("reliable", None)


async def test_best_available_adopts_what_is_offered(bench: Bench):
    bench.ros.add_publisher("/t", STRING, Qos(reliability="best_effort"))
    best = {"reliability": "best_available", "durability": "best_available"}
    bench.client().send(op="subscribe", topic="/t", qos=best)
    assert [own.qos.reliability for own in bench.ros.subscriptions] == ["best_effort"]


async def test_a_warning_about_qos_carries_the_id_and_ends_with_its_cause(bench: Bench):
    offender = bench.ros.add_publisher("/scan", STRING, Qos(reliability="best_effort"))
    one, other = bench.client(), bench.client()
    one.send(op="subscribe", id="one", topic="/scan", qos={"reliability": "reliable"})
    (status,) = await one.sees(1, "status")
    assert status["id"] == "one"
    bench.ros.remove_publisher(offender)
    await bench.settle()
    other.send(op="subscribe", topic="/scan", type=STRING, qos={"reliability": "reliable"})
    await bench.settle()
    assert other.statuses == []


async def test_a_topic_with_two_types_is_told_once_and_fed_when_one_is_left(bench: Bench):
    client = bench.sender(op="subscribe", topic="/thing")
    wrong = bench.ros.add_publisher("/thing", "std_msgs/msg/Int32")
    right = bench.ros.add_publisher("/thing", STRING)
    await bench.settle()
    bench.ros.add_publisher("/other", STRING)
    await bench.settle()
    assert [code for code, _ in client.statuses] == ["not_found", "type_conflict"]
    assert "choose one by `type`" in client.statuses[-1][1]
    bench.ros.remove_publisher(wrong)
    await eventually(lambda: bench.ros.entity_count() == 1)
    right.publish(bench.cdr(STRING, data="clear now"))
    assert (await client.sees(1))[0]["msg"] == {"data": "clear now"}


async def test_a_topic_that_is_received_twice_has_the_rate_of_the_one_that_gets_samples(
    bench: Bench,
):
    bench.ros.add_publisher("/chatter", STRING, Qos(reliability="best_effort"))
    receiving, deaf = bench.client(), bench.client()
    receiving.send(op="subscribe", topic="/chatter")
    deaf.send(op="subscribe", topic="/chatter", qos={"reliability": "reliable"})
    assert bench.ros.entity_count() == 2
    for _ in range(2):
        bench.ros.publish("/chatter", bench.cdr(STRING))
        await bench.settle()
    receiving.send(op="graph")
    (graph,) = receiving.of("graph")
    (topic,) = (each for each in graph["topics"] if each["name"] == "/chatter")
    assert topic["rate_hz"] > 0


async def test_meta_that_is_asked_for_while_a_sample_waits_is_not_made_up(bench: Bench):
    publisher = bench.ros.add_publisher("/map", STRING, LATCHED)
    publisher.publish(bench.cdr(STRING, data="walls"))
    first = bench.sender(op="subscribe", topic="/map")
    await first.sees(1)
    late = bench.client()
    late.is_paused = True
    late.send(op="subscribe", id="a", topic="/map")
    await bench.settle()
    late.send(op="subscribe", id="a", topic="/map", meta=True)
    late.resume()
    (frame,) = await late.sees(1)
    assert frame == {"op": "publish", "topic": "/map", "msg": {"data": "walls"}}


async def test_a_fault_of_ours_in_subscribing_leaves_nothing_open(
    bench: Bench, monkeypatch: pytest.MonkeyPatch
):
    def fail(*_: object, **__: object) -> None:
        raise ZeroDivisionError

    for topic in ("/a", "/b"):
        bench.ros.add_publisher(topic, STRING)
    client = bench.sender(op="subscribe", topic="/a")
    with monkeypatch.context() as patch:
        patch.setattr("gateway.core.topics.topic.make_encoding", fail)
        with pytest.raises(ZeroDivisionError):
            client.send(op="subscribe", topic="/b")
    bench.router.leave(client.session)
    assert bench.ros.entity_count() == 0


@pytest.mark.parametrize("durability", ["volatile", "transient_local"])
async def test_on_a_slow_link_only_what_is_said_again_makes_room_for_newer_ones(
    bench: Bench, durability
):
    bench.ros.add_publisher("/t", STRING, Qos(durability=durability, depth=100))
    client = bench.client()
    client.session.outbox.drains(1000)
    client.send(op="subscribe", topic="/t")
    client.is_paused = True
    bench.say("/t", *map(str, range(50)))
    await bench.settle()
    client.resume()
    texts = [message["data"] for message in client.messages]
    assert texts[-1] == "49"
    assert (len(texts) == 50) == (durability == "transient_local")
