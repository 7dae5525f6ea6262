# SPDX-License-Identifier: Apache-2.0
import base64
import json

import cbor2
import pytest

from gateway.codec.error_text import CodecError
from gateway.codec.image import ImageOptions
from gateway.codec.picture import picture_renderer
from gateway.codec.picture_formats import PICTURE_FORMATS
from gateway.codec.types import Types
from schemas.installed import InstalledDefinitions

IMAGE = Types(InstalledDefinitions()).get("sensor_msgs/msg/Image")
HEADER = {"stamp": {"sec": 3, "nanosec": 4}, "frame_id": "camera"}


def cdr(**values) -> bytes:
    plain = {"height": 2, "width": 2, "encoding": "mono8", "step": 2, "data": [0, 85, 170, 255]}
    return IMAGE.encode({"header": HEADER, **plain, **values}, 0)


@pytest.mark.parametrize("picture_format", PICTURE_FORMATS)
def test_the_picture_is_the_same_in_json_and_cbor(picture_format):
    options = ImageOptions(picture_format)
    picture = picture_renderer(IMAGE, options)(cdr())
    plain, packed = json.loads(picture.json()), cbor2.loads(picture.cbor())
    assert plain.pop("data") == base64.b64encode(picture.data).decode()
    assert packed.pop("data") == picture.data
    assert plain == packed
    assert packed == {"header": HEADER, "format": picture_format, "width": 2, "height": 2}


def test_depth_tells_its_range():
    depth = cdr(encoding="16UC1", step=4, data=[0, 4] * 4)
    options = ImageOptions(depth_range_m=(0.5, 4.0))
    picture = picture_renderer(IMAGE, options)(depth)
    assert json.loads(picture.json())["depth_range_m"] == [0.5, 4.0]
    assert cbor2.loads(picture.cbor())["depth_range_m"] == [0.5, 4.0]


def test_data_that_is_not_an_image_raises_codec_error():
    with pytest.raises(CodecError, match="step is 1"):
        picture_renderer(IMAGE, ImageOptions())(cdr(step=1))
