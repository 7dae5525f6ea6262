# SPDX-License-Identifier: Apache-2.0
"""Made-up messages are valid, recognisable and different each time, for every type."""

import math

import cv2
import numpy as np
import pytest

from gateway_sim.content import FRAME, HEIGHT, WIDTH, Inventor
from schemas.definition import FLOATS, INTEGER_RANGES, STRINGS
from schemas.installed import InstalledDefinitions
from schemas.table import Table

DEFINITIONS = InstalledDefinitions()
INVENTOR = Inventor(DEFINITIONS)
NOW_NS = 1_700_000_000_123_456_789
NAMES = [row.name for row in Table.load().rows]
# These have nothing that could differ.
CONSTANT = {"std_msgs/msg/Empty", "std_msgs/msg/MultiArrayLayout"}


def assert_valid(name, values):
    definition = DEFINITIONS.get(name)
    assert set(values) == {field.name for field in definition.fields}, name
    for field in definition.fields:
        value, kind = values[field.name], field.type
        where = f"{name}.{field.name}"
        if not kind.is_array:
            elements = [value]
        else:
            elements = list(value)
            assert isinstance(value, bytes) == kind.is_octets, where
            assert kind.length in {None, len(value)}, where
            assert kind.bound is None or len(value) <= kind.bound, where
        for element in elements:
            if kind.base in INTEGER_RANGES:
                low, high = INTEGER_RANGES[kind.base]
                assert type(element) is int, where
                assert low <= element <= high, where
            elif kind.base in FLOATS:
                assert math.isfinite(element), where
            elif kind.base in STRINGS:
                assert isinstance(element, str), where
                assert kind.string_bound is None or len(element) <= kind.string_bound, where
            elif kind.base == "bool":
                assert isinstance(element, bool), where
            else:
                assert_valid(kind.base, element)


@pytest.mark.parametrize("name", NAMES)
def test_values_fit_their_definition(name):
    for counter in (0, 1, 255, 70_000, 2**33):
        assert_valid(name, INVENTOR.values(name, counter, NOW_NS))


@pytest.mark.parametrize("name", ["Strings", "BoundedSequences", "Arrays", "WStrings"])
def test_values_fit_bounds_that_no_common_type_has(name):
    assert_valid(f"test_msgs/msg/{name}", INVENTOR.values(f"test_msgs/msg/{name}", 10**16, NOW_NS))


@pytest.mark.parametrize("name", sorted({*NAMES} - CONSTANT))
def test_one_message_differs_from_the_next(name):
    first, second = (INVENTOR.values(name, n, NOW_NS + n * 10**9) for n in (3, 4))
    assert first != second


def test_the_same_counter_and_time_give_the_same_message():
    first, second = (INVENTOR.values("nav_msgs/msg/Odometry", 7, NOW_NS) for _ in range(2))
    assert first == second


def test_a_string_carries_its_type_and_the_counter():
    assert INVENTOR.values("std_msgs/msg/String", 42, NOW_NS) == {"data": "String 42"}


def test_fields_can_be_told_apart():
    assert INVENTOR.values("geometry_msgs/msg/Vector3", 10, NOW_NS) == {
        "x": 10.5,
        "y": 11.5,
        "z": 12.5,
    }


def test_a_header_has_the_time_and_a_frame():
    assert INVENTOR.values("std_msgs/msg/Header", 1, NOW_NS) == {
        "stamp": {"sec": 1_700_000_000, "nanosec": 123_456_789},
        "frame_id": FRAME,
    }


def test_an_image_is_a_picture_whose_bar_moves():
    for counter in (0, 5, WIDTH + 5):
        image = INVENTOR.values("sensor_msgs/msg/Image", counter, NOW_NS)
        assert image["encoding"] == "rgb8"
        pixels = np.frombuffer(image["data"], np.uint8).reshape(HEIGHT, image["step"] // 3, 3)
        assert (pixels[:, counter % WIDTH] == 255).all()
        assert (pixels[:, (counter + 1) % WIDTH] < 255).any()


def test_a_compressed_image_is_a_jpeg():
    image = INVENTOR.values("sensor_msgs/msg/CompressedImage", 9, NOW_NS)
    decoded = cv2.imdecode(np.frombuffer(image["data"], np.uint8), cv2.IMREAD_COLOR)
    assert decoded.shape == (HEIGHT, WIDTH, 3)
    assert decoded[:, 9].min() > 180
    assert decoded[HEIGHT - 1, 30, 0] > decoded[HEIGHT - 1, 30, 2], "blue at the bottom"


def test_a_laser_scan_has_a_range_for_each_angle():
    scan = INVENTOR.values("sensor_msgs/msg/LaserScan", 2, NOW_NS)
    beams = 1 + (scan["angle_max"] - scan["angle_min"]) / scan["angle_increment"]
    assert len(scan["ranges"]) == len(scan["intensities"]) == round(beams)
    assert all(scan["range_min"] < r < scan["range_max"] for r in scan["ranges"])


def test_clouds_grids_and_arrays_have_the_size_they_state():
    cloud = INVENTOR.values("sensor_msgs/msg/PointCloud2", 2, NOW_NS)
    assert len(cloud["data"]) == cloud["height"] * cloud["row_step"]
    assert cloud["row_step"] == cloud["width"] * cloud["point_step"]
    grid = INVENTOR.values("nav_msgs/msg/OccupancyGrid", 2, NOW_NS)
    assert len(grid["data"]) == grid["info"]["width"] * grid["info"]["height"]
    assert all(-1 <= cell <= 100 for cell in grid["data"])
    array = INVENTOR.values("std_msgs/msg/Float64MultiArray", 2, NOW_NS)
    assert len(array["data"]) == array["layout"]["dim"][0]["size"]
    stereo = INVENTOR.values("stereo_msgs/msg/DisparityImage", 2, NOW_NS)["image"]
    assert len(stereo["data"]) == stereo["height"] * stereo["step"]


def test_orientations_are_unit_quaternions():
    for counter in range(50):
        q = INVENTOR.values("geometry_msgs/msg/Quaternion", counter, NOW_NS)
        assert sum(part**2 for part in q.values()) == pytest.approx(1)


def test_a_status_is_one_of_its_constants():
    seen = {
        INVENTOR.values("actionlib_msgs/msg/GoalStatus", n, NOW_NS)["status"] for n in range(30)
    }
    assert seen == set(range(10))
    seen = {
        INVENTOR.values("sensor_msgs/msg/BatteryState", n, NOW_NS)["power_supply_status"]
        for n in range(30)
    }
    assert seen == set(range(5))
