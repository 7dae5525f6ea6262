# SPDX-License-Identifier: Apache-2.0
"""A sensor_msgs/msg/PointCloud2 with fewer points, of two bytes for each value.

Everything here may run in any thread. NumPy releases the GIL for most of the work.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Final, cast

import numpy as np
from numpy.typing import NDArray

from gateway.codec.cdr import Cdr
from gateway.codec.error_text import CodecError, did_you_mean
from gateway.codec.picture_message import PictureMessage
from gateway.codec.types import MessageType

CLOUD: Final = "sensor_msgs/msg/PointCloud2"
# A message of 16,000 points without further fields: it crosses a Wi-Fi of 10 Mbit/s in 80 ms.
DEFAULT_CLOUD_BYTES: Final = 96_000
MAX_CLOUD_POINTS: Final = 500_000  # 3 MB, more than a browser draws smoothly
MIN_VOXEL_M: Final = 0.001
MAX_VOXEL_M: Final = 1000.0
MAX_CLOUD_FIELDS: Final = 8
MAX_DISTANCE_M: Final = 1e9  # of a point: farther ones are dropped, as NaN is

COLOURS: Final = ("rgb", "rgba")  # packed in 32 bits, as the Point Cloud Library has them
_PLACE: Final = ("x", "y", "z")
_VALUE_BYTES: Final = 2
_LARGEST: Final = 32767  # of a value, and its negative the smallest. -32768: not a number
_NOT_A_NUMBER: Final = -32768
_VOXELS: Final = 2**21  # along an axis: three of them fit in 63 bits
# of sensor_msgs/msg/PointField, by its constants
_DATATYPES: Final = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 8: "f8"}

Numbers = NDArray[Any]


@dataclass(frozen=True, slots=True)
class CloudOptions:
    """The options of a thinned cloud. Equal options give equal messages."""

    max_points: int | None = None  # as many as fit in `DEFAULT_CLOUD_BYTES`
    voxel_m: float | None = None  # one point in each cube of this width
    fields: tuple[str, ...] = ()  # in addition to x, y and z
    stays_cloud: bool = False  # a PointCloud2, with all bytes of each point that is kept

    @property
    def most_points(self) -> int:
        """The largest number of points in a message."""
        if self.max_points is not None:
            return self.max_points
        return DEFAULT_CLOUD_BYTES // (_VALUE_BYTES * (len(_PLACE) + len(self.fields)))


def cloud_renderer(
    cloud_type: MessageType, options: CloudOptions
) -> Callable[[Cdr], PictureMessage]:
    """Return a function from the CDR of a cloud to its thinned message.

    ``data`` has x, y, z of each point as int16, little-endian. Then come the values of the first
    further field, and so on. The function may run in any thread. It raises `CodecError`.
    """
    decode = cloud_type.decoder(octets="raw")

    def render(cdr: Cdr) -> PictureMessage:
        values = cast("dict[str, Any]", decode(cdr))
        columns = _Columns(values)
        place = [columns.numbers(name) for name in _PLACE]
        further = [columns.numbers(name) for name in options.fields]
        kept = _kept(place, options)
        if options.stays_cloud:
            return PictureMessage(_chosen(values, columns, kept))
        points = np.stack([each[kept].astype(np.float64) for each in place])
        packed = [_packed(column) for column in points]
        scalings = [scaling for _, scaling in packed]
        fields = [{"name": name, **each} for name, each in zip(_PLACE, scalings, strict=True)]
        parts: list[Numbers] = [np.stack([numbers for numbers, _ in packed], axis=1)]
        for name, column in zip(options.fields, further, strict=True):
            chosen = column[kept]
            if name in COLOURS:
                parts.append(_colours(chosen))
                fields.append({"name": name, "format": "rgb565"})
            else:
                numbers, scaling = _packed(chosen.astype(np.float64))
                parts.append(numbers)
                fields.append({"name": name, **scaling})
        return PictureMessage(
            {
                "header": values["header"],
                "format": "int16",
                "points": len(kept),
                "of": columns.count,
                "fields": fields,
                "available": columns.names,
                "data": b"".join(part.tobytes() for part in parts),
            }
        )

    return render


def _chosen(values: dict[str, Any], columns: "_Columns", kept: NDArray[np.intp]) -> dict[str, Any]:
    """Return the values of a cloud that has the kept points alone, in one row."""
    data = columns.points()[kept].tobytes()
    size = {"height": 1, "width": len(kept), "row_step": len(data)}
    return {**values, **size, "is_dense": True, "data": data}


class _Columns:
    """The values of each field of a cloud, where they stand in its bytes."""

    def __init__(self, values: dict[str, Any]) -> None:
        self._fields = {each["name"]: each for each in values["fields"]}
        self._order = ">" if values["is_bigendian"] else "<"
        self._data = values["data"]
        self._shape = (values["height"], values["width"])
        self._steps = (values["row_step"], values["point_step"])
        self.count = values["height"] * values["width"]

    @property
    def names(self) -> list[str]:
        """The names of all fields."""
        return list(self._fields)

    def points(self) -> Numbers:
        """Return the bytes of each point. See `numbers`, which has checked that they are there."""
        if not self.count:
            return np.empty((0, self._steps[1]), np.uint8)
        shape, strides = (*self._shape, self._steps[1]), (*self._steps, 1)
        found: Numbers = np.ndarray(shape, np.uint8, self._data, 0, strides)
        return found.reshape(self.count, -1)

    def numbers(self, name: str) -> Numbers:
        """Return the values of a field, one for each point. They are not copied.

        Raises:
            CodecError: the cloud has no such field, or contradicts itself.
        """
        field = self._fields.get(name)
        if field is None:
            known = ", ".join(self.names) or "none"
            text = f"the cloud has no field {name!r}, its fields are {known}"
            raise CodecError(text + did_you_mean(name, self.names))
        datatype = _DATATYPES.get(field["datatype"])
        if datatype is None:
            raise CodecError(f"field {name!r} has the unknown datatype {field['datatype']}")
        if name in COLOURS:
            datatype = "u4"  # a float by name, whose bits are the colour
        kind = np.dtype(self._order + datatype)
        (height, width), (row_step, point_step) = self._shape, self._steps
        offset = field["offset"]
        if not self.count:
            return np.empty(0, kind)
        if offset + kind.itemsize > point_step:
            text = f"field {name!r} ends at byte {offset + kind.itemsize} of a point"
            raise CodecError(f"{text}, but point_step is {point_step}")
        if height > 1 and row_step < width * point_step:
            text = f"row_step is {row_step}, needs {width} x {point_step}"
            raise CodecError(text)
        needed = (height - 1) * row_step + width * point_step
        if needed > len(self._data):
            raise CodecError(f"the cloud has {len(self._data)} bytes of data, needs {needed}")
        strides = (row_step, point_step)
        found: Numbers = np.ndarray(self._shape, kind, self._data, offset, strides)
        return found.reshape(-1)


def _kept(place: Sequence[Numbers], options: CloudOptions) -> NDArray[np.intp]:
    """Return which points stay: those with a place, thinned."""
    # NaN is not less
    has_place = np.logical_and.reduce([np.abs(each) < MAX_DISTANCE_M for each in place])
    kept = np.flatnonzero(has_place)
    if options.voxel_m is not None and len(kept):
        kept = _one_per_voxel(place, kept, options.voxel_m)
    most = options.most_points
    if len(kept) > most:
        kept = kept[np.arange(most) * len(kept) // most]
    return kept


def _one_per_voxel(
    place: Sequence[Numbers], kept: NDArray[np.intp], voxel_m: float
) -> NDArray[np.intp]:
    """Return the first point of each cube. Cubes of a huge cloud are larger, so that they fit."""
    keys = np.zeros(len(kept), np.int64)
    for each in place:
        along = each[kept].astype(np.float64)
        least = along.min()
        width = max(voxel_m, (along.max() - least) / (_VOXELS - 2))
        # from the origin of the frame, so that they stand still from message to message
        cells = np.floor(along / width)
        keys = keys * _VOXELS + (cells - np.floor(least / width)).astype(np.int64)
    _, first = np.unique(keys, return_index=True)
    return kept[np.sort(first)]


def _packed(numbers: NDArray[np.float64]) -> tuple[NDArray[np.int16], dict[str, object]]:
    """Return numbers as 16 bits, and how to read them: ``offset + scale * value``."""
    is_number = np.isfinite(numbers)
    finite = numbers[is_number]
    least, most = (finite.min(), finite.max()) if len(finite) else (0.0, 0.0)
    scale = float(most / (2 * _LARGEST) - least / (2 * _LARGEST)) or 1.0
    offset = float(least / 2 + most / 2)
    values = np.full(len(numbers), _NOT_A_NUMBER, "<i2")
    values[is_number] = np.clip(np.rint((finite - offset) / scale), -_LARGEST, _LARGEST)
    return values, {"scale": scale, "offset": offset}


def _colours(packed: Numbers) -> NDArray[np.uint16]:
    """Return colours of 0xRRGGBB as 5, 6 and 5 bits."""
    colours = packed.astype(np.uint32)
    red, green, blue = colours >> 8 & 0xF800, colours >> 5 & 0x07E0, colours >> 3 & 0x001F
    return (red | green | blue).astype("<u2")
