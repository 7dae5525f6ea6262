# SPDX-License-Identifier: Apache-2.0
"""``python -m benchmarks [WHAT ...]``: measure the gateway beside the floor.

Of ``odometry`` and ``image`` both receive from the same publisher in alternating rounds; figures
are medians. CPU time is user and system time of the whole process, from the operating system.
``codec`` measures what rendering costs, as JSON and as CBOR, ``unity`` what the Unity client does.
"""

import argparse
import os
import statistics
import time
from collections.abc import Callable

from benchmarks import codec, unity
from benchmarks.processes import Receipt, line_with, receive, running

RATES_HZ = {"odometry": 1000.0, "image": 30.0}
WHAT = (*RATES_HZ, "codec", "unity")


def main() -> None:
    """Run what the command line names."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    parser.add_argument("what", nargs="*", default=list(WHAT), choices=WHAT)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--seconds", type=float, default=8.0, help="of each measurement")
    arguments = parser.parse_args()
    os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
    os.environ["ROS_DOMAIN_ID"] = str(1 + os.getpid() % 100)
    for name in arguments.what:
        if name == "codec":
            codec.main()
        elif name == "unity":
            unity.main()
        else:
            _measure(name, arguments.rounds, arguments.seconds)


def _measure(name: str, rounds: int, seconds: float) -> None:
    rate_hz = RATES_HZ[name]
    floors: list[Receipt] = []
    gateways: list[Receipt] = []
    with running("benchmarks.publisher", name, str(rate_hz)):
        for _ in range(rounds):
            floors.append(_floor(name, seconds))
            gateways.append(_gateway(name, seconds))
    print(f"\n{name} at {rate_hz:g} Hz, one client; medians of {rounds} rounds of {seconds:g} s")
    print(f"{'':24}{'floor':>12}{'gateway':>12}{'ratio':>8}")
    rows: dict[str, Callable[[Receipt], float]] = {
        "received per second": lambda receipt: receipt.rate_hz,
        "CPU us per message": lambda receipt: receipt.cpu_us_per_message,
        "latency p50 ms": lambda receipt: receipt.p50_ms,
        "latency p99 ms": lambda receipt: receipt.p99_ms,
    }
    for title, figure in rows.items():
        floor = statistics.median(map(figure, floors))
        gateway = statistics.median(map(figure, gateways))
        print(f"{title:24}{floor:12.3f}{gateway:12.3f}{gateway / floor:8.2f}")
    if name == "image":
        _prepare_as_the_gateway_does()
        encoder_us = _encoder_us()
        cpu_us = statistics.median(receipt.cpu_us_per_message for receipt in gateways)
        own_us = _rendering_us()
        print(f"JPEG encoder alone      {encoder_us:12.1f} us of CPU")
        print(f"  share of CDR to frame {encoder_us / own_us:12.1%} of {own_us:.1f} us")
        print(f"  share of the process  {encoder_us / cpu_us:12.1%}, reception by DDS included")


def _floor(name: str, seconds: float) -> Receipt:
    with running("benchmarks.floor", name) as process:
        return receive(process, process.pid, seconds)


def _gateway(name: str, seconds: float) -> Receipt:
    with running("gateway", "serve", "--port", "0", "--log-level", "warning") as gateway:
        url = line_with(gateway, r"ws://\S+")
        with running("benchmarks.client", url, f"/benchmark/{name}") as client:
            return receive(client, gateway.pid, seconds)


def _prepare_as_the_gateway_does() -> None:
    from gateway.codec.image import confine_to_calling_thread
    from gateway.memory import keep_large_blocks

    keep_large_blocks()
    confine_to_calling_thread()


def _encoder_us() -> float:
    """Return the CPU time of cv2.imencode for the picture that is published."""
    import cv2
    import numpy as np

    from benchmarks.samples import image

    message = image()
    rgb = np.frombuffer(message.data, np.uint8).reshape(message.height, message.width, 3)
    bgr = cv2.cvtColor(rgb, cv2.COLOR_RGB2BGR)
    return _cpu_us(lambda: cv2.imencode(".jpg", bgr, [cv2.IMWRITE_JPEG_QUALITY, 80]))


def _rendering_us() -> float:
    """Return the CPU time of everything between the CDR of the picture and the JSON frame."""
    from benchmarks.samples import cdr
    from gateway.codec.image import ImageOptions
    from gateway.codec.picture import picture_renderer
    from gateway.codec.types import Types
    from schemas.installed import InstalledDefinitions

    image_type = Types(InstalledDefinitions()).get("sensor_msgs/msg/Image")
    render = picture_renderer(image_type, ImageOptions())
    sample = bytes(cdr("image"))
    return _cpu_us(lambda: render(sample))


def _cpu_us(work: Callable[[], object], repeats: int = 60) -> float:
    durations = []
    for _ in range(repeats):
        time.sleep(1 / RATES_HZ["image"])  # caches are as cold as between two pictures
        started = time.thread_time_ns()
        work()
        durations.append((time.thread_time_ns() - started) / 1000)
    return statistics.median(durations)


if __name__ == "__main__":
    main()
