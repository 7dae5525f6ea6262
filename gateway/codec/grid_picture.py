# SPDX-License-Identifier: Apache-2.0
"""A nav_msgs/msg/OccupancyGrid as a grey PNG, and back: of 16 MB it takes a tenth, or less."""

from collections.abc import Callable
from struct import pack
from typing import Any, Final, cast

import cv2
import numpy as np

from gateway.codec.cdr import Cdr
from gateway.codec.cdr.misfits import MAX_CDR_BYTES
from gateway.codec.compressed_images import decompress
from gateway.codec.error_text import CodecError
from gateway.codec.picture_message import PictureMessage
from gateway.codec.types import MessageType

GRID: Final = "nav_msgs/msg/OccupancyGrid"


def grid_renderer(grid_type: MessageType) -> Callable[[Cdr], PictureMessage]:
    """Return a function from the CDR of a grid to a message with a PNG in the place of its cells.

    Grey is the octet of a cell: 0 to 100, and 255 for -1, which is unknown. The rows follow each
    other as in the message. The function may run in any thread. It raises `CodecError`.
    """
    decode = grid_type.decoder(octets="raw")

    def render(cdr: Cdr) -> PictureMessage:
        values = cast("dict[str, Any]", decode(cdr))
        info = values["info"]
        width, height = info["width"], info["height"]
        return PictureMessage(
            {
                "header": values["header"],
                "info": info,
                "format": "png",
                "data": _png(np.asarray(values["data"], np.int8), width, height),
                "width": width,
                "height": height,
            }
        )

    return render


def grid_maker(grid_type: MessageType) -> Callable[[bytes], bytes]:
    """Return a function from the CDR of a grid whose cells are a PNG, to that of the grid.

    A size that `info` leaves out is that of the picture. The function may run in any thread. It
    raises `CodecError`.
    """
    decode = grid_type.decoder(octets="raw")
    encode = grid_type.compiled_encoder

    def make(cdr: bytes) -> bytes:
        values = cast("dict[str, Any]", decode(cdr))
        image = decompress("png", np.asarray(values["data"], np.int8).tobytes(), MAX_CDR_BYTES)
        if image.encoding != "mono8":
            raise CodecError(f"the PNG of a grid is {image.encoding}; send grey of 8 bits")
        info = values["info"]
        size, stated = (image.width, image.height), (info["width"], info["height"])
        if any(given not in {0, actual} for given, actual in zip(stated, size, strict=True)):
            text = f"the PNG has {size[0]} x {size[1]} pixels, info says {stated[0]} x {stated[1]}"
            raise CodecError(f"{text}; leave out its width and height")
        info |= {"width": size[0], "height": size[1], "resolution": float(info["resolution"])}
        without_cells = encode({"header": values["header"], "info": info}, 0)
        # `data` is the last field: its count is the last four bytes
        return b"".join((without_cells[:-4], pack("<I", len(image.data)), image.data))

    return make


def _png(cells: "np.ndarray[Any, np.dtype[np.int8]]", width: int, height: int) -> bytes:
    if len(cells) != width * height:
        raise CodecError(f"grid has {len(cells)} cells, expected {width} x {height}")
    if not len(cells):
        raise CodecError("grid has no cells, and no picture")
    grey = cells.view(np.uint8).reshape(height, width)
    try:
        done, encoded = cv2.imencode(".png", grey)
    except cv2.error:
        done = False
    if not done:  # a side is longer than PNG's encoder takes
        raise CodecError(f"png encoder refused a grid of {width}x{height} cells")
    return encoded.tobytes()
