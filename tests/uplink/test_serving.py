# SPDX-License-Identifier: Apache-2.0
"""`serve --uplink` as a process over DDS, and the commands that name an uplink."""

import contextlib

from gateway.sources.options import RosOptions
from gateway.sources.source import Qos
from tests.client import client, eventually
from tests.gateway_process import gateway_process
from tests.sources.test_contract import Received
from tests.sources.zenoh.conftest import open_source_on
from tests.sources.zenoh.outside import Router, free_port

STRING = "std_msgs/msg/String"


async def test_a_robot_over_dds_is_there_for_relays():
    async with contextlib.AsyncExitStack() as stack:
        router = stack.enter_context(contextlib.closing(Router()))
        flags = ("--uplink", router.address, "--robot-name", "r1")
        gateway = await stack.enter_async_context(gateway_process("serve", *flags))
        options = RosOptions(domain_id=0, node_prefix="relay")
        relay = stack.enter_context(open_source_on(router.address, options, namespace="gw/r1"))
        local = await stack.enter_async_context(client(gateway.url))
        await local.send(op="advertise", topic="/greeting", type=STRING, latch=True)
        await local.send(op="publish", topic="/greeting", msg={"data": "hello"})
        await eventually(lambda: relay.topic_types("/greeting") == (STRING,))
        received = Received()
        relay.subscribe("/greeting", STRING, Qos(), received.on_samples, received.on_event)

        def has_come() -> bool:
            return any(b"hello" in cdr for cdr in received.cdrs)

        await local.send(op="publish", topic="/greeting", msg={"data": "hello"})
        await eventually(has_come)
        nodes = [each for each in relay.graph().nodes if "relay" not in each]
        assert "/ros2_gateway_debug" in nodes
        service = "/ros2_gateway_debug/get_parameters"
        await eventually(lambda: bool(relay.service_types(service)))


async def test_a_gateway_serves_without_the_router_of_its_uplink():
    flags = ("--uplink", f"tcp/127.0.0.1:{free_port()}", "--robot-name", "r1")
    async with gateway_process("serve", *flags) as gateway, client(gateway.url) as local:
        await local.sync()
        await eventually(lambda: any("cannot be reached" in line for line in gateway.log))
