# SPDX-License-Identifier: Apache-2.0
"""A client that drives, and another connection of it that stops: ``URL`` as argument.

Orders: ``drive SECONDS`` sends commands, each of another speed, and answers with these and the
reasons of refusals. ``stop NUMBER`` answers with the milliseconds that each stop has taken.
"""

import contextlib
import json
import sys
import threading
import time
from typing import Any, Final

from benchmarks.actors.connection import RawConnection
from benchmarks.actors.orders import obey, reply

_PERIOD_S: Final = 0.05
_STEP: Final = 1e-6  # by which two speeds differ
_STOP_PERIOD_S: Final = 0.1


class _Stick:
    def __init__(self, connection: RawConnection) -> None:
        self._connection = connection
        self._refusals: list[str] = []
        self._sent = 0

    def drive(self, seconds: str) -> dict[str, Any]:
        """Let go, and push for some seconds."""
        self._push(0.0)
        time.sleep(0.5)
        self._refusals.clear()
        end_s = due_s = time.monotonic() + float(seconds)
        due_s = time.monotonic()
        speeds = []
        while due_s < end_s:
            self._sent += 1
            speeds.append(0.1 + self._sent * _STEP)
            self._push(speeds[-1])
            due_s += _PERIOD_S
            time.sleep(max(0.0, due_s - time.monotonic()))
        return {"speeds": speeds, "refusals": sorted(set(self._refusals))}

    def listen(self) -> None:
        """Note why commands are refused."""
        with contextlib.suppress(ConnectionError):
            while True:
                for payload in self._connection.receive():
                    frame = json.loads(bytes(payload))
                    if frame["op"] == "status":
                        self._refusals.append(frame.get("code", frame["msg"]))

    def _push(self, speed: float) -> None:
        self._connection.send(
            {
                "op": "publish",
                "topic": "/cmd_vel",
                "type": "geometry_msgs/Twist",
                "msg": {"linear": {"x": speed}},
            }
        )


class _Watcher:
    def __init__(self, connection: RawConnection) -> None:
        self._connection = connection
        self._answered = threading.Event()

    def stop(self, number: str) -> list[float]:
        """Stop the robot so many times."""
        took_ms = []
        for _ in range(int(number)):
            time.sleep(_STOP_PERIOD_S)
            self._answered.clear()
            start_s = time.perf_counter()
            self._connection.send({"op": "stop"})
            self._answered.wait()
            took_ms.append((time.perf_counter() - start_s) * 1e3)
        return took_ms

    def listen(self) -> None:
        """Hear the answers."""
        with contextlib.suppress(ConnectionError):
            while True:
                for payload in self._connection.receive():
                    if b'"op":"stop"' in bytes(payload):
                        self._answered.set()


def main(url: str) -> None:
    """Do as ordered until the end of stdin."""
    with RawConnection(url) as driving, RawConnection(url) as watching:
        stick, watcher = _Stick(driving), _Watcher(watching)
        for listen in (stick.listen, watcher.listen):
            threading.Thread(target=listen, daemon=True).start()
        is_over = threading.Event()
        obey({"drive": stick.drive, "stop": watcher.stop}, is_over.set)
        reply("ready")
        is_over.wait()


if __name__ == "__main__":
    main(*sys.argv[1:])
