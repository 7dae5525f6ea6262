# SPDX-License-Identifier: Apache-2.0
"""The cost of rendering: from the CDR of a message to its JSON and CBOR, and to these deflated."""

import statistics
import time
import zlib
from collections.abc import Callable
from typing import Final

import numpy as np

from benchmarks.figures import Figure
from benchmarks.plan import Plan
from gateway.codec.json import dumps
from gateway.codec.types import MessageType, Types
from schemas.installed import InstalledDefinitions

_SCENARIO: Final = "codec"
_REPEATS = 15
_BATCH_S = 0.05

_SCAN = {"ranges": np.linspace(0.1, 3.5, 720).tolist(), "intensities": [47.0] * 720}
_CLOUD = {
    "height": 240,
    "width": 320,
    "point_step": 16,
    "row_step": 5120,
    "data": np.random.default_rng(1).bytes(1_228_800),
}
_MESSAGES = {
    "nav_msgs/msg/Odometry": {},
    "sensor_msgs/msg/LaserScan": _SCAN,
    "sensor_msgs/msg/PointCloud2": _CLOUD,
}
_CHANCE = np.random.default_rng(1)
_POSE = {"position": {"x": 1.2345678901234, "y": -0.87}, "orientation": {"z": 0.6, "w": 0.8}}
_STAMPED = {"header": {"frame_id": "odom"}, "child_frame_id": "base_footprint"}
# with the noise of real sensors and filters, which does not repeat itself
_LIVELY = {
    "nav_msgs/msg/Odometry": _STAMPED
    | {
        "pose": {"pose": _POSE, "covariance": _CHANCE.normal(0, 1e-3, 36).tolist()},
        "twist": {"covariance": _CHANCE.normal(0, 1e-3, 36).tolist()},
    },
    "sensor_msgs/msg/LaserScan": {
        "ranges": np.round(2 + _CHANCE.normal(0, 0.5, 720), 3).tolist(),
        "intensities": _CHANCE.integers(20, 60, 720).tolist(),
    },
    "geometry_msgs/msg/TransformStamped": _STAMPED
    | {"transform": {"translation": _POSE["position"], "rotation": _POSE["orientation"]}},
}


def measure(_: Plan) -> list[Figure]:
    """Print a table and return the figures."""
    figures: list[Figure] = []
    types = Types(InstalledDefinitions())
    print(f"{'CDR to':28}{'JSON us':>10}{'bytes':>10}{'CBOR us':>10}{'bytes':>10}{'ratio':>8}")
    for name, values in _MESSAGES.items():
        message_type = types.get(name)
        cdr = message_type.encode(values, now_ns=0)
        json_us, json_bytes = _cost(_as_json(message_type), cdr)
        cbor_us, cbor_bytes = _cost(message_type.transcoder(), cdr)
        print(
            f"{name:28}{json_us:10.1f}{json_bytes:10}{cbor_us:10.1f}{cbor_bytes:10}"
            f"{cbor_us / json_us:8.2f}"
        )
        figures += [
            Figure(_SCENARIO, f"{name}, as JSON", json_us, "us"),
            Figure(_SCENARIO, f"{name}, as CBOR", cbor_us, "us"),
        ]
    return figures + _measure_deflate(types)


def _measure_deflate(types: Types) -> list[Figure]:
    """Deflate as permessage-deflate would, for all clients at once: each message by itself."""
    figures: list[Figure] = []
    print(f"\n{'deflate, level 1':36}{'JSON':>10}{'us':>10}{'bytes':>10}{'CBOR':>10}{'bytes':>10}")
    for name, values in _LIVELY.items():
        message_type = types.get(name)
        cdr = message_type.encode(values, now_ns=1_700_000_000_123_456_789)
        text, binary = _as_json(message_type)(cdr), message_type.transcoder()(cdr)
        us, deflated = _cost(_deflate, text)
        print(
            f"{name:36}{len(text):10}{us:10.1f}{deflated:10}"
            f"{len(binary):10}{len(_deflate(binary)):10}"
        )
        figures.append(Figure(_SCENARIO, f"{name}, deflating JSON", us, "us"))
    return figures


def _deflate(data: bytes) -> bytes:
    deflater = zlib.compressobj(1, wbits=-15)
    return deflater.compress(data) + deflater.flush(zlib.Z_SYNC_FLUSH)


def _as_json(message_type: MessageType) -> Callable[[bytes], bytes]:
    decode = message_type.decode
    return lambda cdr: dumps(decode(cdr))


def _cost(render: Callable[[bytes], bytes], cdr: bytes) -> tuple[float, int]:
    """Return the CPU time of one message in microseconds, and the bytes of its rendering."""
    size = len(render(cdr))
    started = time.thread_time()
    render(cdr)
    count = max(1, round(_BATCH_S / max(time.thread_time() - started, 1e-6)))
    durations = []
    for _ in range(_REPEATS):
        started = time.thread_time()
        for _ in range(count):
            render(cdr)
        durations.append((time.thread_time() - started) / count)
    return statistics.median(durations) * 1e6, size
