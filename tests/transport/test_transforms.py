# SPDX-License-Identifier: Apache-2.0
"""tf2_web_republisher over sockets: requests of clients, and answers while others move."""

from gateway.tf import TF_MESSAGE
from tests.client import Client, Frame, client, eventually
from tests.sources.fake import FakePublisher
from tests.transport.conftest import Serve, Served

NODE = "/tf2_web_republisher"
REQUEST = {"source_frames": ["base_link"], "target_frame": "odom", "rate": 100, "trans_thres": 0.1}


def drive(served: Served, publisher: FakePublisher, sec: int, x: float) -> None:
    stamped = {
        "header": {"stamp": {"sec": sec, "nanosec": 0}, "frame_id": "odom"},
        "child_frame_id": "base_link",
        "transform": {"translation": {"x": x}},
    }
    publisher.publish(served.cdr(TF_MESSAGE, transforms=[stamped]))


def x_of(array: Frame) -> float:
    [stamped] = array["transforms"]
    return float(stamped["transform"]["translation"]["x"])


async def ask_by_action(asking: Client) -> None:
    await asking.send(op="send_action_goal", id="g", action=NODE, feedback=True, args=REQUEST)


async def ask_by_service(asking: Client) -> str:
    await asking.send(op="call_service", id="c", service="/republish_tfs", args=REQUEST)
    response = await asking.receive(lambda frame: frame["op"] == "service_response")
    topic = str(response["values"]["topic_name"])
    await asking.send(op="subscribe", topic=topic)
    return topic


async def ask_by_topics(asking: Client) -> None:
    await asking.send(op="subscribe", topic=f"{NODE}/feedback")
    message = {"goal_id": {"id": "g"}, "goal": REQUEST}
    await asking.send(op="publish", topic=f"{NODE}/goal", msg=message)


async def test_clients_follow_a_frame_in_three_ways_until_they_end_it_or_leave(serve: Serve):
    async with serve() as served, client(served.url) as action, client(served.url) as service:
        publisher = served.ros.add_publisher("/tf", TF_MESSAGE)
        async with client(served.url) as topics:
            await ask_by_action(action)
            topic = await ask_by_service(service)
            await ask_by_topics(topics)
            await eventually(lambda: served.server.health()["transforms"] == 3)
            for sec, x in ((1, 2.0), (2, 4.0)):
                drive(served, publisher, sec, x)
                feedback = await action.receive()
                assert (feedback["op"], feedback["id"]) == ("action_feedback", "g")
                assert x_of(feedback["values"]) == x
                assert x_of(await service.message(topic)) == x
                assert x_of((await topics.message(f"{NODE}/feedback"))["feedback"]) == x
        await eventually(lambda: served.server.health()["transforms"] == 2)
        await action.send(op="cancel_action_goal", id="g", action=NODE)
        await service.send(op="unsubscribe", topic=topic)
        assert (await action.receive())["op"] == "action_result"
        await service.sync()
        assert served.server.health()["transforms"] == 0
