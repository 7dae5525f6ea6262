# SPDX-License-Identifier: Apache-2.0
"""The scene: what it shows of each type, its layers and tools, and what it leaves behind."""

import asyncio
import base64
import re
from contextlib import asynccontextmanager

import cv2
import numpy as np
import pytest

from tests.client import client
from tests.demonstration import until_it_can_be_driven
from tests.pages.conftest import TIMEOUT_S, page_address, severable
from tests.pages.test_debug_page import NOTE_SENT, PHONE, until, until_painted

pytestmark = pytest.mark.asyncio(loop_scope="package")

SCENE = "#card=scene+0+/"
CANVAS = ".scene canvas"
# of a scan, in the picture as OpenCV reads it
MAGENTA = np.array([223, 90, 224])

# A scene of a gateway that says what the test says. `say` gives a topic a message
STAGE = """
    const { SceneView } = await import("/scene/scene.js");
    const { Graph } = await import("/shared/graph.js");
    const heard = new Map(), sent = [], listeners = new Map();
    const gateway = {
        graph: new Graph(), hello: {}, on: () => () => {},
        subscribe(topic, options, take) {
            heard.set(topic, take);
            sent.push({ op: "subscribe", topic, ...options });
            return () => heard.get(topic) === take && heard.delete(topic);
        },
        listen(take) {
            const id = `t${listeners.size}`;
            listeners.set(id, take);
            return { id, end: () => listeners.delete(id) };
        },
        send(operation) { sent.push(operation); return true; },
        ask: async ({ uri }) => { throw new Error(`there is no ${uri}`); },
    };
    const identity = { translation: { x: 1, y: 2, z: 0 }, rotation: { x: 0, y: 0, z: 0, w: 1 } };
    const knows = (topic, type) => gateway.graph.topics.set(
        topic, { name: topic, types: [type], publishers: ["/n"], subscribers: [] });
    const say = (topic, message) => heard.get(topic)?.(message);
    const card = { fill() {}, onFull: () => () => {} };
    const begin = (...kept) => put(card, kept);
    const put = (card, kept) => {
        const scene = new SceneView(gateway, kept, () => {}, card);
        document.body.append(scene.element);
        say("/tf", { transforms: [
            { header: { frame_id: "map" }, child_frame_id: "base_link", transform: identity },
        ] });
        scene.tick();
        return scene;
    };
    const header = { frame_id: "base_link" };
    const pose = { position: { x: 1, y: 0, z: 0 }, orientation: { x: 0, y: 0, z: 0, w: 1 } };
    const frame = () => new Promise(requestAnimationFrame);
"""

URDF = """<robot name="r">
  <material name="red"><color rgba="1 0 0 1"/></material>
  <link name="base_link">
    <visual><geometry><box size="1 1 1"/></geometry><material name="red"/></visual>
  </link>
  <link name="arm"><visual><origin xyz="0 0 1"/>
    <geometry><cylinder radius="1" length="2"/></geometry></visual></link>
  <link name="slide"><visual><geometry><sphere radius="1"/></geometry></visual></link>
  <link name="far"><visual><geometry><mesh filename="package://x/y.stl"/></geometry></visual></link>
  <joint name="shoulder" type="revolute"><parent link="base_link"/><child link="arm"/>
    <origin xyz="0 0 1" rpy="0 0 1.5707963"/><axis xyz="0 0 1"/></joint>
  <joint name="slider" type="prismatic"><parent link="arm"/><child link="slide"/>
    <axis xyz="1 0 0"/><mimic joint="shoulder" multiplier="2" offset="1"/></joint>
  <joint name="end" type="fixed"><parent link="slide"/><child link="far"/></joint>
</robot>"""

GRID = """{ header, data: new Int8Array([0, 100, -1, 0]),
    info: { resolution: 1, width: 2, height: 2, origin: pose } }"""
SCAN = """{ header, ranges: [1, NaN, 2], angle_min: 0, angle_increment: 0.1, range_min: 0.1,
    range_max: 9 }"""
CLOUD = """{ header, format: "int16", points: 2, of: 9, available: ["x", "y", "z", "ring"],
    fields: ["x", "y", "z"].map((name) => ({ name, scale: 0.5, offset: 1 })),
    data: new Uint8Array(12) }"""
ESTIMATE = """{ header, pose: { pose,
    covariance: Array.from({ length: 36 }, (_, at) => (at % 7 ? 0 : 0.1)) } }"""
CALIBRATION = "{ header, width: 640, height: 480, k: [500, 0, 320, 0, 500, 240, 0, 0, 1] }"
POLYGON = "{ header, polygon: { points: [pose.position, pose.position] } }"
MESSAGES = {
    "/map": ("nav_msgs/msg/OccupancyGrid", GRID),
    "/local_costmap/costmap": ("nav_msgs/msg/OccupancyGrid", GRID),
    "/scan": ("sensor_msgs/msg/LaserScan", SCAN),
    "/points": ("sensor_msgs/msg/PointCloud2", CLOUD),
    "/plan": ("nav_msgs/msg/Path", "{ header, poses: [{ pose }, { pose }] }"),
    "/footprint": ("geometry_msgs/msg/PolygonStamped", POLYGON),
    "/particles": ("geometry_msgs/msg/PoseArray", "{ header, poses: [pose, pose] }"),
    "/goal": ("geometry_msgs/msg/PoseStamped", "{ header, pose }"),
    "/amcl_pose": ("geometry_msgs/msg/PoseWithCovarianceStamped", ESTIMATE),
    "/odom": ("nav_msgs/msg/Odometry", ESTIMATE),
    "/sonar": ("sensor_msgs/msg/Range", "{ header, range: 1, max_range: 4, field_of_view: 0.5 }"),
    "/camera_info": ("sensor_msgs/msg/CameraInfo", CALIBRATION),
}


async def stage(page, script: str, argument=None):
    """Run a script with a separate scene."""
    return await page.evaluate(f"async (given) => {{ {STAGE} {script} }}", argument)


@pytest.mark.parametrize("topic", MESSAGES)
async def test_each_type_is_shown_in_its_frame_and_nothing_of_it_is_left(served, open_page, topic):
    kind, message = MESSAGES[topic]
    async with open_page(page_address(served) + "#cards=none") as page:
        found = await stage(page, f"""
            knows(given[0], given[1]);
            const scene = begin(`on,${{given[0]}},,,`);
            scene.draw();
            const before = {{ ...scene.renderer.info.memory }};
            say(given[0], {message});
            const [display] = scene.layers.displays;
            const size = () => scene.renderer.info.memory.geometries - before.geometries;
            while (size() < 1 && !display.problem) {{ await frame(); scene.tick(); scene.draw(); }}
            const place = display.object.parent.position.toArray();
            const {{ problem }} = display;
            const box = scene.element.querySelector(".layers input");
            const boxes = [...scene.element.querySelectorAll(".layers input[type=checkbox]")];
            boxes.find(({{ checked }}) => checked).click();
            scene.draw();
            const left = scene.renderer.info.memory.geometries - before.geometries;
            const {{ textures }} = scene.renderer.info.memory;
            scene.close();
            return {{ place, problem, left, textures, heard: [...heard.keys()] }};
        """, [topic, kind])  # fmt: skip
    assert found == {"place": [1, 2, 0], "problem": "", "left": 0, "textures": 0, "heard": []}


async def test_a_part_of_a_map_is_painted_when_it_changes(served, open_page):
    async with open_page(page_address(served) + "#cards=none") as page:
        found = await stage(page, f"""
            knows("/map", "nav_msgs/msg/OccupancyGrid");
            knows("/map_updates", "map_msgs/msg/OccupancyGridUpdate");
            const scene = begin("on,/map,,,");
            say("/map", {GRID});
            const [display] = scene.layers.displays;
            const pictures = [];
            display.object.traverse(({{ material }}) => pictures.push(material));
            const cell = () => {{
                const image = pictures.find(Boolean).map?.image;
                if (!image) return "";
                const pen = new OffscreenCanvas(2, 2).getContext("2d");
                pen.drawImage(image, 0, 0);
                return String(pen.getImageData(0, 1, 1, 1).data);
            }};
            while (!cell()) await frame();
            const before = cell();
            say("/map_updates", {{ header, x: 0, y: 0, width: 1, height: 1, data: [100] }});
            while (cell() === before) await frame();
            scene.close();
            return {{ problem: display.problem, heard: [...heard.keys()] }};
        """)  # fmt: skip
    assert found == {"problem": "", "heard": []}


async def test_a_cloud_is_asked_for_thinned_and_its_points_get_their_places(served, open_page):
    async with open_page(page_address(served) + "#cards=none") as page:
        found = await stage(page, """
            knows("/points", "sensor_msgs/msg/PointCloud2");
            const scene = begin("on,/points,#102030,0.05,flat");
            const [display] = scene.layers.displays;
            const numbers = new Int16Array([1, 2, 3, -1, -2, -3]);
            say("/points", { header, format: "int16", points: 2, of: 9,
                fields: ["x", "y", "z"].map((name, at) => ({ name, scale: 0.5, offset: at })),
                available: ["x", "y", "z", "ring"], data: new Uint8Array(numbers.buffer) });
            while (!display.count) await frame();
            scene.tick();
            const [points] = display.object.children;
            const { position, color } = points.geometry.attributes;
            const options = [...scene.element.querySelectorAll(".look option")];
            const modes = options.map(({ value }) => value);
            const [asked] = sent.filter(({ topic }) => topic === "/points");
            scene.close();
            return { places: [...position.array.slice(0, 6)], colours: [...color.array.slice(0, 3)],
                scale: points.scale.toArray(), offset: points.position.toArray(), modes,
                cloud: asked.cloud };
        """)  # fmt: skip
    assert found == {
        "places": [1, 2, 3, -1, -2, -3],
        "colours": [16, 32, 48],
        "scale": [0.5, 0.5, 0.5],
        "offset": [0, 1, 2],
        "modes": ["height", "flat", "ring"],
        "cloud": {"max_points": 50_000, "fields": []},
    }


async def test_a_cloud_is_thinned_as_its_layer_says_and_refused_numbers_are_shown(demo, open_page):
    async with open_page(page_address(demo) + SCENE, script=NOTE_SENT) as page:
        asked = """() => sent.map(JSON.parse).filter(({ cloud }) => cloud).at(-1)?.cloud"""
        await until(page, f"() => ({asked})()?.max_points === 50_000")
        points, cubes = (
            page.locator(f".layers > li:has-text('/points') [type=number] >> nth={at}")
            for at in (0, 1)
        )
        await points.focus()
        await page.keyboard.press("ArrowDown")
        await page.keyboard.press("Enter")
        await until(page, f"() => ({asked})().max_points === 45_000")
        await cubes.fill("0.2")
        await page.keyboard.press("Enter")
        await until(page, f"() => ({asked})().voxel_m === 0.2")
        await until(page, "() => location.hash.includes('height%2C45000%2C0.2')")
        for field, wrong, right in ((points, "900000", "900"), (cubes, "5000", "0")):
            await field.fill(wrong)
            await page.keyboard.press("Enter")
            await page.wait_for_selector(".layers .problem:text-matches('cloud.(max|voxel)')")
            await field.fill(right)
            await page.keyboard.press("Enter")
            await until(page, "() => !document.querySelector('.layers .problem:not([hidden])')")
        assert await page.evaluate(asked) == {"max_points": 900, "fields": []}


MARKER = """
    const marker = (id, more) => ({ header, ns: "a", id, type: 1, action: 0, pose, text: "here",
        scale: { x: 1, y: 1, z: 1 }, color: { r: 1, g: 0, b: 0, a: 0.5 }, colors: [],
        points: [0, 1, 2].map((x) => ({ x, y: 0, z: 0 })), lifetime: { sec: 0, nanosec: 0 },
        mesh_resource: "", mesh_use_embedded_materials: false, ...more });
    knows("/markers", "visualization_msgs/msg/MarkerArray");
    const scene = begin();
    const [display] = scene.layers.displays;
    const tell = (...markers) => say("/markers", { markers });
"""


async def test_markers_of_all_types_are_drawn(served, open_page):
    async with open_page(page_address(served) + "#cards=none") as page:
        found = await stage(page, f"""{MARKER}
            const problems = [];
            for (const type of [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 11, 12]) {{
                tell(marker(type, {{ type }}));
                problems.push(display.problem);
            }}
            tell(marker(20, {{ type: 0, points: [] }}), marker(21, {{ type: 8,
                colors: [0, 1, 2].map(() => ({{ r: 1, g: 1, b: 1, a: 1 }})) }}));
            scene.draw();
            const {{ count }} = display;
            tell(marker(22, {{ type: 10, mesh_resource: "package://x/y.dae" }}));
            while (!display.problem) await frame();
            const missing = display.problem;
            tell(marker(23, {{ type: 99 }}));
            const unknown = display.problem;
            tell({{ ...marker(0), action: 3, ns: "" }});
            scene.draw();
            const left = display.count;
            scene.close();
            return {{ problems: problems.join(""), count, missing, unknown, left }};
        """)  # fmt: skip
    assert found == {
        "problems": "",
        "count": 14,
        "missing": "there is no package://x/y.dae",
        "unknown": "It cannot be shown: its type is 99.",
        "left": 0,
    }


async def test_markers_end_by_their_lifetime_by_name_and_are_hidden_by_namespace(served, open_page):
    async with open_page(page_address(served) + "#cards=none") as page:
        found = await stage(page, f"""{MARKER}
            const lifetime = {{ sec: 0, nanosec: 5e7 }};
            tell(marker(0), marker(1, {{ ns: "b" }}), marker(2, {{ lifetime }}));
            const counts = [display.count];
            tell(marker(0)); // in the place of the one before
            counts.push(display.count);
            while (display.count === 3) {{ await frame(); scene.tick(); }}
            counts.push(display.count);
            const lines = [...scene.element.querySelectorAll(".layers li li")];
            const names = lines.map((each) => each.innerText);
            lines[1].querySelector("input").click();
            const isHidden = display.isHidden("b");
            tell({{ ...marker(0), action: 2 }});
            scene.tick();
            counts.push(display.count);
            scene.close();
            return {{ counts, names, isHidden }};
        """)  # fmt: skip
    assert found == {"counts": [3, 3, 2, 1], "names": ["a", "b"], "isHidden": True}


@pytest.mark.parametrize("type_number", [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12])
async def test_a_marker_of_the_same_shape_is_moved_and_painted_and_not_made_again(
    served, open_page, type_number
):
    async with open_page(page_address(served) + "#cards=none") as page:
        found = await stage(page, f"""{MARKER}
            gateway.ask = async () => ({{ size: given.mesh.length, data: btoa(given.mesh) }});
            const parts = () => {{
                const found = [];
                scene.world.traverse((each) => each.material?.color && found.push(each));
                return found.filter(({{ parent }}) => {{
                    for (let at = parent; at; at = at.parent) if (at === root) return true;
                    return false;
                }});
            }};
            const root = scene.frames.hold("base_link");
            const its = {{ type: given.type, mesh_resource: "package://x/y.stl" }};
            tell(marker(1, its));
            while (!parts().length) await frame();
            const before = parts();
            const points = [5, 6, 7].map((x) => ({{ x, y: 1, z: 0 }}));
            const color = {{ r: 0, g: 0, b: 1, a: 1 }};
            const position = {{ x: 7, y: 0, z: 0 }};
            const scale = {{ x: 2, y: 2, z: 2 }};
            const moved = {{ ...its, points, color, scale, pose: {{ ...pose, position }} }};
            tell(marker(1, moved));
            const after = parts();
            scene.world.updateMatrixWorld(true);
            const [object] = after;
            const at = object.geometry.attributes.position;
            const [x] = object.isInstancedMesh ? object.instanceMatrix.array.slice(12) :
                [4, 5, 8, 11].includes(given.type) ? at.array : [7];
            const group = root.children.at(-1);
            const colours = after.map(({{ material }}) => material.color.getHex());
            tell(marker(1, {{ ...moved, type: 1 + Number(given.type === 1) }}));
            const other = parts();
            const isKept = before.every((each, index) => each === after[index]);
            const wasMade = other.every((each) => !before.includes(each));
            tell({{ ...marker(1), action: 2 }});
            const left = parts().length;
            scene.close();
            return {{ isKept, wasMade, left, x: [x, group.position.x], colours }};
        """, {"type": type_number, "mesh": TRIANGLE.decode()})  # fmt: skip
    blue = 0x0000FF
    assert {*found.pop("colours")} == {blue}
    x = 5 if type_number in {4, 5, 6, 7, 8, 11} else 7
    assert found == {"isKept": True, "wasMade": True, "left": 0, "x": [x, 7]}


async def test_a_strip_of_triangles_may_have_a_colour_for_each(served, open_page):
    async with open_page(page_address(served) + "#cards=none") as page:
        found = await stage(page, f"""{MARKER}
            tell(marker(1, {{ type: 11, colors: [{{ r: 1, g: 0.5, b: 0, a: 1 }}] }}));
            let colours;
            scene.world.traverse(({{ geometry }}) => {{
                const {{ normal, color }} = geometry?.attributes ?? {{}};
                if (normal && color) colours = color.array;
            }});
            const drawn = [...colours];
            scene.close();
            return drawn;
        """)  # fmt: skip
    assert found == [1, 0.5, 0] * 3


async def test_a_scene_says_which_markers_it_leaves_out(served, open_page):
    async with open_page(page_address(served) + "#cards=none") as page:
        found = await stage(page, f"""{MARKER}
            const words = [];
            const points = Array.from({{ length: 1002 }}, (_, x) => ({{ x, y: 0, z: 0 }}));
            tell(marker(1, {{ type: 12, points }}));
            words.push(display.problem);
            tell(marker(1, {{ type: 99 }}), marker(2)); // the second one can be shown
            words.push(display.problem, display.count);
            tell(...Array.from({{ length: 10_003 }}, (_, id) => marker(id)));
            words.push(display.problem, display.count);
            tell({{ ...marker(0), action: 3, ns: "" }});
            words.push(display.problem);
            scene.close();
            return words;
        """)  # fmt: skip
    assert found == [
        'Marker 1 of "a" shows 1000 of its 1002 points.',
        "It cannot be shown: its type is 99.",
        1,
        "3 older markers are left out: the scene shows 10000.",
        10_000,
        "",
    ]


async def test_markers_from_before_a_rest_end_with_the_first_message_after_it(served, open_page):
    async with open_page(page_address(served) + "#cards=none") as page:
        found = await stage(page, f"""{MARKER}
            tell(marker(0), marker(1));
            scene.wake();
            scene.tick();
            const counts = [display.count]; // what came once is still there
            tell(marker(0));
            counts.push(display.count); // the other one was deleted meanwhile
            tell(marker(1));
            counts.push(display.count);
            scene.close();
            return counts;
        """)  # fmt: skip
    assert found == [2, 1, 2]


async def test_markers_of_the_connection_before_go_unless_they_come_again(served, open_page):
    async with open_page(page_address(served) + "#cards=none") as page:
        found = await stage(page, f"""
            const hear = new Map();
            gateway.on = (name, take) => {{ hear.set(name, take); return () => {{}}; }};
            {MARKER}
            tell(marker(0), marker(1), marker(2));
            hear.get("state")({{ state: "closed" }});
            hear.get("state")({{ state: "open" }});
            const now = performance.now;
            let waitedMs = 0;
            performance.now = () => now.call(performance) + waitedMs;
            tell(marker(0)); // two kept messages come again
            tell(marker(1));
            scene.tick();
            const counts = [display.count];
            waitedMs = 3000;
            scene.tick();
            counts.push(display.count);
            tell(marker(2));
            tell(marker(3)); // the new connection is as any
            counts.push(display.count);
            scene.close();
            performance.now = now;
            return counts;
        """)  # fmt: skip
    assert found == [3, 2, 4]


async def test_a_robot_has_its_links_where_its_joints_say(served, open_page):
    async with open_page(page_address(served) + "#cards=none") as page:
        found = await stage(page, """
            knows("/robot_description", "std_msgs/msg/String");
            knows("/joint_states", "sensor_msgs/msg/JointState");
            const scene = begin();
            const [display] = scene.layers.displays;
            say("/robot_description", { data: given });
            scene.tick();
            say("/joint_states", { name: ["shoulder", "else"], position: [Math.PI / 2, 1] });
            while (!display.problem) { await frame(); scene.tick(); }
            scene.draw();
            scene.world.updateMatrixWorld(true);
            const places = [];
            display.object.traverse((each) => {
                if (!each.isMesh) return;
                const place = each.getWorldPosition(each.position.clone()).toArray();
                places.push([each.geometry.type, ...place.map((n) => Math.round(n * 1e3) / 1e3)]);
            });
            const { problem, frame: base } = display;
            say("/robot_description", { data: "<no/>" });
            const wrong = display.problem;
            scene.close();
            return { places: places.sort(), problem, base, wrong };
        """, URDF)  # fmt: skip
    # the shoulder is turned by 180 degrees in all, and the slide is pi + 1 m along
    assert found == {
        "places": [
            ["BoxGeometry", 1, 2, 0],
            ["CylinderGeometry", 1, 2, 2],
            ["SphereGeometry", -3.142, 2, 1],
        ],
        "problem": "there is no package://x/y.stl",
        "base": "base_link",
        "wrong": "It cannot be shown: the description is not a URDF.",
    }


async def test_frames_follow_their_transforms_in_any_fixed_frame(served, open_page):
    async with open_page(page_address(served) + "#cards=none") as page:
        found = await stage(page, """
            const scene = begin();
            const { frames } = scene;
            const rotation = { x: 0, y: 0, z: Math.SQRT1_2, w: Math.SQRT1_2 };
            const transform = { translation: { x: 1, y: 0, z: 0 }, rotation };
            const at = (frame_id) => ({ frame_id });
            const moved = (topic, parent, child_frame_id) =>
                say(topic, { transforms: [{ header: at(parent), child_frame_id, transform }] });
            moved("/tf_static", "/base_link", "laser");
            const names = ["map", "laser", "/base_link", "nowhere"];
            const groups = names.map((each) => frames.hold(each));
            const rounded = (place) => place.toArray().map((n) => Math.round(n * 1e6) / 1e6 + 0);
            const shown = () => {
                frames.step();
                return groups.map(({ visible, position }) => (visible ? rounded(position) : null));
            };
            const first = [frames.fixed, shown()];
            frames.fix("laser");
            const second = shown();
            moved("/tf", "laser", "map"); // a loop
            shown();
            scene.close();
            return { first, second };
        """)  # fmt: skip
    assert found["first"] == ["map", [[0, 0, 0], [2, 2, 0], [1, 2, 0], None]]
    assert found["second"] == [[-2, 2, 0], [0, 0, 0], [0, 1, 0], None]


@pytest.mark.parametrize(("card", "expected"), [("card", [-2, -1]), ("null", [1, -0.5])])
async def test_the_view_follows_a_robot_and_that_of_a_driver_turns_with_it(
    served, open_page, card, expected
):
    async with open_page(page_address(served) + "#cards=none") as page:
        found = await stage(page, f"""
            const scene = put({card}, ["follow"]);
            let seen;
            scene.renderer.render = (world, {{ position }}) => {{ seen = position.clone(); }};
            const turned = {{ x: 0, y: 0, z: Math.SQRT1_2, w: Math.SQRT1_2 }};
            const drawn = (x, y, rotation = identity.rotation) => {{
                const transform = {{ translation: {{ x, y, z: 0 }}, rotation }};
                const from = {{ header: {{ frame_id: "map" }}, child_frame_id: "base_link" }};
                say("/tf", {{ transforms: [{{ ...from, transform }}] }});
                scene.draw();
            }};
            drawn(1, 2);
            drawn(1, 2, turned); // to the left
            const left = [seen.x, seen.y];
            scene.close();
            return left.map((n) => Math.round(n * 1e3) / 1e3);
        """)  # fmt: skip
    assert found == expected


async def test_meshes_of_stl_collada_and_obj_are_read(served, open_page):
    async with open_page(page_address(served) + "#cards=none") as page:
        found = await page.evaluate("""async (files) => {
            const { meshOf } = await import("/scene/assets.js");
            const gateway = { graph: {}, ask: async ({ uri, offset }) => {
                const whole = atob(files[uri] ?? "");
                return { size: whole.length, data: btoa(whole.slice(offset, offset + 50)) };
            } };
            const sizes = [];
            for (const uri of Object.keys(files)) {
                let count = 0;
                const mesh = await meshOf(gateway, uri, null);
                mesh.traverse(({ isMesh, geometry }) => {
                    if (isMesh) count += geometry.attributes.position.count;
                });
                sizes.push(count);
            }
            return sizes;
        }""", {name: base64.b64encode(text).decode() for name, text in FILES.items()})  # fmt: skip
    assert found == [3, 3, 3]


TRIANGLE = (
    b"solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
    b"endloop\nendfacet\nendsolid x\n"
)
DAE = b"""<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit meter="1" name="meter"/><up_axis>Z_UP</up_axis></asset>
<library_images><image id="i"><init_from>skin.png</init_from></image></library_images>
<library_geometries><geometry id="g"><mesh><source id="p">
<float_array id="f" count="9">0 0 0 1 0 0 0 1 0</float_array><technique_common>
<accessor source="#f" count="3" stride="3"><param name="X" type="float"/>
<param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="1"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles>
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node id="n"><instance_geometry url="#g"/></node>
</visual_scene></library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>"""
FILES = {
    "package://a/b.stl": TRIANGLE,
    "package://a/b.DAE": DAE,
    "package://a/b.obj": b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n",
}


async def test_a_scene_shows_again_all_that_the_address_keeps_of_it(served, open_page):
    async with open_page(page_address(served) + "#cards=none") as page:
        found = await stage(page, """
            knows("/scan", "sensor_msgs/msg/LaserScan");
            knows("/odom", "nav_msgs/msg/Odometry");
            const layers = ["off,/scan,#112233,0.2,", "on,/gone,#e05adf,0.1,"];
            const kept = ["frame,odom", "top", "follow", ...layers];
            const scene = begin(...kept);
            const again = scene.kept;
            scene.close();
            const other = begin();
            const nothing = other.kept;
            other.close();
            return { kept, again, nothing };
        """)  # fmt: skip
    assert found["again"] == found["kept"]
    assert found["nothing"] == []


UNENDED = "Neither this page nor STOP can end that goal: end it in the program that drives."


async def test_go_here_uses_navigate_to_pose_and_tells_of_its_progress(served, open_page):
    async with open_page(page_address(served) + "#cards=none") as page:
        found = await stage(page, """
            const { Navigation } = await import("/scene/navigation.js");
            const words = [];
            const navigation = new Navigation(gateway, () => words.push(navigation.words));
            navigation.go({ x: 1, y: 2, yaw: Math.PI }, "map");
            const types = ["nav2_msgs/action/NavigateToPose"];
            gateway.graph.actions.set("/nav", { name: "/nav", types, nodes: ["/n"] });
            navigation.go({ x: 1, y: 2, yaw: 0 }, "map");
            const [id, take] = [...listeners].at(-1);
            take({ op: "action_feedback", values: { distance_remaining: 1.25 } });
            const wasActive = navigation.isActive;
            navigation.cancel();
            take({ op: "action_result", result: true, status: 5, values: {} });
            navigation.place({ x: 0, y: 0, yaw: 0 }, "odom");
            navigation.close();
            return { words, wasActive, isActive: navigation.isActive,
                sent: sent.map(({ op, topic, action, type = "" }) => [op, topic ?? action, type]) };
        """)  # fmt: skip
    assert found["sent"] == [
        ["publish", "/goal_pose", "geometry_msgs/msg/PoseStamped"],
        ["send_action_goal", "/nav", ""],
        ["cancel_action_goal", "/nav", ""],
        ["publish", "/initialpose", "geometry_msgs/msg/PoseWithCovarianceStamped"],
    ]
    assert found["words"] == [
        "Goal sent to /goal_pose: x 1.00, y 2.00 m, heading 180°. " + UNENDED,
        "Going to x 1.00, y 2.00 m, heading 0°.",
        "Going to x 1.00, y 2.00 m, heading 0°, 1.3 m left.",
        "The goal was canceled.",
        "Sent to /initialpose: the robot is at x 0.00, y 0.00 m, heading 0°.",
    ]
    assert (found["wasActive"], found["isActive"]) == (True, False)


async def magenta(page) -> int:
    """Count the pixels of a scan."""
    picture = cv2.imdecode(
        np.frombuffer(await page.locator(CANVAS).screenshot(), np.uint8), cv2.IMREAD_COLOR
    )
    return int((np.abs(picture.astype(int) - MAGENTA).max(axis=2) < 60).sum())


async def until_magenta(page, expected: bool) -> None:
    async with asyncio.timeout(TIMEOUT_S):
        while (await magenta(page) > 20) != expected:
            await page.wait_for_timeout(100)


async def test_the_scene_shows_the_robot_and_layers_are_switched_by_the_keyboard(demo, open_page):
    async with open_page(page_address(demo) + "#cards=none") as page:
        await page.focus("#scene")
        await page.keyboard.press("Enter")
        await until_magenta(page, True)
        await page.get_by_role("checkbox", name="Scan").focus()
        await page.keyboard.press("Space")
        await until_magenta(page, False)
        assert re.search(r"off%2C%2Fscan", page.url)
        await page.reload()
        assert not await page.get_by_role("checkbox", name="Scan").is_checked()
        await page.click("article.scene-card header .corner > button")
        await until(page, "() => !document.querySelector('.scene')")


async def test_the_robot_goes_where_a_finger_points_on_a_phone(demo, open_page):
    async with (
        client(demo.url) as speaker,
        open_page(page_address(demo) + f"{SCENE}+top", viewport=PHONE, has_touch=True) as page,
    ):
        await until_magenta(page, True)
        await page.get_by_role("button", name="Go here").tap()
        box = await page.locator(CANVAS).bounding_box()
        # half a metre aside of the robot, which is in the middle
        await page.touchscreen.tap(
            box["x"] + box["width"] / 2 + 20, box["y"] + box["height"] / 2 - 10
        )
        said = "() => document.querySelector('.goal-line output').textContent"
        await until(page, f"{said}.startsWith('Going to x ')")
        await page.get_by_role("button", name="Cancel").tap()
        await until(page, f"{said} === 'The goal was canceled.'")
        await speaker.send(op="call_service", id="reset", service="/reset")


SAID = "() => document.querySelector('.goal-line output').textContent"
GOALS = """() => sent.map(JSON.parse).map(({ op }) => op)
    .filter((op) => /_action_goal$/.test(op))"""
# each place for a pose, with its address and its canvas
PLACES = {"scene": (SCENE, CANVAS), "map": ("#card=map+0+/map", "article canvas")}


@asynccontextmanager
async def going(demo, open_page, place, **options):
    """Open a place, press Go here, and return the page and its canvas."""
    address, canvas = PLACES[place]
    async with (
        client(demo.url) as speaker,
        open_page(page_address(demo) + address, script=NOTE_SENT, **options) as page,
    ):
        await until_it_can_be_driven(speaker)
        await until_painted(page, canvas)
        await page.get_by_role("button", name="Go here").focus()
        await page.keyboard.press("Enter")
        yield page, page.locator(canvas)
        await speaker.send(op="call_service", id="reset", service="/reset")


@pytest.mark.parametrize("place", PLACES)
async def test_stop_cancels_the_goal_and_a_held_enter_sends_none(demo, open_page, place):
    async with going(demo, open_page, place) as (page, _):
        for _ in range(3):
            await page.keyboard.down("Enter")  # all but the first are repeats
        assert await page.evaluate(GOALS) == []
        await page.keyboard.up("Enter")
        for key in ("ArrowUp",) * 9 + ("Enter",):
            await page.keyboard.press(key)
        await until(page, f"{SAID}.startsWith('Going to x ')")
        await page.evaluate("() => document.getElementById('stop').click()")
        await until(page, f"() => /^(The goal was canceled|The robot gave up)/.test(({SAID})())")
        assert await page.evaluate(GOALS) == ["send_action_goal", "cancel_action_goal"]


@pytest.mark.parametrize(
    "by",
    [
        "() => document.getElementById('stop').click()",
        "() => dispatchEvent(new Event('blur'))",
        """() => {
            Object.defineProperty(document, "hidden", { value: true });
            document.dispatchEvent(new Event("visibilitychange"));
        }""",
    ],
    ids=["STOP", "blur", "hidden"],
)
@pytest.mark.parametrize("place", PLACES)
async def test_a_pose_that_is_being_given_is_dropped(demo, open_page, place, by):
    async with going(demo, open_page, place) as (page, canvas):
        box = await canvas.bounding_box()
        await page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
        await page.mouse.down()
        await page.evaluate(by)
        await page.mouse.up()
        assert await page.evaluate(GOALS) == []


async def test_a_pose_is_given_by_keys_and_a_distance_is_measured(demo, open_page):
    async with open_page(page_address(demo) + SCENE) as page:
        await until_magenta(page, True)
        said = "() => document.querySelector('.goal-line output').textContent"
        await page.get_by_role("button", name="I am here").focus()
        for key in ("Enter", "Enter", "ArrowLeft", "ArrowUp", "Enter"):
            await page.keyboard.press(key)
        await until(page, f"{said}.startsWith('Sent to /initialpose: the robot is at x ')")
        await page.get_by_role("button", name="Measure").focus()
        await page.keyboard.press("Enter")
        await page.keyboard.press("Enter")
        await until(page, f"/^x .* m$/.test(({said})())")
        for key in ("ArrowLeft", "Shift+ArrowUp", "+", "Enter"):
            await page.keyboard.press(key)
        await until(page, f"/^[0-9.]+ m from x /.test(({said})())")
        await page.keyboard.press("Escape")
        await until(page, "() => !document.querySelector('.scene-tools [aria-pressed=true]')")


async def test_a_cloud_of_the_list_opens_in_the_scene(demo, open_page):
    async with open_page(page_address(demo) + "#card=world+0+/points") as page:
        unfold = page.locator(".scene-bar [aria-expanded]")
        await until(page, "() => document.querySelector('.layers')?.hidden")  # it is narrow
        assert await unfold.get_attribute("aria-expanded") == "false"
        await unfold.click()
        modes = "() => document.querySelector('.look select')?.options.length"
        await until(page, f"{modes} === 4")  # the fields of the cloud are known
        await page.get_by_label("colors of /points").select_option("rgb")
        await until(page, "() => location.hash.includes('on%2C%2Fpoints%2C%234cc9b8%2C0.03%2Crgb')")
        await page.get_by_role("button", name="close /points").click()
        await until(page, "() => !document.querySelector('.scene')")


async def test_a_new_connection_brings_kept_markers_and_ends_others(demo, open_page):
    async with (
        client(demo.url) as speaker,
        open_page("about:blank") as page,
        severable(page) as line,
    ):
        for topic, is_kept in (("/kept", True), ("/passing", False)):
            kind = {"topic": topic, "type": "visualization_msgs/msg/Marker"}
            await speaker.send(op="advertise", **kind, latch=is_kept)
        await page.goto(page_address(demo) + SCENE)
        name = "document.querySelector('.layers [data-name={}]')"
        seen = [name.format(each) for each in ("kept", "passing")]
        while not await page.evaluate(f"() => {' && '.join(seen)}"):
            for each in ("kept", "passing"):
                msg = {"header": {"frame_id": "base_link"}, "ns": each, "type": 1}
                await speaker.send(op="publish", topic=f"/{each}", msg=msg)
            await page.wait_for_timeout(100)
        await line.cut()
        await page.wait_for_selector(".state[data-state=closed]")
        line.mend()
        await until(page, f"() => !{seen[1]}")
        assert await page.evaluate(f"() => Boolean({seen[0]})")


async def test_stop_stays_in_view_when_a_scene_fills_the_screen(demo, open_page):
    async with open_page(page_address(demo) + SCENE) as page:
        await page.get_by_role("button", name="Full screen").click()
        await until(page, "() => document.querySelector('.whole .scene')")
        stop = await page.locator(".stop").bounding_box()
        scene = await page.locator(".scene").bounding_box()
        assert scene["y"] >= stop["y"] + stop["height"]
        assert scene["width"] == page.viewport_size["width"]
        await page.get_by_role("button", name="Full screen").click()
        await until(page, "() => !document.querySelector('.whole')")


async def test_a_pose_keeps_the_frame_in_which_it_was_begun(evaluate):
    found = await evaluate("""async () => {
        const { PoseDrag } = await import("/scene/pose_drag.js");
        const given = [];
        let frame = "odom";
        const drag = new PoseDrag(() => ({ yaw: 0, frame }), () => {}, (pose) => given.push(pose));
        drag.down({ x: 1, y: 2 });
        frame = "map";
        drag.move({ x: 7, y: 9 });
        drag.up();
        return given;
    }""")
    assert found == [{"x": 1, "y": 2, "yaw": 0, "frame": "odom"}]


async def test_a_goal_goes_to_the_robot_that_is_meant_and_can_always_be_canceled(served, open_page):
    async with open_page(page_address(served) + "#cards=none") as page:
        found = await stage(page, """
            const { Navigation } = await import("/scene/navigation.js");
            const types = ["nav2_msgs/action/NavigateToPose"];
            const { actions } = gateway.graph;
            const serves = (name, ...nodes) => actions.set(name, { name, types, nodes });
            serves("/gone");
            serves("/r1/nav", "/n");
            serves("/r2/nav", "/n");
            const place = { x: 1, y: 2, yaw: 0 };
            const navigation = new Navigation(gateway, () => {}, () => ["/map", "r2"]);
            navigation.go(place, "");
            const tools = { tool: "go", hints: { go: "Press." } };
            const words = [navigation.words, navigation.wordsOf(tools)];
            navigation.go(place, "map");
            navigation.go(place, "map");
            const waiting = listeners.size;
            const [id, take] = [...listeners].at(-1);
            const refused = { op: "status", level: "error", msg: "no", id };
            take({ ...refused, request: "cancel_action_goal" });
            const active = [navigation.isActive];
            take({ ...refused, request: "send_action_goal" });
            active.push(navigation.isActive);
            return { words, waiting, active, sent: sent.map(({ op, action }) => [op, action]) };
        """)  # fmt: skip
    assert found["words"] == [
        "Not sent, because the place has no frame yet: wait for the map, and try again.",
        "Press. The goal goes to /r2/nav.",
    ]
    assert found["sent"] == [
        ["send_action_goal", "/r2/nav"],
        ["cancel_action_goal", "/r2/nav"],
        ["send_action_goal", "/r2/nav"],
    ]
    assert (found["waiting"], found["active"]) == (1, [True, False])


async def test_joints_that_mimic_each_other_move_once(evaluate):
    found = await evaluate("""async () => {
        const { RobotModel } = await import("/scene/robot_model.js");
        const joint = (name, child, other) => `<joint name="${name}" type="prismatic">
            <parent link="a"/><child link="${child}"/><axis xyz="1 0 0"/>
            <mimic joint="${other}" multiplier="2"/></joint>`;
        const links = ["a", "b", "c"].map((name) => `<link name="${name}"/>`).join("");
        const joints = joint("l", "b", "r") + joint("r", "c", "l");
        const text = `<robot name="r">${links}${joints}</robot>`;
        const model = new RobotModel({}, text, () => {});
        model.move({ name: ["l"], position: [1] });
        const [{ children }] = model.object.children;
        return children.map(({ position }) => position.x);
    }""")
    assert found == [1, 2]


async def test_a_cloud_is_drawn_again_after_its_worker_has_failed(served, open_page):
    async with open_page(page_address(served) + "#cards=none") as page:
        found = await stage(page, f"""
            knows("/points", "sensor_msgs/msg/PointCloud2");
            const scene = begin("on,/points");
            const [display] = scene.layers.displays;
            say("/points", {{ ...{CLOUD}, points: 99 }});
            while (!display.problem) await frame();
            const {{ problem }} = display;
            say("/points", {CLOUD});
            while (display.count !== 2 || display.problem) await frame();
            scene.close();
            return problem;
        """)  # fmt: skip
    assert found.startswith("It cannot be shown: ")


LOSE = """name => {
    const canvas = document.querySelector(".scene canvas");
    window.graphics ??= canvas.getContext("webgl2").getExtension("WEBGL_lose_context");
    graphics[name]();
}"""


@pytest.mark.parametrize("place", ["scene+0+/", "world+0+/points"])
async def test_a_scene_whose_graphics_memory_was_taken_says_so_and_comes_back(
    demo, open_page, place
):
    missing = "document.querySelector('.scene .missing')"
    async with open_page(f"{page_address(demo)}#card={place}") as page:
        await until_magenta(page, True)
        await page.evaluate(LOSE, "loseContext")
        await until(page, f"() => {missing}.textContent.includes('has taken the graphics memory')")
        assert await page.locator(".scene .missing").is_visible()
        await page.evaluate(LOSE, "restoreContext")
        await until(page, f"() => !{missing}.textContent.includes('graphics memory')")
        await until_magenta(page, True)
        # the words of the library for the developers of a page
        page.wrong[:] = [each for each in page.wrong if "THREE.WebGLRenderer: Context" not in each]


async def test_a_scene_keeps_a_limited_number_of_frames_and_says_so(served, open_page):
    async with open_page(page_address(served) + "#cards=none") as page:
        found = await stage(page, """
            const scene = begin("on,/tf,,0.2,");
            const { frames } = scene;
            const at = (frame_id) => ({ frame_id });
            const link = (child) => ({ header: at("map"), child_frame_id: child,
                transform: identity });
            const many = (prefix, count) => ({ transforms:
                Array.from({ length: count }, (_, n) => link(prefix + n)) });
            say("/tf_static", { transforms: [link("fixed")] });
            say("/tf", many("a", 1997)); // with base_link, and the fixed one
            scene.tick();
            const words = [frames.leftOut, frames.names.has("a0")];
            say("/tf", { transforms: [link("a0")] });
            say("/tf", { transforms: [link("base_link")] });
            say("/tf", many("b", 2));
            scene.tick();
            const names = ["fixed", "a0", "base_link", "a1", "a2", "b0", "b1"];
            const left = names.filter((each) => frames.names.has(each));
            const missing = scene.element.querySelector(".missing").textContent;
            const [axes] = scene.layers.displays;
            const few = axes.problem;
            say("/tf", many("c", 1999));
            say("/tf_static", many("d", 5000)); // these stay, so there is no room for the last ones
            scene.tick();
            const count = frames.names.size;
            scene.close();
            return { words, left, missing, few, count };
        """)  # fmt: skip
    assert found["words"] == ["", True]
    assert found["left"] == ["fixed", "a0", "base_link", "a2", "b0", "b1"]
    assert found["missing"].startswith("There are too many frames: the scene keeps 2000")
    assert found["few"] == "200 of 2001 frames have axes."
    assert found["count"] == 2001  # with the root


async def test_files_of_robots_are_kept_up_to_a_limit(evaluate):
    found = await evaluate("""async () => {
        const { fetchAsset } = await import("/scene/assets.js");
        const whole = btoa("x".repeat(48 * 1024 * 1024));
        const asked = [];
        const ask = async ({ uri }) => {
            asked.push(uri);
            if (uri === "huge") return { size: 65 * 1024 * 1024, data: btoa("x") };
            return { size: 48 * 1024 * 1024, data: whole };
        };
        const gateway = { graph: {}, ask };
        for (const uri of ["a", "b", "c", "d", "e", "a", "f"]) await fetchAsset(gateway, uri);
        await fetchAsset({ ...gateway }, "a"); // it was used, and cards share what is kept
        const before = asked.join("");
        await fetchAsset(gateway, "b"); // the first that was left out
        const problem = await fetchAsset(gateway, "huge").catch(({ message }) => message);
        return { before, after: asked.join(""), problem };
    }""")
    assert found == {
        "before": "abcdef",
        "after": "abcdefbhuge",
        "problem": "huge has 68157440 bytes: the page reads 67108864",
    }


async def test_all_missing_meshes_of_a_robot_are_counted(served, open_page):
    meshes = "".join(
        f"""<link name="l{n}"><visual><geometry><mesh filename="package://x/{n}.stl"/></geometry>
        </visual></link>"""
        for n in range(3)
    )
    async with open_page(page_address(served) + "#cards=none") as page:
        problem = await stage(page, """
            knows("/robot_description", "std_msgs/msg/String");
            const scene = begin();
            const [display] = scene.layers.displays;
            say("/robot_description", { data: `<robot name="r">${given}</robot>` });
            while (!display.problem.includes("2 more")) { await frame(); scene.tick(); }
            const { problem } = display;
            scene.close();
            return problem;
        """, meshes)  # fmt: skip
    assert problem == "there is no package://x/0.stl, and 2 more meshes are missing"
