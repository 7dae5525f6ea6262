# SPDX-License-Identifier: Apache-2.0
import base64
import json
import math

import cbor2
import numpy as np
import pytest

from gateway.codec.cloud import CLOUD, CloudOptions, cloud_renderer
from gateway.codec.error_text import CodecError
from gateway.codec.types import Types
from schemas.installed import InstalledDefinitions

TYPE = Types(InstalledDefinitions()).get(CLOUD)
RNG = np.random.default_rng(7)
KINDS = {"i1": 1, "u1": 2, "i2": 3, "u2": 4, "i4": 5, "u4": 6, "f4": 7, "f8": 8}


def cdr(points, *, order="<", padding=0, names="xyz", rows_of=1, **values) -> bytes:
    """Return a cloud of columns by name, or of rows of x, y and z."""
    if not isinstance(points, dict):
        points = dict(zip(names, np.asarray(points, "f4").reshape(-1, len(names)).T, strict=True))
    count = len(next(iter(points.values())))
    width = count // rows_of
    kinds = [(name, order + column.dtype.str[1:]) for name, column in points.items()]
    rows = np.zeros(count, kinds)
    for name, column in points.items():
        rows[name] = column
    fields = [
        {"name": name, "offset": offset, "datatype": KINDS[kind.str[1:]], "count": 1}
        for name, (kind, offset) in rows.dtype.fields.items()
    ]
    step = rows.itemsize
    packed = rows.tobytes()
    lines = [packed[at * width * step :][: width * step] for at in range(rows_of)]
    plain = {
        "header": {"stamp": {"sec": 3, "nanosec": 4}, "frame_id": "lidar"},
        "height": rows_of,
        "width": width,
        "fields": fields,
        "is_bigendian": order == ">",
        "point_step": step,
        "row_step": width * step + padding,
        "data": list(b"".join(line + b"\xff" * padding for line in lines)),
        "is_dense": True,
    }
    return TYPE.encode(plain | values, 0)


def read(message: dict) -> np.ndarray:
    """Return what a client reads: a row of x, y, z and further fields for each point."""
    count, fields = message["points"], message["fields"]
    numbers = np.frombuffer(message["data"], "<i2").astype(float)
    places = numbers[: 3 * count].reshape(count, 3)
    further = numbers[3 * count :].reshape(len(fields) - 3, count).T
    scale, offset = ([each.get(key, 0) for each in fields] for key in ("scale", "offset"))
    return np.hstack([places, further]) * scale + offset


def thinned(cloud: bytes, *fields: str, **options) -> dict:
    return cloud_renderer(TYPE, CloudOptions(fields=fields, **options))(cloud).members


def test_values_are_those_of_the_cloud_to_a_65_thousandth_of_its_extent():
    points = RNG.uniform((-50, 0, 3), (50, 20, 4), (1000, 3)).astype("f4")
    message = thinned(cdr(points))
    assert message["header"]["frame_id"] == "lidar"
    assert (message["points"], message["of"], message["format"]) == (1000, 1000, "int16")
    found = read(message)
    extent = np.ptp(points, axis=0)
    assert (np.abs(found - points).max(axis=0) <= extent / 65_000).all()
    assert np.abs(found[:, 0] - points[:, 0]).max() > 0  # it is coarser than float32


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("order", "<>")
def test_every_datatype_is_read_in_either_order_of_its_bytes(kind, order):
    columns = {name: np.array([1, 2, 100], kind) for name in ("x", "y", "z", "intensity")}
    found = read(thinned(cdr(columns, order=order), "intensity"))
    assert found == pytest.approx(np.array([[1.0] * 4, [2.0] * 4, [100.0] * 4]), abs=0.002)


def test_a_point_without_a_place_is_dropped():
    points = [[1, 2, 3], [math.nan, 0, 0], [0, math.inf, 0], [0, 0, -math.inf], [0, 0, 2e9]]
    message = thinned(cdr(points))
    assert (message["points"], message["of"]) == (1, 5)
    assert read(message).tolist() == [[1, 2, 3]]
    assert thinned(cdr([[0, 0, 0.9e9]]))["points"] == 1


def test_a_value_that_is_not_a_number_is_the_smallest_of_16_bits():
    columns = dict.fromkeys("xyz", np.zeros(3, "f4"))
    columns["intensity"] = np.array([math.nan, 1, 2], "f4")
    message = thinned(cdr(columns), "intensity")
    numbers = np.frombuffer(message["data"], "<i2")[9:].tolist()
    assert numbers == [-32768, -32767, 32767]


@pytest.mark.parametrize("kind", ["f4", "u4"])
def test_colours_become_16_bits(kind):
    columns = dict.fromkeys("xyz", np.zeros(2, "f4"))
    columns["rgb"] = np.array([0xFF8040, 0x010203], "u4").view(kind)
    message = thinned(cdr(columns), "rgb")
    assert message["fields"][3] == {"name": "rgb", "format": "rgb565"}
    assert np.frombuffer(message["data"], "<u2")[6:].tolist() == [
        0b11111_100000_01000,
        0,
    ]


def test_rows_may_be_padded():
    points = np.arange(18.0).reshape(6, 3)
    found = read(thinned(cdr(points, rows_of=2, padding=5)))
    assert found == pytest.approx(points, abs=0.001)


@pytest.mark.parametrize("options", [{}, {"max_points": 10_000}, {"voxel_m": 0.001}])
def test_a_cloud_of_300_000_points_costs_at_most_100_kb(options):
    points = RNG.uniform(-30, 30, (300_000, 3))
    picture = cloud_renderer(TYPE, CloudOptions(**options))(cdr(points))
    assert picture.members["of"] == 300_000
    assert picture.members["points"] == options.get("max_points", 16_000)
    assert len(picture.cbor()) <= 100_000
    # evenly from all of it
    whole = cdr(np.arange(300_000.0).repeat(3).reshape(-1, 3))
    found = read(thinned(whole, **options))[:, 0]
    assert found.max() - found.min() > 299_000


def test_further_fields_take_the_place_of_points_by_default():
    columns = {name: RNG.uniform(0, 1, 20_000).astype("f4") for name in "xyzi"}
    message = thinned(cdr(columns), "i")
    assert (message["points"], len(message["data"])) == (12_000, 96_000)


def test_one_point_stays_in_each_voxel():
    grid = np.stack(np.meshgrid(*[np.arange(-3, 3)] * 3), axis=-1).reshape(-1, 3) + 0.25
    message = thinned(cdr(np.vstack([grid, grid + 0.5, grid + 0.1])), voxel_m=1.0)
    assert message["points"] == 6**3
    assert read(message) == pytest.approx(grid, abs=0.001)  # the first of each


def test_a_huge_cloud_has_larger_voxels():
    far = 0.9e9
    message = thinned(cdr([[0, 0, 0], [1, 0, 0], [far, far, far], [-far, 0, 0]]), voxel_m=0.01)
    assert message["points"] == 3


def test_an_empty_cloud_has_no_points():
    for options in ({}, {"voxel_m": 1.0}):
        message = thinned(cdr(np.empty((0, 3))), **options)
        assert (message["points"], message["data"]) == (0, b"")
    assert thinned(cdr([[math.nan] * 3]), voxel_m=1.0)["points"] == 0


def test_it_is_the_same_in_json_and_cbor():
    picture = cloud_renderer(TYPE, CloudOptions())(cdr([[1, 2, 3], [4, 5, 6]]))
    plain, packed = json.loads(picture.json()), cbor2.loads(picture.cbor())
    assert base64.b64decode(plain.pop("data")) == packed.pop("data")
    assert plain == packed


@pytest.mark.parametrize(
    ("cloud", "fields", "words"),
    [
        (cdr([[1, 2, 3]]), ["intensty"], "no field 'intensty', its fields are x, y, z"),
        (cdr([[1, 2]], names="xy"), [], "no field 'z', its fields are x, y"),
        (cdr([[1, 2, 3]], fields=[]), [], "no field 'x', its fields are none"),
        (cdr([[1, 2, 3]], width=2, row_step=24), [], "12 bytes of data, needs 24"),
        (cdr([[1, 2, 3]], width=2**32 - 1, height=2**32 - 1), [], "row_step is 12, needs"),
        (cdr([[1, 2, 3]], point_step=11), [], "ends at byte 12 of a point, but point_step is 11"),
        (cdr([[1, 2, 3]], point_step=0, width=2**32 - 1), [], "point_step is 0"),
        (
            cdr([[1, 2, 3]], fields=[{"name": "x", "datatype": 9}]),
            [],
            "field 'x' has the unknown datatype 9",
        ),
    ],
)
def test_a_cloud_that_contradicts_itself_is_refused_with_words(cloud, fields, words):
    with pytest.raises(CodecError, match=words):
        thinned(cloud, *fields)


@pytest.mark.parametrize("layout", [{}, {"rows_of": 4, "padding": 3}, {"order": ">"}])
def test_a_cloud_that_stays_one_has_all_bytes_of_its_points(layout):
    columns = {each: RNG.random(40).astype("f8") for each in ("x", "y", "z", "time")}
    columns["x"][:8] = math.nan
    options = CloudOptions(8, stays_cloud=True)
    message = cloud_renderer(TYPE, options)(cdr(columns, **layout))
    chosen = {name: column[8::4] for name, column in columns.items()}
    order = layout.get("order", "<")
    expected = TYPE.decoder(octets="raw")(cdr(chosen, order=order))
    assert message.members == {**expected, "data": bytes(expected["data"])}
    empty = cloud_renderer(TYPE, options)(cdr({name: np.zeros(0) for name in "xyz"}))
    assert (empty.members["width"], empty.data) == (0, b"")
