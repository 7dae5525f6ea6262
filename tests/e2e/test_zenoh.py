# SPDX-License-Identifier: Apache-2.0
"""A robot that speaks Zenoh, served by the command line without rclpy."""

import asyncio
import contextlib
import os
import subprocess
import sys

from gateway.codec.types import Types
from gateway.sources.source import Qos
from gateway.tf import TF_MESSAGE
from schemas.folders import SHIPPED
from schemas.installed import InstalledDefinitions
from schemas.type_hash import type_hash
from tests.client import client, eventually
from tests.gateway_process import gateway_process
from tests.sources.zenoh.outside import (
    DOMAIN,
    Router,
    ZenohOutside,
    free_port,
)

MODULE = "tests.without_rclpy"


def said(*arguments: str, code: str = "") -> subprocess.CompletedProcess[str]:
    program = ("-m", MODULE) if not code else ("-c", code)
    command = (sys.executable, *program, "serve", *arguments)
    return subprocess.run(command, capture_output=True, text=True, check=False, env=os.environ)


async def test_a_client_of_rosbridge_gets_a_topic_of_a_robot_behind_a_router():
    with contextlib.ExitStack() as stack:
        router = stack.enter_context(contextlib.closing(Router()))
        world = stack.enter_context(contextlib.closing(ZenohOutside(router.address)))
        publisher = world.add_publisher("/count", "std_msgs/msg/Int32")
        arguments = ("--zenoh", router.address, "--domain-id", str(DOMAIN))
        async with (
            gateway_process("serve", *arguments, module=MODULE) as gateway,
            client(gateway.url) as watching,
        ):
            await watching.send(op="subscribe", topic="/count")
            message = asyncio.create_task(watching.message("/count"))

            def arrives() -> bool:
                publisher.publish(b"\0\1\0\0\7\0\0\0")
                return message.done()

            await eventually(arrives)
            assert await message == {"data": 7}
            await watching.send(op="call_service", id="t", service="/rosapi/topics")
            answer = await watching.receive(lambda frame: frame.get("id") == "t")
            assert "/count" in answer["values"]["topics"]


async def test_transforms_of_the_robot_are_looked_up():
    shipped = InstalledDefinitions(folders=[SHIPPED])
    encode = Types(shipped).get(TF_MESSAGE).encode
    told = type_hash(shipped.get(TF_MESSAGE), shipped)
    link = {
        "header": {"frame_id": "map"},
        "child_frame_id": "base",
        "transform": {"translation": {"x": 1.5}, "rotation": {"w": 1}},
    }
    with contextlib.ExitStack() as stack:
        router = stack.enter_context(contextlib.closing(Router()))
        world = stack.enter_context(contextlib.closing(ZenohOutside(router.address)))
        latched = Qos("reliable", "transient_local", "keep_last", 1)
        publisher = world.add_publisher("/tf_static", TF_MESSAGE, latched, told)
        publisher.publish(encode({"transforms": [link]}, 0))
        arguments = ("--zenoh", router.address, "--domain-id", str(DOMAIN))
        async with (
            gateway_process("serve", *arguments, module=MODULE) as gateway,
            client(gateway.url) as person,
        ):
            frames = {"target_frame": "map", "source_frame": "base"}
            await person.send(op="lookup_transform", id="t", timeout=30, **frames)
            found = await person.receive(lambda frame: frame.get("id") == "t")
            assert found["transform"]["transform"]["translation"]["x"] == 1.5


async def test_messages_of_another_type_are_reported_and_the_next_one_arrives():
    with contextlib.ExitStack() as stack:
        router = stack.enter_context(contextlib.closing(Router()))
        world = stack.enter_context(contextlib.closing(ZenohOutside(router.address)))
        publisher = world.add_publisher("/count", "std_msgs/msg/Int32")
        arguments = ("--zenoh", router.address, "--domain-id", str(DOMAIN))
        async with (
            gateway_process("serve", *arguments, module=MODULE) as gateway,
            client(gateway.url) as watching,
        ):
            await watching.send(op="subscribe", topic="/count")
            status = asyncio.create_task(watching.receive(lambda frame: frame["op"] == "status"))

            def is_reported() -> bool:
                for payload in (b"", b"\0", b"\xff" * 900, b"\0\1\0\0\7\0"):
                    publisher.publish(payload)
                return status.done()

            await eventually(is_reported)
            assert "/count" in (await status)["msg"]
            publisher.publish(b"\0\1\0\0\7\0\0\0")
            assert await watching.message("/count") == {"data": 7}


def test_a_router_that_is_not_there_is_named():
    address = f"tcp/127.0.0.1:{free_port()}"
    ended = said("--zenoh", address)
    assert ended.returncode != 0
    assert f"the Zenoh router {address} cannot be reached" in ended.stderr
    assert "Traceback" not in ended.stderr


def test_an_address_without_a_protocol_is_refused():
    ended = said("--zenoh", "robot:7447")
    assert ended.returncode == 2
    assert "got 'robot:7447', expected PROTOCOL/HOST:PORT such as tcp/robot:7447" in ended.stderr


def test_the_missing_package_is_named_with_how_to_get_it():
    code = (
        "import sys; sys.modules['zenoh'] = None\n"
        "from gateway.cli.main import main; sys.exit(main())"
    )
    ended = said("--zenoh", "tcp/robot:7447", code=code)
    assert ended.returncode == 2
    assert "zenoh is missing: install the packages that speak Zenoh" in ended.stderr
    assert "pip install '.[zenoh]'" in ended.stderr
