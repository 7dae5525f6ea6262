# SPDX-License-Identifier: Apache-2.0
import base64

import numpy as np
import pytest

from gateway.codec.cloud import CLOUD
from tests.client import eventually
from tests.core.conftest import ODOMETRY, Bench


def cloud_of(bench: Bench, count: int, first: float = 0.0) -> bytes:
    points = np.zeros((count, 3), "<f4")
    points[:, 0] = first + np.arange(count)
    fields = [
        {"name": name, "offset": 4 * at, "datatype": 7, "count": 1} for at, name in enumerate("xyz")
    ]
    return bench.cdr(
        CLOUD,
        height=1,
        width=count,
        fields=fields,
        point_step=12,
        row_step=12 * count,
        data=base64.b64encode(points.tobytes()).decode(),
    )


async def test_a_thinned_cloud_comes_to_clients_that_ask_and_whole_to_others(bench: Bench):
    thinned = bench.listener("/cloud", CLOUD, cloud={"max_points": 10})
    whole = bench.client()
    whole.send(op="subscribe", topic="/cloud")
    bench.ros.publish("/cloud", cloud_of(bench, 100))
    message = (await thinned.sees(1))[0]["msg"]
    assert (message["points"], message["of"], message["available"]) == (10, 100, ["x", "y", "z"])
    assert len(base64.b64decode(message["data"])) == 60
    assert (await whole.sees(1))[0]["msg"]["width"] == 100
    assert thinned.statuses == []


async def test_clients_with_the_same_options_share_a_thinned_cloud(bench: Bench):
    bench.ros.add_publisher("/cloud", CLOUD)
    one, other = bench.client(), bench.client()
    for client in (one, other):
        client.send(op="subscribe", topic="/cloud", cloud={})
    bench.ros.publish("/cloud", cloud_of(bench, 5))
    await one.sees(1)
    await other.sees(1)
    assert one.wires[-1] is other.wires[-1]


async def test_while_one_cloud_is_in_the_works_only_the_newest_waits(bench: Bench):
    client = bench.listener("/cloud", CLOUD, cloud={}, meta=True)
    for first in range(20):
        bench.ros.publish("/cloud", cloud_of(bench, 5, first))
    await eventually(lambda: any(frame["seq"] == 20 for frame in client.of("publish")))
    sent = [frame["seq"] for frame in client.of("publish")]
    assert sent[-2:] != [19, 20]
    assert len(sent) + client.of("publish")[-1]["dropped"] == 20


@pytest.mark.parametrize(
    ("kind", "options", "words"),
    [
        (ODOMETRY, {}, f"cloud: {ODOMETRY} cannot be thinned, only {CLOUD}, sending plain"),
        (CLOUD, {"compression": "cbor-raw"}, "cloud: cbor-raw sends whole messages"),
        (CLOUD, {"fields": ["width"]}, "name fields in cloud.fields, sending plain messages"),
    ],
)
async def test_a_client_learns_why_its_clouds_are_whole(bench: Bench, kind, options, words):
    client = bench.listener("/t", kind, cloud={}, **options)
    (status,) = client.of("status")
    assert (status["level"], status["code"]) == ("warning", "bad_request")
    assert words in status["msg"]


@pytest.mark.parametrize(
    ("cloud", "words"),
    [
        ({"max_point": 5}, "cloud.max_point: unknown; did you mean max_points?"),
        ({"voxel_m": 0}, "cloud.voxel_m"),
        ({"fields": ["x"] * 9}, "cloud.fields"),
    ],
)
async def test_other_options_are_refused(bench: Bench, cloud, words):
    client = bench.listener("/cloud", CLOUD, cloud=cloud)
    (status,) = client.of("status")
    assert (status["level"], status["code"]) == ("error", "bad_request")
    assert words in status["msg"]


async def test_a_cloud_without_the_field_is_a_warning(bench: Bench):
    client = bench.listener("/cloud", CLOUD, cloud={"fields": ["ring"]})
    bench.ros.publish("/cloud", cloud_of(bench, 5))
    (status,) = await client.sees(1, "status")
    assert status["code"] == "invalid_value"
    assert status["msg"] == "/cloud: the cloud has no field 'ring', its fields are x, y, z"
