# SPDX-License-Identifier: Apache-2.0
"""Translation of the picture options in clients' requests to those of the codec."""

from dataclasses import replace

from gateway.codec.grid_picture import GRID
from gateway.codec.image import ImageOptions
from gateway.codec.picture import COMPRESSED_IMAGE, IMAGE
from gateway.codec.picture_formats import PICTURE_FORMATS
from gateway.codec.types import MessageType
from gateway.core.errors import ProtocolError
from gateway.core.requests import ImageFormat, Subscribe
from gateway.core.topics.picture_adaptation import Step
from gateway.core.topics.subscription_options import SubscriptionOptions


def requested_picture(
    message_type: MessageType,
    options: SubscriptionOptions,
    default_format: ImageFormat,
    step: Step,
) -> ImageOptions | None:
    """Return how pictures are encoded. ``None`` for plain messages.

    *step* says how much smaller than asked for pictures that fit the link are.

    Raises:
        ProtocolError: there are no such pictures.
    """
    image = _as_asked(message_type, options, default_format)
    if image is None or not fits_link(options, image):
        return image
    quality = min(image.quality, step.quality)
    return replace(image, quality=quality, reduction=step.reduction)


def why_plain(request: Subscribe, options: SubscriptionOptions, type_name: str) -> str:
    """Say why a request for pictures brings plain messages. "" for one that asks for none.

    *options* are those of all requests, which bring plain messages of type *type_name*.
    """
    if request.image is None or not request.image.asks_for_picture or options.image.format == "raw":
        return ""
    if type_name not in {IMAGE, COMPRESSED_IMAGE, GRID}:
        why = f"{type_name} cannot be sent as images"
    elif options.framing.content == "cdr":
        why = f"{options.framing.name} cannot be sent as images"
    elif options.fields is not None:
        why = "with fields, images are not available"
    else:
        why = "the default format is raw, and image names no other"
    return f"image: {why}, sending plain messages"


def fits_link(options: SubscriptionOptions, image: ImageOptions) -> bool:
    """Return whether pictures are made smaller for a slow link, which lossless ones are not."""
    return options.image.adapts and PICTURE_FORMATS[image.format].is_lossy


def _as_asked(
    message_type: MessageType, options: SubscriptionOptions, default_format: ImageFormat
) -> ImageOptions | None:
    image = options.image
    image_format = image.format or default_format
    if message_type.name == GRID:
        return _grid_options(options)
    if message_type.name == COMPRESSED_IMAGE:
        # it is a picture already, and stays as it is unless another one is asked for
        image_format = image.format or ("jpeg" if image.asks_for_picture else "raw")
    elif message_type.name != IMAGE:
        return None
    if options.fields is not None or image_format == "raw" or options.framing.content == "cdr":
        return None
    asked = ImageOptions(image_format, image.quality, image.max_width, image.max_height)
    if image.depth_range_m is None:
        return asked
    try:
        return replace(asked, depth_range_m=image.depth_range_m)
    except ValueError as error:
        raise ProtocolError("bad_request", f"image: {error}") from error


def _grid_options(options: SubscriptionOptions) -> ImageOptions | None:
    """Return how a map is encoded, with the values of its cells. ``None`` for a plain message."""
    image = options.image
    is_plain = image.format == "raw" or (image.format is None and not image.asks_for_picture)
    if is_plain or options.fields is not None or options.framing.content == "cdr":
        return None
    if image.format != "png" or image.max_width is not None or image.max_height is not None:
        text = 'image: a map comes as png with all of its cells: use only {"format":"png"}'
        raise ProtocolError("bad_request", text)
    return ImageOptions("png")
