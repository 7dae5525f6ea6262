# SPDX-License-Identifier: Apache-2.0
"""``python -m benchmarks.fleet [WHAT ...] [--quick]``: what a robot and relays cost.

``uplink``: bytes per second of a robot with more and more viewers, on 1 to 3 relays. ``cpu``: the
CPU time of a relay for each frame, as a ratio to that of a gateway next to the robot. ``age``: how
old messages are when they arrive over an uplink of 2 Mbit/s. ``slow``: viewers of a relay, some of
which read slowly. Every process is a real one.
"""

import argparse
import contextlib
import os
import socket
import statistics
import sys
import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Final

from benchmarks.crowds import Load, crowd_of, load
from benchmarks.errors import BenchmarkError
from benchmarks.processes import Process, acting, running, wait_until
from benchmarks.receivers import publishing
from benchmarks.samples import OFFERED_IMAGE
from benchmarks.servers import Limits, free_port, gateway_command
from benchmarks.two_networks import reason_against, two_networks

_SAMPLE: Final = "odometry"
_RATE_HZ: Final = 50.0
_RATE_FOR_MANY_HZ: Final = 10.0  # as the crowd that reads needs the other core
_LINK_BITS_PER_S: Final = 2_000_000
_SENT_HZ: Final = {"odometry": 50.0, "image": 15.0}
_WARM_UP_S: Final = 8.0
_FAR: Final = "10.78.0.2"
_SLOW_BYTES_PER_S: Final = 2000
# all viewers have one address here, which may have half of the ROS entities
_ROOM: Final = {"max_clients": 1200, "max_clients_per_address": 1200, "max_ros_entities": 2500}
_GATEWAY: Final = (sys.executable, "-m", "gateway")


@dataclass(frozen=True)
class Size:
    """The numbers of viewers, relays, rounds, and seconds."""

    viewers: tuple[int, ...]
    relays: tuple[int, ...]
    crowd: int
    rounds: int
    seconds: float


FULL: Final = Size((0, 1, 200, 1000), (1, 2, 3), 200, 3, 10.0)
QUICK: Final = Size((0, 1, 50), (1, 2), 50, 1, 3.0)


class _Counter:
    """Passes TCP connections on to a port, and counts the bytes of the robot."""

    def __init__(self, target: int) -> None:
        self.bytes = 0
        self._target = target
        self._listener = socket.create_server(("127.0.0.1", 0))
        self.port = int(self._listener.getsockname()[1])
        threading.Thread(target=self._accept, daemon=True).start()

    def per_s(self, seconds: float) -> float:
        """Return the bytes per second of the time from now on."""
        before, began_s = self.bytes, time.monotonic()
        time.sleep(seconds)
        return (self.bytes - before) / (time.monotonic() - began_s)

    def _accept(self) -> None:
        while True:
            robot, _ = self._listener.accept()
            router = socket.create_connection(("127.0.0.1", self._target))
            threading.Thread(target=self._pass, args=(robot, router, 1), daemon=True).start()
            threading.Thread(target=self._pass, args=(router, robot, 0), daemon=True).start()

    def _pass(self, source: socket.socket, sink: socket.socket, share: int) -> None:
        with contextlib.suppress(OSError):
            while data := source.recv(1 << 16):
                self.bytes += share * len(data)
                sink.sendall(data)
        sink.close()


@contextlib.contextmanager
def _router(*before: str, host: str = "127.0.0.1") -> Iterator[str]:
    address = f"tcp/{host}:{free_port()}"
    command = (*before, *_GATEWAY, "router", "--listen", address, "--open")
    with running("router", *command) as process:
        process.line_with("routing on")
        yield address


@contextlib.contextmanager
def _robot(router: str, *before: str, limits: Limits = _ROOM) -> Iterator[tuple[str, Process]]:
    """Serve the robot, also to relays. Yield its own URL."""
    uplink = ("--uplink", router, "--robot-name", "r1")
    with running("gateway", *before, *gateway_command(0, limits), *uplink) as process:
        yield process.line_with(r"ws://\S+"), process


@contextlib.contextmanager
def _relay(router: str, *before: str) -> Iterator[tuple[str, Process]]:
    """Serve the robots behind a router. Yield the URL of the robot."""
    options = [f"--set=limits.{key}={value}" for key, value in _ROOM.items()]
    command = (*before, *_GATEWAY, "relay", router, "--port", "0", *options)
    quiet = ("--log-level", "warning", "--set=relay.drain_s=0")
    with running("relay", *command, *quiet) as process:
        url = process.line_with(r"ws://\S+")
        time.sleep(_WARM_UP_S)  # until it has found the robot
        yield f"{url}r1/", process


def uplink(size: Size) -> None:
    """Measure the uplink. It must not depend on the number of viewers or relays."""
    print(f"{_SAMPLE} at {_RATE_HZ:g} Hz: the robot's uplink")
    print(f"  {'relays':>6}{'viewers':>9}{'uplink kB/s':>13}")
    with _router() as router:
        counter = _Counter(int(router.rpartition(":")[2]))
        with publishing(_SAMPLE, _RATE_HZ), _robot(f"tcp/127.0.0.1:{counter.port}"):
            for relays in size.relays:
                with contextlib.ExitStack() as stack:
                    urls = [stack.enter_context(_relay(router))[0] for _ in range(relays)]
                    for viewers in size.viewers:
                        _uplink_of(counter, urls, viewers, size.seconds)


def _uplink_of(counter: _Counter, urls: list[str], viewers: int, seconds: float) -> None:
    with contextlib.ExitStack() as stack:
        for number, url in enumerate(urls):
            some = viewers // len(urls) + (number < viewers % len(urls))
            if some:
                crowd = stack.enter_context(crowd_of(url, _SAMPLE, some))
                _wait(crowd, some)
        time.sleep(2.0)
        print(f"  {len(urls):6}{viewers:9}{counter.per_s(seconds) / 1000:13.1f}", flush=True)


def cpu(size: Size) -> None:
    """Compare a relay with a gateway next to the robot. The aim is a ratio of at most 1.2."""
    print(f"{_SAMPLE} at {_RATE_HZ:g} Hz to {size.crowd} viewers: CPU time of the server")
    ratios = []
    with contextlib.ExitStack() as stack:
        router = stack.enter_context(_router())
        stack.enter_context(publishing(_SAMPLE, _RATE_HZ))
        stack.enter_context(_robot(router))
        served = {
            # another gateway: the robot's own also has the work of the uplink
            "gateway": stack.enter_context(_direct()),
            "relay": stack.enter_context(_relay(router)),
        }
        for _ in range(size.rounds):
            loads: dict[str, Load] = {}
            for name, (url, process) in served.items():
                with crowd_of(url, _SAMPLE, size.crowd) as crowd:
                    loads[name] = load(crowd, process, size.crowd, size.seconds)
                print(f"  {name:10}{loads[name].us_per_frame:8.1f} us per frame", flush=True)
            ratios.append(loads["relay"].us_per_frame / loads["gateway"].us_per_frame)
    print(f"  relay / gateway: {statistics.median(ratios):.2f}")


@contextlib.contextmanager
def _direct() -> Iterator[tuple[str, Process]]:
    with running("direct", *gateway_command(0, _ROOM), "--node-prefix", "direct") as process:
        yield process.line_with(r"ws://\S+"), process


def age(size: Size) -> None:
    """Measure ages over a shaped link, which needs root."""
    print(f"age over an uplink of {_LINK_BITS_PER_S / 1e6:g} Mbit/s, and without a relay")
    reason = reason_against()
    if reason is not None:
        print(f"  SKIPPED: {reason}")
        return
    with two_networks() as networks, contextlib.ExitStack() as stack:
        networks.shape(_LINK_BITS_PER_S)
        for name, rate_hz in _SENT_HZ.items():
            stack.enter_context(publishing(name, rate_hz, before=networks.near))
        router = stack.enter_context(_router(*networks.far, host=_FAR))
        open_to_all = ("--host", networks.url_host, "--no-auth")
        gateway = (*networks.near, *gateway_command(0), "--uplink", router, "--robot-name", "r1")
        robot = stack.enter_context(running("gateway", *gateway, *open_to_all))
        direct = robot.line_with(r"ws://\S+")
        url, _ = stack.enter_context(_relay(router, *networks.far))
        offered = ("odometry", OFFERED_IMAGE)
        for where, one, names in (("relay", url, offered), ("direct", direct, tuple(_SENT_HZ))):
            with acting("client", one, *names, before=networks.far) as client:
                client.answer()
                time.sleep(_WARM_UP_S)
                client.ask("clear")
                time.sleep(2 * size.seconds)
                for name, seen in client.ask("report").items():
                    rate_hz = seen["count"] / (2 * size.seconds)
                    ages = "".join(f"{seen.get(each, -1):8.0f} ms" for each in ("p50_ms", "p99_ms"))
                    print(f"  {where:8}{name:18}{rate_hz:6.1f} Hz, p50 and p99{ages}", flush=True)


def slow(size: Size) -> None:
    """Let a few viewers read slowly. The others must get every message."""
    viewers = size.viewers[-1]
    few = max(1, viewers // 100)
    print(f"{viewers} viewers of a relay, and {few} that read {_SLOW_BYTES_PER_S} bytes/s")
    with contextlib.ExitStack() as stack:
        router = stack.enter_context(_router())
        stack.enter_context(publishing(_SAMPLE, _RATE_FOR_MANY_HZ))
        stack.enter_context(_robot(router))
        url, process = stack.enter_context(_relay(router))
        for _ in range(few):
            slow_reader = ("slow_reader", url, _SLOW_BYTES_PER_S, _SAMPLE)
            stack.enter_context(acting(*slow_reader)).answer()
        crowd = stack.enter_context(crowd_of(url, _SAMPLE, viewers))
        _wait(crowd, viewers)
        client = stack.enter_context(acting("client", url, _SAMPLE))
        client.answer()
        seen = load(crowd, process, viewers, size.seconds)
        client.ask("clear")
        time.sleep(size.seconds)
        ages = client.ask("report")[_SAMPLE]
    share = seen.frames_per_s / (viewers * _RATE_FOR_MANY_HZ)
    print(f"  {share:.0%} of all messages arrive, CPU {seen.core_share:.0%} of a core")
    print(f"  age of one viewer: p50 {ages['p50_ms']:.1f} ms, p99 {ages['p99_ms']:.1f} ms")


def _wait(crowd: Process, viewers: int) -> None:
    wait_until(lambda: bool(crowd.ask("clients") == viewers), f"{viewers} viewers get frames")


_PARTS: Final[dict[str, Callable[[Size], None]]] = {
    "uplink": uplink,
    "cpu": cpu,
    "age": age,
    "slow": slow,
}


def main() -> None:
    """Measure what the command line names, or all."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.fleet", description=__doc__)
    parser.add_argument("what", nargs="*", metavar="WHAT", help=f"of {', '.join(_PARTS)}")
    parser.add_argument("--quick", action="store_true", help="fewer viewers, relays and rounds")
    options = parser.parse_args()
    if unknown := set(options.what) - set(_PARTS):
        parser.error(f"unknown WHAT: {', '.join(unknown)}")
    os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
    os.environ["ROS_DOMAIN_ID"] = str(1 + os.getpid() % 100)
    for name in options.what or _PARTS:
        try:
            _PARTS[name](QUICK if options.quick else FULL)
        except BenchmarkError as error:
            sys.exit(f"{name}: {error}")


if __name__ == "__main__":
    main()
