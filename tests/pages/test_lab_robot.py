# SPDX-License-Identifier: Apache-2.0
"""The robot of the lab by its description, its front, and a point cloud in the room."""

import base64
import struct

import pytest

from tests.pages.conftest import page_address
from tests.pages.lab import KEEP, SMALL, opened

pytestmark = pytest.mark.asyncio(loop_scope="package")

# a box of 0.4 m, on whose front a wheel turns
URDF = """<robot name="box"><link name="base_footprint"><visual><geometry>
<box size="0.4 0.2 0.2"/></geometry></visual></link><link name="wheel"><visual><geometry>
<sphere radius="0.01"/></geometry></visual></link>
<joint name="turn" type="continuous"><parent link="base_footprint"/><child link="wheel"/>
<origin xyz="0.1 0 0"/><axis xyz="0 0 1"/></joint></robot>"""
# the body of a description, without a room
MAKE = """async ([urdf, joints]) => {
    const { Body } = await import("/lab/body.js");
    const material = () => ({});
    const body = new Body({ material });
    const before = body.front;
    body.describe({}, urdf);
    const after = body.front;
    if (joints) body.move(joints);
    let turned = 0;
    body.object.traverse(({ quaternion }) => { turned = Math.max(turned, quaternion.z); });
    return { before, after, turned, root: body.root, problem: body.problem };
}"""


async def test_the_robot_is_that_of_its_description(demo, speaker, open_page):
    async with opened(open_page, page_address(demo)) as page:
        await page.wait_for_function("() => lab.twin.body.isDescribed")
        assert await page.evaluate("() => lab.twin.body.root") == "base_footprint"
        shown = """() => {
            const meshes = [];
            lab.twin.body.object.traverseVisible((each) => each.isMesh && meshes.push(each));
            return meshes.length;
        }"""
        assert await page.evaluate(shown) > 8  # the simulated robot's bodies, and the arrow
        assert 0.1 < await page.evaluate("() => lab.twin.body.front") < 0.2


async def test_the_arrow_begins_where_the_robot_ends_and_joints_move_it(evaluate):
    joints = {"name": ["turn", "other"], "position": [1.0, 9]}
    made = await evaluate(MAKE, [URDF, joints])
    assert made["before"] != made["after"]
    assert made["after"] == pytest.approx(0.2)
    assert made["turned"] == pytest.approx(0.479, abs=1e-3)  # the sine of half a radian
    assert made["problem"] == ""


async def test_a_huge_description_keeps_its_arrow_in_the_room(evaluate):
    made = await evaluate(MAKE, [URDF.replace("0.4 0.2 0.2", "4000 2 2"), None])
    assert made["after"] == 5


async def test_an_invalid_description_is_told_of(demo, speaker, open_page):
    topic = {"topic": "/other/robot_description"}
    await speaker.send(op="advertise", **topic, type="std_msgs/msg/String", latch=True)
    await speaker.send(op="publish", **topic, msg={"data": "<x/>"})
    address = f"{page_address(demo)}lab#description=/other/robot_description"
    async with open_page(address, viewport=SMALL) as page:
        await page.evaluate(KEEP)
        words = "() => notice.textContent.includes('description of the robot cannot be shown')"
        await page.wait_for_function(words)
        assert not await page.evaluate("() => lab.twin.body.isDescribed")


async def test_a_point_cloud_stands_in_the_room_where_its_frame_is(demo, speaker, open_page):
    places = [(1.0, 0.5, 0.25), (1.0, -0.5, 0.25), (2.0, 0.0, 1.0)]
    octets = b"".join(struct.pack("<fff", *place) for place in places)
    fields = [
        {"name": name, "offset": 4 * at, "datatype": 7, "count": 1}
        for at, name in enumerate(("x", "y", "z"))
    ]
    cloud = {
        "header": {"frame_id": "base_footprint"},
        "height": 1,
        "width": 3,
        "fields": fields,
        "point_step": 12,
        "row_step": 36,
        "data": base64.b64encode(octets).decode(),
        "is_dense": True,
    }
    topic = {"topic": "/three_points"}  # the simulated robot publishes another cloud
    type_name = "sensor_msgs/msg/PointCloud2"
    async with opened(open_page, page_address(demo), "cloud=/three_points") as page:
        assert await page.evaluate("() => lab.cloud.points") == 0
        await speaker.send(op="advertise", **topic, type=type_name, latch=True)
        await speaker.send(op="publish", **topic, msg=cloud)
        await page.wait_for_function("() => lab.cloud.points === 3")
        # the last point in the metres of the robot
        place = """() => {
            const points = lab.cloud.world.getObjectByProperty("type", "Points");
            const body = lab.twin.body.object.parent;
            for (const each of [points, body]) each.updateWorldMatrix(true, false);
            const { position } = points.geometry.attributes;
            return [0, 1, 2].map((at) => {
                const place = lab.viewer.rig.position.clone().fromBufferAttribute(position, at);
                return body.worldToLocal(points.localToWorld(place)).toArray();
            });
        }"""
        found = sorted(await page.evaluate(place))
        expected = sorted(list(each) for each in places)
        assert found == [pytest.approx(each, abs=0.02) for each in expected]
