# SPDX-License-Identifier: Apache-2.0
"""The formats of compressed pictures. A new one is one row here."""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final

import cv2


@dataclass(frozen=True, slots=True)
class PictureFormat:
    """A format, by the name that clients use and that `CompressedImage.format` carries."""

    name: str
    extension: str  # by which OpenCV chooses the encoder
    has_8_bits: bool  # per channel, and no more. Others keep 16 bits, and depth in millimetres
    quality_parameter: int | None = None  # of OpenCV's encoder. None: lossless

    @property
    def is_lossy(self) -> bool:
        """True if a lower quality takes fewer bytes."""
        return self.quality_parameter is not None

    def parameters(self, quality: int) -> list[int]:
        """Return what OpenCV's encoder is told for a quality of 1 to 100."""
        return [] if self.quality_parameter is None else [self.quality_parameter, quality]


_ALL: Final = (
    PictureFormat("jpeg", ".jpg", has_8_bits=True, quality_parameter=cv2.IMWRITE_JPEG_QUALITY),
    # naming a compression level turns off OpenCV's own choice, a third of the time
    PictureFormat("png", ".png", has_8_bits=False),
)
PICTURE_FORMATS: Final[Mapping[str, PictureFormat]] = MappingProxyType(
    {one.name: one for one in _ALL}
)
