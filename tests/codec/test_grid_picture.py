# SPDX-License-Identifier: Apache-2.0
import base64
import json
from typing import Any

import cbor2
import cv2
import numpy as np
import pytest

from gateway.codec.error_text import CodecError
from gateway.codec.grid_picture import GRID, grid_renderer
from gateway.codec.types import Types
from schemas.installed import InstalledDefinitions

TYPE = Types(InstalledDefinitions()).get(GRID)
HEADER = {"stamp": {"sec": 3, "nanosec": 4}, "frame_id": "map"}


def cdr(width: int, height: int, cells: list[int]) -> bytes:
    info = {"width": width, "height": height, "resolution": 0.05}
    return TYPE.encode({"header": HEADER, "info": info, "data": cells}, 0)


def cells_of(png: bytes) -> Any:
    return cv2.imdecode(np.frombuffer(png, np.uint8), cv2.IMREAD_UNCHANGED)


@pytest.mark.parametrize("cells", [[-1, 0, 100, 50, -1, 7], [-1, 0, 100, 50, -1, 7] * 500])
def test_each_pixel_is_the_octet_of_its_cell(cells: list[int]):
    sample = cdr(3, len(cells) // 3, cells)
    message = json.loads(grid_renderer(TYPE)(sample).json())
    pixels = cells_of(base64.b64decode(message["data"]))
    assert (pixels.dtype, pixels.ndim) == (np.uint8, 2)
    assert pixels.astype(np.int8).tolist() == np.array(cells).reshape(-1, 3).tolist()
    assert pixels[0].tolist() == [255, 0, 100]


def test_the_picture_comes_with_the_other_fields_of_the_message():
    sample = cdr(2, 1, [0, 100])
    plain = json.loads(json.dumps(TYPE.decode(sample), default=float))
    message = json.loads(grid_renderer(TYPE)(sample).json())
    assert list(message) == ["header", "info", "format", "data", "width", "height"]
    assert message["header"] == plain["header"]
    assert message["info"] == plain["info"] | {"resolution": 0.05}
    assert (message["format"], message["width"], message["height"]) == ("png", 2, 1)


def test_cbor_has_the_bytes_of_the_picture_and_the_info_of_plain_cbor():
    sample = cdr(2, 1, [0, 100])
    message = cbor2.loads(grid_renderer(TYPE)(sample).cbor())
    assert (
        base64.b64encode(message["data"]).decode()
        == json.loads(grid_renderer(TYPE)(sample).json())["data"]
    )
    assert message["info"] == cbor2.loads(TYPE.transcoder()(sample))["info"]


@pytest.mark.parametrize(
    ("sample", "reason"),
    [
        (cdr(2, 2, [0]), "grid has 1 cells, expected 2 x 2"),
        (cdr(1, 1, [0, 1]), "grid has 2 cells, expected 1 x 1"),
        (cdr(0, 0, []), "grid has no cells"),
        (cdr(0, 5, []), "grid has no cells"),
        (cdr(1_000_001, 1, [0] * 1_000_001), "refused a grid of 1000001x1 cells"),
        (cdr(2, 1, [0, 1])[:-1], "need 2 bytes"),
    ],
)
def test_a_map_without_a_picture_raises_codec_error(sample: bytes, reason: str):
    with pytest.raises(CodecError, match=reason):
        grid_renderer(TYPE)(sample)
