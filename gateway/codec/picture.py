# SPDX-License-Identifier: Apache-2.0
"""A sensor_msgs/msg/Image as JSON that carries a compressed picture instead of pixels."""

from collections.abc import Callable
from typing import Any, cast

import pybase64

from gateway.codec.image import ImageOptions, RawImage, compress
from gateway.codec.json import dumps
from gateway.codec.types import MessageType


def picture_renderer(image_type: MessageType, options: ImageOptions) -> Callable[[bytes], bytes]:
    """Return a function from the CDR of an image to JSON in the shape of CompressedImage.

    Beside ``header``, ``format`` and ``data`` (base64) it has ``width`` and ``height`` of the
    picture, and ``depth_range_m`` where grey means distance. The function may run in any
    thread; it raises `CodecError`.
    """
    decode = image_type.decoder(octets="raw")

    def render(cdr: bytes) -> bytes:
        values = cast("dict[str, Any]", decode(cdr))
        picture = compress(
            RawImage(
                values["height"],
                values["width"],
                values["encoding"],
                bool(values["is_bigendian"]),
                values["step"],
                values["data"],
            ),
            options,
        )
        message: dict[str, object] = {
            "header": values["header"],
            "format": picture.format,
            "data": pybase64.b64encode_as_string(picture.data),
            "width": picture.width,
            "height": picture.height,
        }
        if picture.depth_range_m is not None:
            message["depth_range_m"] = picture.depth_range_m
        return dumps(message)

    return render
