# SPDX-License-Identifier: Apache-2.0
"""A client at the far end of a slow link: writes what its frames say of themselves, as JSON lines.

``URL PICTURES`` as arguments: it ends after so many pictures. It asks for them once it has heard
odometry, for the two begin to be published whenever their processes have started.
"""

import json
import sys

from websockets.sync.client import ClientConnection, connect


def main(url: str, pictures: int) -> None:
    with connect(url, max_size=None, open_timeout=60) as socket:
        _subscribe(socket, "/benchmark/odometry")
        hears_odometry = False
        while pictures:
            frame = json.loads(socket.recv())
            if frame["op"] != "publish":
                continue
            if not hears_odometry:
                _subscribe(socket, "/benchmark/image")
                hears_odometry = True
            message = frame.pop("msg")
            pictures -= "width" in message
            sys.stdout.write(json.dumps({**frame, "width": message.get("width")}) + "\n")


def _subscribe(socket: ClientConnection, topic: str) -> None:
    socket.send(json.dumps({"op": "subscribe", "topic": topic, "meta": True}))


if __name__ == "__main__":
    main(sys.argv[1], int(sys.argv[2]))
