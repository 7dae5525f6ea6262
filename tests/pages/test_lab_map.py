# SPDX-License-Identifier: Apache-2.0
"""The robot's map on the floor of the lab, and which places a robot can be sent to."""

import pytest
import pytest_asyncio

from tests.client import client
from tests.gateway_process import gateway_process
from tests.pages.conftest import page_address
from tests.pages.lab import KEEP, SMALL, opened, send
from tests.pages.test_lab import click_on

pytestmark = pytest.mark.asyncio(loop_scope="package")

# of the laser's hits the share that lies where the picture of the map has a wall
ON_WALLS = """() => {
    const points = lab.twin.world.getObjectByProperty("type", "Points");
    const sheet = lab.map.world.getObjectByProperty("type", "Mesh");
    for (const each of [points, sheet]) each.updateWorldMatrix(true, false);
    const { image } = sheet.material.map;
    const pen = new OffscreenCanvas(image.width, image.height).getContext("2d");
    pen.drawImage(image, 0, 0);
    const { data } = pen.getImageData(0, 0, image.width, image.height);
    const colour = getComputedStyle(document.documentElement).getPropertyValue("--map-occupied");
    const red = Number.parseInt(colour.trim().slice(1, 3), 16);
    let walls = 0;
    for (let at = 0; at < lab.twin.points; at += 1) {
        const place = lab.viewer.rig.position.clone();
        place.fromBufferAttribute(points.geometry.attributes.position, at);
        const { x, y } = sheet.worldToLocal(place.applyMatrix4(points.matrixWorld));
        const column = Math.floor((x + 0.5) * image.width);
        const row = Math.floor((0.5 - y) * image.height);
        walls += data[4 * (row * image.width + column)] === red;
    }
    return walls / lab.twin.points;
}"""
# on the page, the middle of a thing that hangs on a wall
ON = """(name) => {
    lab.renderer.domElement.scrollIntoView({ block: "end" });
    const { camera } = lab.viewer;
    const place = lab[name].mesh.position.clone().project(camera);
    const { left, top, width, height } = lab.renderer.domElement.getBoundingClientRect();
    return [left + (place.x + 1) * width / 2, top + (1 - place.y) * height / 2];
}"""
# the number of pixels of the room that have the colour of a token, as seen from above the robot
SEEN = """(name) => {
    const { viewer, renderer, map } = lab;
    map.world.traverse((each) => { if (each.material?.flatShading) each.visible = false; });
    viewer.camera.rotation.x = -1.4;
    lab.render();
    const { width, height } = renderer.domElement;
    const copy = new OffscreenCanvas(width, height).getContext("2d");
    copy.drawImage(renderer.domElement, 0, 0);
    const colour = getComputedStyle(document.documentElement).getPropertyValue(name).trim();
    const wanted = [1, 3, 5].map((at) => Number.parseInt(colour.slice(at, at + 2), 16));
    const { data } = copy.getImageData(0, 0, width, height);
    let count = 0;
    for (let at = 0; at < data.length; at += 4) {
        count += wanted.every((each, index) => Math.abs(each - data[at + index]) < 3);
    }
    return count;
}"""
MAKE = """async ({ info, data, pose }) => {
    const { FloorMap } = await import("/lab/floor_map.js");
    window.said = "";
    const tell = (words) => { window.said = words; };
    window.made = new FloorMap({ tell, untell: () => {} });
    await made.take({ info, data });
    const half = pose[2] / 2;
    const rotation = { x: 0, y: 0, z: Math.sin(half), w: Math.cos(half) };
    made.place({ translation: { x: pose[0], y: pose[1], z: 0 }, rotation });
}"""


def grid(columns, rows, data, origin=(0, 0)):
    """Return a map of cells of half a metre."""
    position = {"x": origin[0], "y": origin[1], "z": 0}
    orientation = {"x": 0, "y": 0, "z": 0, "w": 1}
    about = {"position": position, "orientation": orientation}
    return {
        "info": {"resolution": 0.5, "width": columns, "height": rows, "origin": about},
        "data": data,
    }


@pytest.fixture
def lab(demo, speaker, open_page):
    """Return a function that opens the lab and waits until its map is there."""

    async def shown(page):
        await page.wait_for_function("() => lab.map.world.visible")
        return page

    return lambda **options: opened(open_page, page_address(demo), **options), shown


async def test_the_map_lies_where_the_laser_meets_its_walls(lab):
    enter, shown = lab
    async with enter() as page:
        await shown(page)
        assert (await page.evaluate("() => lab.map.size"))["width"] > 100
        await page.wait_for_function(f"() => ({ON_WALLS})() > 0.6")
        # in one turn: the next transform places it again
        hidden = "() => { lab.map.place(null); return !lab.map.world.visible; }"
        assert await page.evaluate(hidden)


async def test_a_part_of_the_map_that_changes_stands_up_in_the_room(lab, speaker):
    enter, shown = lab
    async with enter() as page:
        await shown(page)
        topic = {"topic": "/map_updates", "type": "map_msgs/msg/OccupancyGridUpdate"}
        await speaker.send(op="advertise", **topic, latch=True)
        before = await page.evaluate("() => lab.map.blocks")
        # of a chess board no two blocks touch
        board = [100 * ((row + column) % 2) for row in range(20) for column in range(20)]
        update = {"x": 0, "y": 0, "width": 20, "height": 20, "data": board}
        await speaker.send(op="publish", **topic, msg=update)
        more = "before => lab.map.blocks > before + 100"
        await page.wait_for_function(more, arg=before)
        await page.evaluate("() => lab.map.paint()")
        await page.wait_for_function(more, arg=before)


async def test_a_line_leads_from_each_hit_of_the_laser_down_to_the_floor(lab):
    enter, shown = lab
    async with enter() as page:
        await shown(page)
        heights = """() => {
            const lines = lab.twin.world.getObjectByProperty("type", "LineSegments");
            const place = lab.viewer.rig.position.clone();
            lines.updateWorldMatrix(true, false);
            const { array } = lines.geometry.attributes.position;
            return [0, 1].map((at) => lines.localToWorld(place.fromArray(array, 3 * at)).y);
        }"""
        # by the TurtleBot's description, once the robot has said where its laser is
        await page.wait_for_function(
            f"() => {{ const [hit, foot] = ({heights})();"
            " return hit > 0.1 && Math.abs(foot) < 1e-3; }"
        )
        assert await page.evaluate("""() => {
            const lines = lab.twin.world.getObjectByProperty("type", "LineSegments");
            return lines.geometry.drawRange.count === 2 * lab.twin.points;
        }""")


@pytest.mark.parametrize("scheme", ["dark", "light"])
async def test_walls_and_free_floor_are_seen_in_the_colours_of_the_desktop(lab, scheme):
    enter, shown = lab
    async with enter(color_scheme="light" if scheme == "dark" else "dark") as page:
        await shown(page)
        await page.emulate_media(color_scheme=scheme)
        for name in ("--map-free", "--map-occupied"):
            await page.wait_for_function(f"name => ({SEEN})(name) > 100", arg=name)


async def test_a_place_where_the_map_has_something_is_refused_in_words(lab):
    enter, shown = lab
    async with enter() as page:
        await shown(page)
        await send(page, click_on(page, 0.8, 0.1))
        await click_on(page, 1.9, 1.75)()  # the partition
        await page.wait_for_function(
            "() => approach.textContent.includes('The map shows an obstacle there')"
        )
        assert not await page.evaluate("() => lab.pilot.isActive")
        await click_on(
            page, 4.6, 0
        )()  # behind the wall of the robot's room, before that of the lab
        await page.wait_for_function("() => approach.textContent.includes('The map ends')")


async def test_a_target_beyond_the_walls_is_refused_where_there_is_no_map(open_page, served):
    async with (
        open_page(f"{page_address(served)}lab", viewport=SMALL) as page,
    ):
        await page.evaluate(KEEP)
        await page.wait_for_function("() => state.textContent === 'connected'")
        await click_on(page, 4.9, 0)()
        await page.wait_for_function("() => /There is nothing to drive/.test(approach.textContent)")
        await click_on(page, 5.1, 0)()
        await page.wait_for_function("() => /beyond the walls.* 5 m/.test(approach.textContent)")
        await page.mouse.click(*await page.evaluate(ON, "television"))
        await page.wait_for_function("() => /There is no floor/.test(approach.textContent)")


@pytest_asyncio.fixture(loop_scope="package")
async def untold(nowhere):
    """A gateway and a client that publishes odometry, a map and a scan, without a transform."""
    scan = {"angle_increment": 0.1, "range_min": 0.1, "range_max": 9, "ranges": [1, 2, 3]}
    messages = {
        "nav_msgs/msg/Odometry": {"header": {"frame_id": "odom"}, "child_frame_id": "base"},
        "nav_msgs/msg/OccupancyGrid": {"header": {"frame_id": "map"}, **grid(3, 2, [0] * 6)},
        "sensor_msgs/msg/LaserScan": {"header": {"frame_id": "laser"}, **scan},
    }
    async with gateway_process("serve", *nowhere) as gateway, client(gateway.url) as robot:
        for name, message in messages.items():
            topic = f"/{name.rsplit('/', 1)[1].lower()}"
            await robot.send(op="advertise", topic=topic, type=name, latch=True)
            await robot.send(op="publish", topic=topic, msg=message)
        yield gateway, robot


async def test_a_missing_transform_is_named(open_page, untold):
    gateway, robot = untold
    async with open_page(f"{page_address(gateway)}lab", viewport=SMALL) as page:
        await page.evaluate(KEEP)
        await page.wait_for_function(
            "() => /the map is hidden.*: no transform odom → map/.test(missing.textContent)"
        )
        await page.wait_for_function(
            "() => /the scan is hidden: no transform base → laser/.test(missing.textContent)"
        )
        await page.wait_for_function("() => /no transform/.test(lab.screens.state.text)")
        assert await page.evaluate("() => [lab.map.world.visible, lab.twin.points]") == [False, 0]
        known = [
            {"header": {"frame_id": target}, "child_frame_id": source}
            for target, source in (("odom", "map"), ("base", "laser"))
        ]
        type_name = "tf2_msgs/msg/TFMessage"
        await robot.send(op="advertise", topic="/tf_static", type=type_name, latch=True)
        await robot.send(op="publish", topic="/tf_static", msg={"transforms": known})
        await page.wait_for_function("() => lab.map.world.visible && lab.twin.points === 3")
        await page.wait_for_function("() => missing.textContent === ''")


@pytest.mark.parametrize(
    ("target", "source", "words"),
    [
        ("odom", None, ""),  # nothing has come that is to be placed
        ("odom", "odom", ""),
        ("", "map", "hidden: no odometry names its frame"),
        ("odom", "", "hidden: it names no frame"),
        ("odom", "map", "hidden: no transform odom → map"),
    ],
)
async def test_a_place_that_nobody_knows_is_told_of_after_a_while(evaluate, target, source, words):
    said = await evaluate(
        """async ([target, source]) => {
            const { Placement } = await import("/lab/placement.js");
            const gateway = { followTransform: () => () => {} };
            const placement = new Placement(gateway, "hidden", 1, () => {});
            const now = performance.now;
            placement.within(target);
            if (source !== null) placement.of(source);
            const atOnce = placement.words;
            performance.now = () => now.call(performance) + 2001;
            return [atOnce, placement.words];
        }""",
        [target, source],
    )
    assert said == ["", words]


@pytest.mark.parametrize(
    ("place", "words"),
    [
        ((0.3, 0.3), ""),
        ((0.7, 0.2), "The map shows an obstacle there"),
        ((1.2, 0.2), "does not know"),
        ((-0.1, 0.2), "The map ends"),
        ((0.2, 1.1), "The map ends"),
    ],
)
@pytest.mark.parametrize("turned", [False, True])
async def test_the_map_judges_a_place_in_any_frame(evaluate, place, words, turned):
    cells = [0, 65, -1, 0, 64, 100]
    pose = (10, 20, 1.5707963) if turned else (0, 0, 0)
    if turned:  # a quarter to the left, and away
        place = (10 - place[1], 20 + place[0])
    await evaluate(MAKE, {**grid(3, 2, cells), "pose": pose})
    said = await evaluate("([x, y]) => made.refusal({ x, y })", place)
    assert said.startswith(words) if not words else words in said


async def test_a_map_without_a_place_is_hidden_and_a_bad_one_changes_nothing(evaluate):
    await evaluate(MAKE, {**grid(3, 2, [0] * 6, (-1, -0.5)), "pose": (0, 0, 0)})
    assert await evaluate("() => [made.world.visible, made.reach]") == [True, 1]
    bad = "async (map) => { await made.take(map); return said; }"
    assert "6 values" in await evaluate(bad, grid(9, 9, [0] * 6))
    nowhere = grid(3, 2, [0] * 6, (None, 0))
    assert "a place in it is not a number" in await evaluate(bad, nowhere)
    assert await evaluate("() => made.size") == {"width": 3, "height": 2}
    await evaluate("() => made.place(null)")
    assert await evaluate("() => [made.world.visible, made.reach]") == [False, 0]


async def test_walls_give_way_to_a_map_that_reaches_beyond_them(lab):
    enter, shown = lab
    async with enter() as page:
        await shown(page)
        walls = """reach => {
            lab.room.open(reach);
            return lab.room.scene.children.some(
                ({ visible, children }) => visible && children.length === 4
            );
        }"""
        assert await page.evaluate(walls, 5)
        assert not await page.evaluate(walls, 5.1)


@pytest.mark.parametrize(("columns", "rows"), [(3000, 3000), (40_000, 3)])
async def test_a_huge_map_costs_a_picture_of_bounded_size(evaluate, columns, rows):
    width, height = await evaluate(
        """async ([info, columns, rows]) => {
            const { FloorMap } = await import("/lab/floor_map.js");
            const map = new FloorMap({ tell: () => {}, untell: () => {} });
            await map.take({ info, data: new Int8Array(columns * rows) });
            const { image } = map.world.getObjectByProperty("type", "Mesh").material.map;
            return [image.width, image.height];
        }""",
        [grid(columns, rows, [])["info"], columns, rows],
    )
    assert width * height <= 1024 * 1024
    assert max(width, height) <= 4096
