# SPDX-License-Identifier: Apache-2.0
"""The connection of an uplink: routers that come and go, names that are taken, roles."""

import contextlib
import logging

import pytest

from gateway.access.permissions import Policy
from gateway.config.access import AccessConfig, OperatorConfig
from gateway.errors import ConfigError
from gateway.sources.source import Qos
from gateway.uplink import link, mirror, offer, pace, topics, uplink
from gateway.uplink.uplink import own_name
from tests.client import eventually
from tests.core.conftest import ODOMETRY, STRING, TWIST
from tests.sources.test_contract_services import SET_BOOL, echo
from tests.sources.zenoh.outside import Router, client, free_port, session
from tests.uplink.conftest import Fleet, watched


def texts(one: uplink.Uplink) -> str:
    return "\n".join(each.text for each in one.faults())


async def test_the_graph_of_the_robot_is_that_of_its_relays(fleet: Fleet):
    ros = fleet.bench.ros
    ros.add_publisher("/odom", ODOMETRY)
    ros.add_publisher("/odom", ODOMETRY)
    subscription = ros.add_subscription("/odom", ODOMETRY, lambda _: None)
    ros.add_service("/arm", SET_BOOL, echo)
    await fleet.offered()
    relay = fleet.relay()
    await eventually(lambda: relay.service_types("/arm") == (SET_BOOL,))
    graph = relay.graph()
    (odom,) = (each for each in graph.topics if each.name == "/odom")
    assert odom.publishers == ("/outside", "/outside")
    assert odom.subscribers == ("/outside",)
    assert "/outside" in graph.nodes
    (arm,) = (each for each in graph.services if each.name == "/arm")
    assert arm.nodes == ("/outside",)
    ros.remove_subscription(subscription)
    await eventually(
        lambda: [each.subscribers for each in relay.graph().topics if each.name == "/odom"] == [()]
    )


async def test_topics_that_move_the_robot_are_shown_and_pass_nothing(fleet: Fleet):
    ros = fleet.bench.ros
    ros.add_publisher("/cmd_vel", TWIST)
    ros.add_subscription("/cmd_vel", TWIST, lambda _: None)
    ros.add_publisher("/odom", ODOMETRY)
    one = await fleet.offered()
    relay = fleet.relay()
    await eventually(lambda: relay.topic_types("/odom") == (ODOMETRY,))
    [shown] = [each for each in relay.graph().topics if each.name == "/cmd_vel"]
    assert (shown.types, shown.publishers, shown.subscribers) == ((TWIST,), (), ("/outside",))
    assert one.link is not None
    assert not {"/cmd_vel"} & {*one.link.offer.topics, *one.link.offer.inputs}
    publisher = relay.publishing.advertise("/cmd_vel", TWIST, Qos(), lambda _: None)
    publisher.publish(fleet.bench.cdr(TWIST))
    received, _ = watched(relay, "/odom", ODOMETRY)
    await eventually(lambda: ros.subscriptions and not received.cdrs)
    assert [each.topic for each in ros.publishers if ros.is_own(each.node)] == []


async def test_the_uplink_goes_on_when_its_router_comes_back(fleet: Fleet):
    publisher = fleet.bench.ros.add_publisher("/chatter", STRING)
    one = await fleet.offered()
    await fleet.restart_router()
    await eventually(lambda: one.link is not None and not one.faults())
    relay = fleet.relay()
    await eventually(lambda: relay.topic_types("/chatter") == (STRING,))
    received, _ = watched(relay, "/chatter", STRING)
    await eventually(lambda: one.link is not None and one.link.topics.flowing == {"/chatter"})
    publisher.publish(fleet.bench.cdr(STRING, data="x"))
    await eventually(lambda: received.cdrs == [fleet.bench.cdr(STRING, data="x")])


async def test_a_router_that_is_not_there_is_a_fault_until_it_is(fleet: Fleet):
    port = free_port()
    one = await fleet.uplink(endpoint=f"tcp/127.0.0.1:{port}")
    assert "is connecting" in texts(one)
    await eventually(lambda: "cannot be reached" in texts(one))
    assert "check uplink.endpoint" in texts(one)
    with contextlib.closing(Router(port)):
        await eventually(lambda: not one.faults())


async def test_a_router_that_passes_nothing_on_is_a_fault(
    fleet: Fleet, monkeypatch: pytest.MonkeyPatch
):
    assert pace.LOST_S == 5
    monkeypatch.setattr(pace, "LOST_S", 0.2)
    address = f"tcp/127.0.0.1:{free_port()}"
    rules = {
        "enabled": True,
        "default_permission": "deny",
        "rules": [],
        "subjects": [],
        "policies": [],
    }
    closed = session(mode="router", **{"listen/endpoints": [address], "access_control": rules})
    fleet.stack.callback(closed.close)
    one = await fleet.uplink(endpoint=address)
    await eventually(lambda: "passes nothing on" in texts(one))
    assert "access control" in texts(one)


async def test_two_robots_of_one_name_exclude_each_other(fleet: Fleet):
    assert uplink.RETRY_S == 2
    first = await fleet.offered()
    second = await fleet.uplink()
    await eventually(lambda: "another robot is connected" in texts(second))
    assert not first.faults()
    assert "uplink.robot_name" in texts(second)
    third = await fleet.uplink(robot_name="r2")
    await eventually(lambda: not third.faults())


async def test_a_robot_is_there_for_relays_while_its_uplink_is(fleet: Fleet):
    looking = client(fleet.router.address)
    fleet.stack.callback(looking.close)

    def robots() -> list[str]:
        found = looking.liveliness().get("gw/*/alive", timeout=2)
        return [str(each.ok.key_expr) for each in found if each.ok is not None]

    async with contextlib.AsyncExitStack() as stack:
        kept, fleet.stack = fleet.stack, stack
        await fleet.offered()
        fleet.stack = kept
        assert robots() == ["gw/r1/alive"]
    await eventually(lambda: robots() == [])


async def test_a_role_hides_what_it_may_not_see_and_may_change(fleet: Fleet):
    ros = fleet.bench.ros
    for name in ("/odom", "/secret"):
        ros.add_publisher(name, ODOMETRY)
    one = await fleet.offered()
    relay = fleet.relay()
    await eventually(lambda: relay.topic_types("/secret") == (ODOMETRY,))
    rules = OperatorConfig(subscribe=("/odom",), publish=(), call=())
    policy = Policy(AccessConfig(operator=rules))
    before = one.link
    one.reload(policy)
    await eventually(lambda: one.link not in {None, before} and not one.faults())
    await eventually(lambda: relay.topic_types("/secret") == ())
    await eventually(lambda: relay.topic_types("/odom") == (ODOMETRY,))
    same = one.link
    one.reload(policy)
    assert one.link is same


async def test_a_graph_without_end_is_cut_and_reported(
    fleet: Fleet, monkeypatch: pytest.MonkeyPatch
):
    assert offer.MAX_ENTITIES == 16_384
    monkeypatch.setattr(offer, "MAX_ENTITIES", 20)
    monkeypatch.setattr(uplink, "MAX_ENTITIES", 20)
    one = await fleet.offered()
    for number in range(20):
        fleet.bench.ros.add_publisher(f"/topic{number}", STRING)
    await eventually(lambda: "more than 20 nodes and endpoints" in texts(one))
    assert one.link is not None
    assert len(one.link.mirror._declared) <= 20


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        ({"user": "r1"}, "uplink.user and uplink.user_file belong together"),
        ({"cert": "a.pem"}, "uplink.cert and uplink.key belong together"),
        ({"user": "r1", "user_file": "/nothing"}, "uplink.user_file: /nothing cannot be read"),
        ({"ca": "/nothing"}, "uplink.ca: /nothing: cannot be read, no such file"),
        ({"ca": __file__}, "uplink.ca: .*: no certificate in PEM"),
        ({"cert": "/no", "key": "/nothing"}, "uplink.cert and uplink.key: /no, /nothing: cannot"),
    ],
)
async def test_settings_that_cannot_work_are_named(fleet: Fleet, settings, words):
    with pytest.raises(ConfigError, match=words):
        await fleet.uplink(**settings)


async def test_a_password_opens_the_router(fleet: Fleet, tmp_path, caplog):
    caplog.set_level(logging.ERROR)
    users, secret = tmp_path / "users.txt", tmp_path / "password"
    users.write_text("r1:open sesame\n")
    address = f"tcp/127.0.0.1:{free_port()}"
    router = session(
        mode="router",
        **{
            "listen/endpoints": [address],
            "transport/auth/usrpwd/dictionary_file": str(users),
            "transport/auth/usrpwd/user": "router",
            "transport/auth/usrpwd/password": "router",
        },
    )
    fleet.stack.callback(router.close)
    secret.write_text("wrong\n")
    settings = {"endpoint": address, "user": "r1", "user_file": str(secret)}
    refused = await fleet.uplink(**settings)
    await eventually(lambda: "refuses the name 'r1' or its password" in texts(refused))
    assert "sesame" not in texts(refused)
    secret.write_text("open sesame\n")
    await fleet.offered(**settings)


@pytest.mark.parametrize(
    ("host", "name"),
    [("Robot-7.lan", "robot-7"), ("Küche 1", "k-che-1"), ("x" * 40, "x" * 32), ("", "robot")],
)
def test_a_machine_gives_its_robot_a_name(host: str, name: str):
    assert own_name(host) == name


def test_publishers_of_a_latched_topic_are_kept_apart_up_to_a_limit():
    assert topics.MAX_KEPT_PUBLISHERS == 64


async def test_names_that_others_cannot_read_are_not_offered(
    fleet: Fleet, caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch
):
    assert (mirror.MAX_NAMED_ODD, link.FOLLOW_S) == (8, 0.25)
    monkeypatch.setattr(mirror, "MAX_NAMED_ODD", 2)
    caplog.set_level(logging.WARNING)
    await fleet.offered()
    relay = fleet.relay()
    for number, name in enumerate(("/a%b", "/*", "/$x", "/good")):
        fleet.bench.ros.add_publisher(name, STRING, node=f"/node{number}")
    await eventually(lambda: relay.topic_types("/good") == (STRING,))
    assert {each for each in relay.topics() if not each.startswith("/ros")} <= {"/good", "/rosout"}
    assert caplog.text.count("not a name of ROS") == 2


async def test_an_uplink_that_fails_says_so_and_tries_again(
    fleet: Fleet, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
):
    working = link.UplinkCalls
    monkeypatch.setattr(link, "UplinkCalls", lambda _: 1 / 0)
    one = await fleet.uplink()
    await eventually(lambda: "the uplink has failed" in texts(one))
    assert "ZeroDivisionError" in caplog.text
    monkeypatch.setattr(link, "UplinkCalls", working)
    await eventually(lambda: one.link is not None and not one.faults())
