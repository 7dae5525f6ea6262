# SPDX-License-Identifier: Apache-2.0
"""A client at the far end of a slow link: writes what its frames say of themselves, as JSON lines.

``URL PICTURES`` as arguments: it ends after so many pictures.
"""

import json
import sys

from websockets.sync.client import connect


def main(url: str, pictures: int) -> None:
    with connect(url, max_size=None, open_timeout=60) as socket:
        for topic in ("/benchmark/odometry", "/benchmark/image"):
            socket.send(json.dumps({"op": "subscribe", "topic": topic, "meta": True}))
        while pictures:
            frame = json.loads(socket.recv())
            if frame["op"] != "publish":
                continue
            message = frame.pop("msg")
            pictures -= "width" in message
            sys.stdout.write(json.dumps({**frame, "width": message.get("width")}) + "\n")


if __name__ == "__main__":
    main(sys.argv[1], int(sys.argv[2]))
