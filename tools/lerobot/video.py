# SPDX-License-Identifier: Apache-2.0
"""The videos of one camera: H.264 in MP4 files, each with the images of several episodes."""

from fractions import Fraction
from pathlib import Path
from typing import Any, Final

import av
import cv2
from numpy.typing import NDArray

FILE_BYTES: Final = 200 * 1024**2  # an episode begins the next file from this size on

# Every second image can be decoded alone, because training reads at random.
_OPTIONS: Final = {
    "crf": "23",
    "g": "2",
    "bf": "0",
    "colorspace": "smpte170m",
    "color_range": "tv",
}


class VideoFiles:
    """Writes images, in the order of their ticks."""

    def __init__(self, folder: Path, fps: int) -> None:
        self._folder = folder
        self._fps = fps
        self._number = -1
        self._frames = self._bytes = 0  # of the open file
        self._container: Any = None
        self._stream: Any = None

    def begin_episode(self, size: tuple[int, int]) -> tuple[int, float]:
        """Return the number of the file that gets the next images, and their time in it."""
        if self._container is None or self._bytes >= FILE_BYTES:
            self.finish()
            self._number += 1
            self._frames = self._bytes = 0
            self._folder.mkdir(parents=True, exist_ok=True)
            self._container = av.open(self._folder / f"file-{self._number:03d}.mp4", "w")
            self._stream = self._container.add_stream("libx264", self._fps, options=_OPTIONS)
            self._stream.height, self._stream.width = size
            self._stream.pix_fmt = "yuv420p"
        return self._number, self._frames / self._fps

    def add(self, pixels: NDArray[Any]) -> None:
        """Add an image, which is BGR."""
        # OpenCV converts to BT.601 more exactly than FFmpeg
        yuv = cv2.cvtColor(pixels, cv2.COLOR_BGR2YUV_I420)
        frame = av.VideoFrame.from_ndarray(yuv, format="yuv420p")
        frame.pts = self._frames
        frame.time_base = Fraction(1, self._fps)
        self._write(self._stream.encode(frame))
        self._frames += 1

    def finish(self) -> None:
        """Complete the open file."""
        if self._container is not None:
            self._write(self._stream.encode())
            self._container.close()

    def _write(self, packets: list[Any]) -> None:
        self._container.mux(packets)
        self._bytes += sum(packet.size for packet in packets)
