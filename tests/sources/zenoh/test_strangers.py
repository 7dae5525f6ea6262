# SPDX-License-Identifier: Apache-2.0
"""Peers that do what no node of ROS does, and a robot that is there twice."""

import asyncio
import contextlib

from gateway.sources.services import ServiceRequest
from gateway.sources.zenoh import replier, token_changes, token_graph
from gateway.sources.zenoh.replier import MAX_NAMED_FAULTS
from tests.client import eventually
from tests.sources.test_contract import INT32, number
from tests.sources.test_contract_services import SET_BOOL, echo, request, soon, text_of
from tests.sources.zenoh.conftest import open_robot
from tests.sources.zenoh.outside import client, hash_of
from tests.sources.zenoh.test_session import subscribe
from tests.sources.zenoh.world import ATTACHMENT


async def test_a_sample_of_a_time_before_1970_has_no_time_of_its_publisher():
    with open_robot() as (source, world):
        received = subscribe(source, "/count")
        publisher = world.add_publisher("/count", INT32)
        attachment = ATTACHMENT.pack(-(2**63), -(2**63), 16, publisher.gid)

        def arrives() -> bool:
            publisher._publisher.put(number(1), attachment=attachment)
            return bool(received.cdrs)

        await eventually(arrives)
        assert {each.source_ns for batch in received.batches for each in batch} == {0}


async def test_names_with_signs_of_zenoh_are_left_out_alone():
    with open_robot() as (source, world):
        held = []
        live = world.session.liveliness()
        of_type = f"std_msgs::msg::dds_::Int32_/{hash_of(INT32)}/::,10:,:,:,,"
        for name in ("%a%%b", "%a$b", "a", "%", "$*", "%a%25b"):
            with contextlib.suppress(Exception):  # Zenoh refuses some of them itself
                held.append(live.declare_token(f"{world.token('MP')}/{name}/{of_type}"))
        held.append(live.declare_token(f"{world.token('MP')}/%good/{of_type}"))
        await eventually(lambda: source.topic_types("/good") == (INT32,))
        assert len(held) > 1
        assert [each for each in source.topics() if each != "/rosout"] == ["/good"]


async def test_a_server_that_never_replies_holds_up_no_other():
    with open_robot() as (source, world):
        requests: list[ServiceRequest] = []
        world.add_service("/silent", SET_BOOL, requests.append)
        world.add_service("/arm", SET_BOOL, echo)
        silent, arm = (source.services.client(each, SET_BOOL) for each in ("/silent", "/arm"))
        waiting = [asyncio.ensure_future(silent.call(request(True))) for _ in range(5)]
        await eventually(lambda: len(requests) == 5)
        assert text_of(await soon(arm.call(request(True)))) == "got True"
        for each in waiting:
            each.cancel()
        await eventually(lambda: not silent.requester._queries)
        silent.close()
        assert source.entity_count() == 1


async def test_requests_that_cannot_be_read_fill_no_log(monkeypatch, caplog):
    assert MAX_NAMED_FAULTS == 8
    monkeypatch.setattr(replier, "MAX_NAMED_FAULTS", 2)
    with open_robot() as (source, world):
        service = source.services.serve("/arm", SET_BOOL, echo)
        calling = world.add_client("/arm", SET_BOOL)
        assert text_of(await soon(calling.call(request(True)))) == "got True"
        for _ in range(5):
            calling._querier.get(lambda _: None, payload=b"", attachment=b"foreign")
        await eventually(lambda: service._replier.left_out == 5)
        assert caplog.text.count("service /arm: a request is left out") == 2


async def test_a_robot_that_is_there_twice_stays_until_both_have_gone():
    with open_robot() as (source, world):
        one, other = client(world.router), client(world.router)
        text = "@ros2_lv/117/abc/0/0/NN/%/%/twin"
        held = [each.liveliness().declare_token(text) for each in (one, other)]
        await eventually(lambda: "/twin" in source.graph().nodes)
        one.close()
        mark = world.session.liveliness().declare_token(text.replace("twin", "mark"))
        await eventually(lambda: "/mark" in source.graph().nodes)
        assert "/twin" in source.graph().nodes
        other.close()
        await eventually(lambda: "/twin" not in source.graph().nodes)
        del held, mark


async def test_too_many_tokens_are_a_fault_and_samples_come_all_the_same(monkeypatch):
    with open_robot() as (source, world):
        received = subscribe(source, "/count")
        publisher = world.add_publisher("/count", INT32)
        await eventually(lambda: source.topic_types("/count") == (INT32,))
        monkeypatch.setattr(token_graph, "MAX_OF_NAME", 3)
        known = len(source._changes._known)
        monkeypatch.setattr(token_changes, "MAX_TOKENS", known + 30)
        monkeypatch.setattr(token_changes, "MAX_LEFT_OUT", 50)
        live, held = world.session.liveliness(), []

        def declare(count: int) -> None:
            of_type = f"std_msgs::msg::dds_::Int32_/{hash_of(INT32)}/::,10:,:,:,,"
            held.extend(
                live.declare_token(f"{world.token('MP')}/%flood/{of_type}") for _ in range(count)
            )

        def faults() -> str:
            return " ".join(each.text for each in source.faults())

        declare(20)
        await eventually(lambda: "more than 1024 publishers" in faults())
        declare(30)
        await eventually(lambda: "more than 32768 nodes and endpoints" in faults())
        declare(60)
        await eventually(lambda: "the gateway follows no more changes" in faults())

        def arrives() -> bool:
            publisher.publish(number(1))
            return bool(received.cdrs)

        await eventually(arrives)
        assert {each.severity for each in source.faults()} == {"degraded"}
