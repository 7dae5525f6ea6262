# SPDX-License-Identifier: Apache-2.0
"""The configuration reaches the parts that it is for."""

import dataclasses

import pytest
from websockets.exceptions import ConnectionClosed, InvalidStatus

from gateway import app
from gateway.config.model import Config, LimitsConfig, RosConfig
from gateway.protocol.limits import Limits
from gateway.ros import RosOptions
from gateway.server.timing import Timing
from tests.client import client
from tests.gateway_process import gateway_process

# Each value is unlike every other and unlike every default.
CONFIG = Config(
    ros=RosConfig(node_prefix="arm", namespace="/robot7", domain_id=7, use_sim_time=True),
    limits=LimitsConfig(
        max_clients=3,
        max_clients_per_address=2,
        open_timeout_s=11,
        max_message_bytes=1201,
        frames_per_s=1301,
        frame_burst=1302,
        operations_per_s=1303,
        operation_burst=1304,
        max_subscriptions=1305,
        max_advertisements=1306,
        max_pending_calls=1312,
        max_goals=1313,
        max_transforms=1314,
        service_timeout_s=16,
        max_ros_entities=1307,
        max_name_characters=108,
        max_json_depth=109,
        max_json_items=1310,
        max_queue_length=1311,
        send_queue_bytes=65_537,
        slow_consumer_s=12,
        send_deadline_s=13,
        ping_interval_s=14,
        ping_timeout_s=15,
        close_timeout_s=1.5,
    ),
)
LIMITS = Limits(
    message_bytes=1201,
    json_depth=109,
    json_items=1310,
    name_characters=108,
    frames_per_s=1301,
    frames_burst=1302,
    operations_per_s=1303,
    operations_burst=1304,
    subscriptions=1305,
    advertisements=1306,
    pending_calls=1312,
    goals=1313,
    transforms=1314,
    service_timeout_s=16,
    send_queue_bytes=65_537,
    queue_length=1311,
)
TIMING = Timing(
    open_timeout_s=11,
    ping_interval_s=14,
    ping_timeout_s=15,
    send_deadline_s=13,
    slow_consumer_s=12,
    close_timeout_s=1.5,
)
ROS_OPTIONS = RosOptions(
    node_prefix="arm", namespace="/robot7", domain_id=7, use_sim_time=True, max_entities=1307
)
NOT_CONFIGURED = {"arguments", "taking"}  # for tests, and for who embeds the gateway


@pytest.mark.parametrize(
    ("made", "expected"),
    [
        (app._limits(CONFIG), LIMITS),
        (app._timing(CONFIG), TIMING),
        (app._ros_options(CONFIG), ROS_OPTIONS),
    ],
    ids=["limits", "timing", "ros"],
)
def test_every_value_of_the_configuration_reaches_its_place(made, expected):
    assert made == expected
    # so that a field which nothing sets, or two that are swapped, cannot pass
    for field in dataclasses.fields(expected):
        if field.name not in NOT_CONFIGURED:
            assert getattr(expected, field.name) != field.default, field.name
    values = [repr(value) for value in dataclasses.astuple(expected)]
    assert len(set(values)) == len(values)


async def test_an_allowed_page_may_connect_and_a_foreign_one_gets_403():
    origins = "https://ui.example,https://wall.example"
    async with gateway_process("serve", "--set", f"allowed_origins={origins}") as gateway:
        async with client(gateway.url, origin="https://wall.example") as page:
            await page.sync()
        with pytest.raises(InvalidStatus) as refused:
            async with client(gateway.url, origin="https://foreign.example"):
                pass
        assert refused.value.response.status_code == 403


async def test_the_bounds_on_clients_and_the_path_reach_the_server():
    arguments = ("--path", "/ros", "--set", "limits.max_clients=3")
    bound = ("--set", "limits.max_clients_per_address=2")
    async with gateway_process("serve", *arguments, *bound) as gateway:
        assert gateway.url.endswith("/ros")
        async with client(gateway.url) as one, client(gateway.url) as two:
            await one.sync()
            await two.sync()
            with pytest.raises(ConnectionClosed, match="at most 2 clients per address"):
                async with client(gateway.url) as third:
                    await third.sync()
