# SPDX-License-Identifier: Apache-2.0
import pytest

from gateway.codec.types import Types
from gateway.core.requests import Advertise
from gateway.core.topics.requested_qos import offered, subscribed
from gateway.core.topics.subscription_options import SubscriptionOptions
from gateway.fronts.rosbridge.operations.topics import QosRequest, Subscribe
from schemas.installed import InstalledDefinitions

TYPES = Types(InstalledDefinitions())
SMALL = TYPES.get("std_msgs/msg/String")


@pytest.mark.parametrize(
    ("type_name", "options", "depth"),
    [
        ("nav_msgs/msg/Odometry", {}, 1024),
        ("nav_msgs/msg/Odometry", {"queue_length": 1}, 1024),
        ("nav_msgs/msg/Odometry", {"qos": {"reliability": "best_effort"}}, 1024),
        ("nav_msgs/msg/Odometry", {"qos": {"depth": 7}}, 7),
        ("sensor_msgs/msg/Image", {}, None),
        ("sensor_msgs/msg/Image", {"queue_length": 32}, None),
        ("sensor_msgs/msg/Image", {"queue_length": 33}, 33),
        ("sensor_msgs/msg/Image", {"queue_length": 5000}, 1024),
        ("sensor_msgs/msg/Image", {"queue_length": 100, "qos": {"depth": 2}}, 2),
    ],
)
def test_dds_keeps_many_small_messages_and_of_large_ones_what_a_client_asks_for(
    type_name, options, depth
):
    merged = SubscriptionOptions.merge([Subscribe(topic="/t", **options).request()])
    assert subscribed(merged, TYPES.get(type_name)).depth == depth


@pytest.mark.parametrize(("queue_size", "depth"), [(0, None), (1, 1), (1025, 1025)])
def test_a_queue_size_asks_for_as_many_samples(queue_size, depth):
    assert offered(Advertise(topic="/t", type="x", queue_size=queue_size), SMALL).depth == depth


def test_a_publisher_of_large_messages_keeps_few_of_them():
    large = TYPES.get("sensor_msgs/msg/Image")
    assert offered(Advertise(topic="/t", type="x"), large).depth == 10
    assert offered(Advertise(topic="/t", type="x", queue_size=20), large).depth == 20


@pytest.mark.parametrize(
    ("qos", "durability", "lifespan_ns"),
    [
        (None, "transient_local", 4_000_000_000),
        ({}, "transient_local", 4_000_000_000),
        ({"durability": "best_available"}, "transient_local", 4_000_000_000),
        ({"lifespan": 0.25}, "transient_local", 250_000_000),
        ({"lifespan": 4.001}, None, 4_001_000_000),  # volatile, or what is old would come
        ({"durability": "volatile"}, "volatile", None),
        ({"durability": "transient_local"}, "transient_local", None),
    ],
)
def test_the_default_qos_matches_late_subscribers_and_keeps_nothing_old(
    qos, durability, lifespan_ns
):
    request = Advertise(
        topic="/t", type="x", qos=None if qos is None else QosRequest(**qos).request()
    )
    offer = offered(request, SMALL)
    assert (offer.durability, offer.lifespan_ns) == (durability, lifespan_ns)


@pytest.mark.parametrize("nothing", [0, 0.0, {"secs": 0, "nsecs": 0}, {}, "infinite", None])
def test_a_duration_of_zero_means_no_limit_as_in_ros(nothing):
    asked = QosRequest(deadline=nothing, lifespan=nothing).request()
    assert (asked.deadline_ns, asked.lifespan_ns) == (None, None)


@pytest.mark.parametrize("short", [1e-9, {"nsecs": 1}])
def test_the_shortest_duration_is_a_limit(short):
    assert QosRequest(deadline=short).request().deadline_ns == 1


def test_a_latched_topic_keeps_the_last_message():
    offer = offered(Advertise(topic="/t", type="x", latch=True, queue_size=9), SMALL)
    assert (offer.depth, offer.durability, offer.lifespan_ns) == (1, "transient_local", None)
