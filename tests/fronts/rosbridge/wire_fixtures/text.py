# SPDX-License-Identifier: Apache-2.0
"""Frames and pages as readable lines."""

import base64
import hashlib
import re
from typing import Final

import cbor2
import cv2
import numpy as np
from websockets.frames import Frame, Opcode

OPENCV: Final = f"# OpenCV {cv2.__version__}"
_MAX_CHARACTERS: Final = 4000  # of a line. Of a longer frame it has the beginning and the hash
_MAX_HEX_BYTES: Final = 512

_PICTURE: Final = re.compile(rb"\x89PNG.*?IEND\xaeB`\x82|\xff\xd8\xff.*?\xff\xd9", re.DOTALL)
_BASE64_PICTURE: Final = re.compile(r"(?:iVBORw0KGgo|/9j/)[A-Za-z0-9+/]+=*")
_BASE64_PIECE: Final = re.compile(r"[A-Za-z0-9+/]{40,}=*")
_MASKED: Final = re.compile(r"<[^<>]*sha256:[0-9a-f]*>")


def shown(frame: Frame) -> str:
    """Return a frame, after the name of the client and ``<``."""
    data = bytes(frame.data)
    if frame.opcode is Opcode.TEXT:
        text = data.decode()
        if text.startswith('{"op":"fragment"'):
            text = _BASE64_PIECE.sub(lambda found: f"<{_hash(found[0].encode())}>", text)
        return f" {shortened(_BASE64_PICTURE.sub(_masked_base64, text))}"
    assert frame.opcode is Opcode.BINARY
    if found := _PICTURE.search(data):
        before, after = data[: found.start()].hex(), data[found.end() :].hex()
        return f"cbor {before} {_masked(found[0])} {after}"
    octets = data.hex() if len(data) <= _MAX_HEX_BYTES else _hash(data)
    return f"cbor {shortened(repr(cbor2.loads(data)))} = {octets}"


def shown_bytes(data: bytes) -> str:
    """Return a part of an HTTP response on one line."""
    text = _PICTURE.sub(lambda found: _masked(found[0]).encode(), data).decode()
    return text.replace("\r", "␍").replace("\n", "␊")


def comparable(recording: str) -> str:
    """Leave out what another version of OpenCV encodes in another way."""
    is_of_this = OPENCV in recording or "# OpenCV" not in recording
    return recording if is_of_this else re.sub("# OpenCV.*", OPENCV, _MASKED.sub("<>", recording))


def shortened(text: str) -> str:
    """Return a text on one line, or the beginning and the hash of a long one."""
    if len(text) > _MAX_CHARACTERS:
        text = f"{text[:400]} ... {len(text)} characters {_hash(text.encode())}"
    return text.replace("\n", "␊")


def _masked_base64(found: "re.Match[str]") -> str:
    return _masked(base64.b64decode(found[0]))


def _masked(picture: bytes) -> str:
    """Return the size of a picture and the hash of its bytes."""
    pixels = cv2.imdecode(np.frombuffer(picture, np.uint8), cv2.IMREAD_UNCHANGED)
    assert pixels is not None
    height, width = pixels.shape[:2]
    kind = "png" if picture.startswith(b"\x89") else "jpeg"
    return f"<{kind} of {width}x{height} {_hash(picture)}>"


def _hash(data: bytes) -> str:
    return f"sha256:{hashlib.sha256(data).hexdigest()}"
