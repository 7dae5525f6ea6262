# SPDX-License-Identifier: Apache-2.0
"""A sensor_msgs/msg/Image, or CompressedImage, as the picture that a client asks for, and back."""

from collections.abc import Callable
from struct import pack
from typing import Any, Final, cast

from gateway.codec.cdr import Cdr
from gateway.codec.cdr.misfits import MAX_CDR_BYTES
from gateway.codec.compressed_images import decompress
from gateway.codec.image import ImageOptions, compress
from gateway.codec.image_encodings import RawImage
from gateway.codec.picture_message import PictureMessage
from gateway.codec.types import MessageType

IMAGE: Final = "sensor_msgs/msg/Image"
COMPRESSED_IMAGE: Final = "sensor_msgs/msg/CompressedImage"


def picture_renderer(
    image_type: MessageType, options: ImageOptions
) -> Callable[[Cdr], PictureMessage]:
    """Return a function from the CDR of an image to a message in the shape of CompressedImage.

    In addition to ``header``, ``format`` and ``data`` it has ``width`` and ``height`` of the
    picture, and ``depth_range_m`` if grey means distance. The function may run in any thread.
    It raises `CodecError`.
    """
    decode = image_type.decoder(octets="raw")
    pixels_of = _unpacked if image_type.name == COMPRESSED_IMAGE else _as_it_is

    def render(cdr: Cdr) -> PictureMessage:
        values = cast("dict[str, Any]", decode(cdr))
        picture = compress(pixels_of(values), options)
        message: dict[str, object] = {
            "header": values["header"],
            "format": picture.format,
            "data": picture.data,
            "width": picture.width,
            "height": picture.height,
        }
        if picture.depth_range_m is not None:
            message["depth_range_m"] = picture.depth_range_m
        return PictureMessage(message)

    return render


def pixel_maker(compressed_type: MessageType, image_type: MessageType) -> Callable[[bytes], bytes]:
    """Return a function from the CDR of a CompressedImage to that of the Image that it shows.

    The function may run in any thread. It raises `CodecError`.
    """
    decode = compressed_type.decoder(octets="raw")
    encode = image_type.compiled_encoder

    def make(cdr: bytes) -> bytes:
        values = cast("dict[str, Any]", decode(cdr))
        image = decompress(values["format"], values["data"], MAX_CDR_BYTES)
        without_pixels = encode(
            {
                "header": values["header"],
                "height": image.height,
                "width": image.width,
                "encoding": image.encoding,
                "step": image.step,
            },
            0,
        )
        # `data` is the last field: its count is the last four bytes. One copy instead of three.
        return b"".join((without_pixels[:-4], pack("<I", len(image.data)), image.data))

    return make


def _as_it_is(values: dict[str, Any]) -> RawImage:
    return RawImage(
        values["height"],
        values["width"],
        values["encoding"],
        bool(values["is_bigendian"]),
        values["step"],
        values["data"],
    )


def _unpacked(values: dict[str, Any]) -> RawImage:
    return decompress(values["format"], values["data"])
