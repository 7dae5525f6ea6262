# SPDX-License-Identifier: Apache-2.0
"""The JPEG encoder's share of a picture's cost, which only a faster encoder lowers."""

import statistics
import time
from collections.abc import Callable

import cv2
import numpy as np

from benchmarks.samples import SAMPLES
from gateway.codec.image import ImageOptions, confine_to_calling_thread
from gateway.codec.picture import picture_renderer
from gateway.codec.types import Types
from gateway.memory import keep_large_blocks
from schemas.installed import InstalledDefinitions

_REPEATS = 60


def encoder_share(cpu_us: float) -> str:
    """Format the encoder's share of the rendering, and of *cpu_us*, a picture's whole cost."""
    keep_large_blocks()
    confine_to_calling_thread()
    encoder_us = _encoder_us()
    rendering_us = _rendering_us()
    return (
        f"JPEG encoder: {encoder_us:.0f} us of CPU, {encoder_us / rendering_us:.0%} of the way "
        f"from CDR to frame, {encoder_us / cpu_us:.0%} of the process with reception by DDS"
    )


def _encoder_us() -> float:
    """Return the CPU time of cv2.imencode for the published picture."""
    message = SAMPLES["image"].make()
    rgb = np.frombuffer(message.data, np.uint8).reshape(message.height, message.width, 3)
    bgr = cv2.cvtColor(rgb, cv2.COLOR_RGB2BGR)
    return _cpu_us(lambda: cv2.imencode(".jpg", bgr, [cv2.IMWRITE_JPEG_QUALITY, 80]))


def _rendering_us() -> float:
    """Return the CPU time of everything between the CDR of the picture and the JSON frame."""
    image_type = Types(InstalledDefinitions()).get("sensor_msgs/msg/Image")
    render = picture_renderer(image_type, ImageOptions())
    sample = bytes(SAMPLES["image"].cdr())
    return _cpu_us(lambda: render(sample).json())


def _cpu_us(work: Callable[[], object]) -> float:
    durations = []
    for _ in range(_REPEATS):
        time.sleep(1 / SAMPLES["image"].rate_hz)  # caches are as cold as between two pictures
        started = time.thread_time_ns()
        work()
        durations.append((time.thread_time_ns() - started) / 1000)
    return statistics.median(durations)
