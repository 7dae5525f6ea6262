# SPDX-License-Identifier: Apache-2.0
"""A client at the far end of a link, which does nothing by itself: ``URL TOPIC``, ``-`` for none.

It writes a line when it is connected and has heard the topic, and ends when its input does.
"""

import json
import sys

from websockets.sync.client import connect


def main(url: str, topic: str) -> None:
    with connect(
        url, max_size=None, open_timeout=60, ping_interval=None, close_timeout=0
    ) as socket:
        if topic != "-":
            socket.send(json.dumps({"op": "subscribe", "topic": topic, "type": "std_msgs/String"}))
            socket.recv()
        sys.stdout.write("ready\n")
        sys.stdout.flush()
        sys.stdin.read()


if __name__ == "__main__":
    main(*sys.argv[1:])
