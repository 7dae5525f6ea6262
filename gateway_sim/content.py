# SPDX-License-Identifier: Apache-2.0
"""Made-up messages of any type: valid, recognisable, and different each time.

Pure: a message is a dict by field name, octets are `bytes`, and time is an argument. Numbers
increase with the counter and from field to field, which shows swapped fields and lost messages.
Strings have the type's name and the counter.
"""

import math
from collections.abc import Callable
from itertools import count
from typing import Any, Final

import cv2
import numpy as np

from schemas.definition import FLOATS, INTEGER_RANGES, STRINGS, Definition, Field
from schemas.installed import InstalledDefinitions

FRAME: Final = "mock"
WIDTH: Final = 64  # pixels
HEIGHT: Final = 48
_ELEMENTS: Final = 3  # of a sequence: enough to see an order. Related sequences are equally long
_BEAMS: Final = 36

Values = dict[str, Any]


class Inventor:
    """Makes up messages from the installed definitions."""

    def __init__(self, definitions: InstalledDefinitions) -> None:
        self._definitions = definitions

    def values(self, name: str, counter: int, now_ns: int) -> Values:
        """Make up message number *counter* of the type ``pkg/msg/Name``.

        Raises:
            UnknownTypeError: a definition is not installed.
            DefinitionError: a definition cannot be parsed.
        """
        return self._message(name, counter, now_ns, count(counter))

    def _message(self, name: str, counter: int, now_ns: int, numbers: "count[int]") -> Values:
        if name == "builtin_interfaces/msg/Time":
            return {"sec": now_ns // 10**9 % 2**31, "nanosec": now_ns % 10**9}
        definition = self._definitions.get(name)
        values = {
            field.name: self._field(definition, field, counter, now_ns, numbers)
            for field in definition.fields
        }
        special = _SPECIAL.get(name)
        return values if special is None else values | special(counter)

    def _field(
        self,
        definition: Definition,
        field: Field,
        counter: int,
        now_ns: int,
        numbers: "count[int]",
    ) -> Any:
        kind = field.type
        if field.name.endswith("covariance") and kind.length in {9, 36}:
            return _covariance(round(math.sqrt(kind.length)))

        def one() -> Any:
            if not kind.is_primitive:
                return self._message(kind.base, counter, now_ns, numbers)
            return _primitive(definition, field, next(numbers))

        if not kind.is_array:
            return one()
        size = _ELEMENTS if kind.bound is None else min(_ELEMENTS, kind.bound)
        elements = [one() for _ in range(size if kind.length is None else kind.length)]
        return bytes(elements) if kind.is_octets else elements


def _primitive(definition: Definition, field: Field, number: int) -> bool | int | float | str:
    base = field.type.base
    if base == "bool":
        return number % 2 == 1
    if base in FLOATS:
        return number + 0.5
    if base in STRINGS:
        if field.name.endswith("frame_id"):
            return FRAME
        return f"{definition.short_name} {number}"[: field.type.string_bound]
    allowed = _named_values(definition, field)
    if allowed:
        return allowed[number % len(allowed)]
    return number % (INTEGER_RANGES[base][1] + 1)


def _named_values(definition: Definition, field: Field) -> list[int]:
    """Return the constants for an integer field, if the definition shows which belong to it."""
    constants = [c for c in definition.constants if c.type == field.type.base]
    prefix = f"{field.name.upper()}_"
    own = [c for c in constants if c.name.startswith(prefix)]
    alone = sum(f.type.base == field.type.base for f in definition.fields) == 1
    chosen = own or (constants if alone else [])
    return [int(c.value) for c in chosen]


def _covariance(size: int) -> list[float]:
    return [0.01 if i % (size + 1) == 0 else 0.0 for i in range(size * size)]


def _pixels(counter: int) -> np.ndarray[Any, np.dtype[np.uint8]]:
    """Draw a blue gradient under a white bar that moves one pixel per message."""
    pixels = np.zeros((HEIGHT, WIDTH, 3), np.uint8)
    pixels[:, :, 0] = np.linspace(0, 120, WIDTH)
    pixels[:, :, 2] = np.linspace(80, 255, HEIGHT)[:, None]
    pixels[:, counter % WIDTH] = 255
    return pixels


def _image(counter: int) -> Values:
    return {
        "height": HEIGHT,
        "width": WIDTH,
        "encoding": "rgb8",
        "is_bigendian": 0,
        "step": 3 * WIDTH,
        "data": _pixels(counter).tobytes(),
    }


def _compressed_image(counter: int) -> Values:
    _, jpeg = cv2.imencode(".jpg", cv2.cvtColor(_pixels(counter), cv2.COLOR_RGB2BGR))
    return {"format": "rgb8; jpeg compressed bgr8", "data": jpeg.tobytes()}


def _disparity_image(counter: int) -> Values:
    disparity = np.full((HEIGHT, WIDTH), 1 + counter % 60, "<f4")
    stamp = {"sec": 0, "nanosec": 0}
    image = {
        "header": {"stamp": stamp, "frame_id": FRAME},
        "height": HEIGHT,
        "width": WIDTH,
        "encoding": "32FC1",
        "is_bigendian": 0,
        "step": 4 * WIDTH,
        "data": disparity.tobytes(),
    }
    return {"image": image, "min_disparity": 1.0, "max_disparity": 60.0}


def _camera_info(_counter: int) -> Values:
    f, cx, cy = 60.0, (WIDTH - 1) / 2, (HEIGHT - 1) / 2
    return {
        "height": HEIGHT,
        "width": WIDTH,
        "distortion_model": "plumb_bob",
        "d": [0.0] * 5,
        "k": [f, 0.0, cx, 0.0, f, cy, 0.0, 0.0, 1.0],
        "r": [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0],
        "p": [f, 0.0, cx, 0.0, 0.0, f, cy, 0.0, 0.0, 0.0, 1.0, 0.0],
        "binning_x": 0,
        "binning_y": 0,
    }


def _laser_scan(counter: int) -> Values:
    step = math.tau / _BEAMS
    return {
        "angle_min": 0.0,
        "angle_max": (_BEAMS - 1) * step,
        "angle_increment": step,
        "time_increment": 0.1 / _BEAMS,
        "scan_time": 0.1,
        "range_min": 0.1,
        "range_max": 10.0,
        "ranges": [1.0 + (counter + beam) % _BEAMS * 0.1 for beam in range(_BEAMS)],
        "intensities": [float(beam) for beam in range(_BEAMS)],
    }


def _point_cloud(counter: int) -> Values:
    points = np.array([(counter, i, i * 0.5) for i in range(_ELEMENTS)], "<f4")
    return {
        "height": 1,
        "width": _ELEMENTS,
        "fields": [
            {"name": name, "offset": 4 * i, "datatype": 7, "count": 1}  # 7: FLOAT32
            for i, name in enumerate("xyz")
        ],
        "is_bigendian": False,
        "point_step": 12,
        "row_step": 12 * _ELEMENTS,
        "data": points.tobytes(),
        "is_dense": True,
    }


def _grid_info(_counter: int) -> Values:
    return {"resolution": 0.05, "width": 8, "height": 6}


def _occupancy_grid(counter: int) -> Values:
    return {"data": [100 if i == counter % 48 else i % 2 - 1 for i in range(48)]}


def _quaternion(counter: int) -> Values:
    half = counter * 0.05
    return {"x": 0.0, "y": 0.0, "z": math.sin(half), "w": math.cos(half)}


def _colour(counter: int) -> Values:
    return {"r": counter % 11 / 10, "g": 0.5, "b": 1 - counter % 11 / 10, "a": 1.0}


def _battery_state(counter: int) -> Values:
    return {"percentage": 1 - counter % 100 / 100, "voltage": 12.0, "current": -1.0}


def _nav_sat_fix(counter: int) -> Values:
    return {"latitude": 48.0 + counter % 100 * 1e-5, "longitude": 11.0, "altitude": 500.0}


def _layout(_counter: int) -> Values:
    return {
        "dim": [{"label": "element", "size": _ELEMENTS, "stride": _ELEMENTS}],
        "data_offset": 0,
    }


# Rules that the fields' types do not state: numbers that must agree, ranges, formats.
_SPECIAL: Final[dict[str, Callable[[int], Values]]] = {
    "geometry_msgs/msg/Quaternion": _quaternion,
    "nav_msgs/msg/MapMetaData": _grid_info,
    "nav_msgs/msg/OccupancyGrid": _occupancy_grid,
    "sensor_msgs/msg/BatteryState": _battery_state,
    "sensor_msgs/msg/CameraInfo": _camera_info,
    "sensor_msgs/msg/CompressedImage": _compressed_image,
    "sensor_msgs/msg/Image": _image,
    "sensor_msgs/msg/LaserScan": _laser_scan,
    "sensor_msgs/msg/NavSatFix": _nav_sat_fix,
    "sensor_msgs/msg/PointCloud2": _point_cloud,
    "std_msgs/msg/ColorRGBA": _colour,
    "std_msgs/msg/MultiArrayLayout": _layout,
    "stereo_msgs/msg/DisparityImage": _disparity_image,
}
