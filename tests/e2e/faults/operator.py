# SPDX-License-Identifier: Apache-2.0
"""A program that drives at 20 Hz whatever it is answered, and comes back after a lost connection.

By SIGUSR1 it lets go of the stick, for 0.6 s, and pushes it again. By SIGINT it closes its
connection and ends.
"""

import json
import signal
import sys
import time

from websockets.exceptions import WebSocketException
from websockets.sync.client import connect

PERIOD_S = 0.05
LET_GO_S = 0.6


class Stick:
    """Pushed, except for a while after `let_go`."""

    def __init__(self) -> None:
        self.pushed_s = 0.0

    def let_go(self, *_: object) -> None:
        self.pushed_s = time.monotonic() + LET_GO_S

    @property
    def command(self) -> dict[str, object]:
        speed = 0.2 if time.monotonic() >= self.pushed_s else 0.0
        twist = {"linear": {"x": speed}}
        return {"op": "publish", "topic": "/cmd_vel", "type": "geometry_msgs/Twist", "msg": twist}


def drive(url: str, stick: Stick) -> None:
    # a queue that fills up would also keep pongs from a program that reads nothing
    with connect(url, proxy=None, compression=None, max_queue=None) as socket:
        while True:
            socket.send(json.dumps(stick.command))
            time.sleep(PERIOD_S)


def main() -> None:
    stick = Stick()
    stick.let_go()
    signal.signal(signal.SIGUSR1, stick.let_go)
    signal.signal(signal.SIGINT, signal.default_int_handler)
    sys.stdout.write("ready\n")  # from now on a signal does not end it
    sys.stdout.flush()
    while True:
        try:
            drive(sys.argv[1], stick)
        except (OSError, WebSocketException):
            time.sleep(PERIOD_S)
        except KeyboardInterrupt:
            return


if __name__ == "__main__":
    main()
