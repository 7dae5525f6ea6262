# SPDX-License-Identifier: Apache-2.0
"""Walls and obstacles of the lab, raised from the map: their blocks, and what is behind them."""

import pytest

from tests.pages.conftest import page_address
from tests.pages.lab import opened
from tests.pages.test_lab_map import MAKE, grid

pytestmark = pytest.mark.asyncio(loop_scope="package")

BLOCKS = """async ([cells, columns, most]) => {
    const { blocksOf } = await import("/lab/raised.js");
    return blocksOf(Int8Array.from(cells), columns, 65, most);
}"""


@pytest.mark.parametrize(
    ("cells", "columns", "blocks"),
    [
        ([0, 64, -1], 3, []),
        ([100, 100, 0, 65, 100, 0], 3, [[0, 0, 2, 2]]),
        ([100, 0, 100, 100, 0, 100], 3, [[0, 0, 1, 2], [2, 0, 3, 2]]),
        ([100, 100, 0, 0, 100, 100], 3, [[0, 0, 2, 1], [1, 1, 3, 2]]),
        ([100, 0, 100], 1, [[0, 0, 1, 1], [0, 2, 1, 3]]),  # a gap between
    ],
)
async def test_occupied_cells_become_few_blocks(evaluate, cells, columns, blocks):
    assert await evaluate(BLOCKS, [cells, columns, 99]) == blocks


async def test_a_noisy_map_has_a_bounded_number_of_blocks(evaluate):
    cells = [100, 0] * 300
    assert len(await evaluate(BLOCKS, [cells, 600, 7])) == 7
    count = await evaluate("""async () => {
        const { Raised } = await import("/lab/raised.js");
        const raised = new Raised({});
        const cells = Int8Array.from({ length: 50_000 }, (_, at) => (at % 2 ? 100 : 0));
        raised.build(cells, 50_000, 0.05, 65);
        return [raised.count, raised.mesh.geometry.attributes.position.count];
    }""")
    assert count == [20_000, 160_000]


async def test_blocks_stand_where_the_map_is_occupied(evaluate):
    await evaluate(MAKE, {**grid(3, 2, [0, 0, 100, 0, 0, 0], (10, 20)), "pose": (0, 0, 0)})
    box = await evaluate("""() => {
        const meshes = [];
        made.world.updateMatrixWorld(true);
        made.world.traverse((each) => each.isMesh && meshes.push(each));
        const { geometry, matrixWorld } = meshes[1];
        geometry.computeBoundingBox();
        const { min, max } = geometry.boundingBox.applyMatrix4(matrixWorld);
        return [made.blocks, ...min.toArray(), ...max.toArray()];
    }""")
    count, *corners = box
    width = grid(3, 2, [])["info"]["resolution"]
    assert count == 1
    # the room: x to the right, y up, z behind
    expected = [-20 - width, -0.01, -10 - 3 * width, -20, 0.39, -10 - 2 * width]
    assert corners == pytest.approx(expected, abs=1e-5)


@pytest.mark.parametrize(
    ("start", "end", "is_hidden"),
    [
        ((0.2, 0.2), (0.7, 0.2), False),  # the block itself is what is pointed at
        ((0.2, 0.2), (1.2, 0.2), True),
        ((1.2, 0.2), (1.2, 0.7), False),
        ((1.2, 0.2), (0.2, 0.2), True),  # from the other side
        ((-5, 0.2), (0.2, 0.2), False),  # from beyond the map
        ((0.2, 0.7), (1.2, 0.7), False),  # past it
    ],
)
async def test_a_block_hides_what_is_behind_it(evaluate, start, end, is_hidden):
    cells = [0, 100, 0, 0, 0, 0]
    await evaluate(MAKE, {**grid(3, 2, cells), "pose": (0, 0, 0)})
    hides = "([[a, b], [x, y]]) => made.hides({ x: a, y: b }, { x, y })"
    assert await evaluate(hides, [start, end]) == is_hidden
    refusal = "([[a, b], [x, y]]) => made.refusal({ x, y }, { x: a, y: b })"
    assert ("is before that place" in await evaluate(refusal, [start, end])) == is_hidden


async def test_the_lab_raises_the_walls_of_its_map(demo, speaker, open_page):
    async with opened(open_page, page_address(demo)) as page:
        await page.wait_for_function("() => lab.map.blocks > 10")
        # a ray along the floor, through the far wall to a place in the room behind it
        behind = "() => lab.map.refusal({ x: 4.5, y: 0 }, { x: 0, y: 0 })"
        assert await page.evaluate(behind) != ""
        assert await page.evaluate("() => lab.map.hides({ x: 0, y: 0 }, { x: 4.5, y: 0 })")
        assert not await page.evaluate("() => lab.map.hides({ x: 0, y: 0 }, { x: 1, y: 0 })")


async def test_the_television_is_three_metres_high_and_hides_no_screen(demo, speaker, open_page):
    async with opened(open_page, page_address(demo)) as page:
        await page.wait_for_function("() => lab.television.shown > 0")
        found = await page.evaluate("""() => {
            const { viewer, television, screens } = lab;
            const box = (mesh) => {
                mesh.updateWorldMatrix(true, false);
                mesh.geometry.computeBoundingBox();
                return mesh.geometry.boundingBox.clone().applyMatrix4(mesh.matrixWorld);
            };
            viewer.rig.updateWorldMatrix(true, true);
            const right = (mesh) => {
                const { min, max } = box(mesh);
                const ends = [min, max].map((end) => end.clone().project(viewer.camera).x);
                return [Math.min(...ends), Math.max(...ends)];
            };
            const { min, max } = box(television.mesh);
            const [left, end] = right(television.mesh);
            const hidden = Object.values(screens).filter(({ mesh }) => {
                const [from, to] = right(mesh);
                return from < end && to > left;
            });
            return [max.y - min.y, hidden.length];
        }""")
        assert found == [pytest.approx(3), 0]
