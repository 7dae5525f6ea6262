# SPDX-License-Identifier: Apache-2.0
"""A WebSocket server that does what a test says, in a thread."""

import contextlib
import threading
from collections.abc import Callable, Iterator

from websockets.sync.server import ServerConnection, serve


@contextlib.contextmanager
def serving(handler: Callable[[ServerConnection], object]) -> Iterator[str]:
    """Call *handler* with each connection. Yield the address."""

    def handle(connection: ServerConnection) -> None:
        handler(connection)

    with serve(handle, "127.0.0.1", 0, compression=None) as server:
        thread = threading.Thread(target=server.serve_forever)
        thread.start()
        try:
            yield f"ws://127.0.0.1:{server.socket.getsockname()[1]}"
        finally:
            server.shutdown()
            thread.join()
