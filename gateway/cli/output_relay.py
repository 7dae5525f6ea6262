# SPDX-License-Identifier: Apache-2.0
"""A process that takes what libraries write, at any time, and hands it on when the gateway reads.

C code may hold the GIL while it writes. If a thread of the same process read the pipe, such code
would wait forever once the pipe is full. This process reads the pipe instead, and keeps what the
gateway does not take yet. Standard input closes when the gateway ends, however that happens. Then
this process hands on the rest in the pipes and ends, even if children of the gateway live on.

Run as a script: it imports nothing that is not needed, and nothing of the gateway.
"""

import os
import select
import signal
import sys

MAX_WAITING_BYTES = 1024**2  # about 10,000 lines while the gateway is busy with something else
_CHUNK_BYTES = 65536  # all that a pipe holds
_STDIN = 0


class Channel:
    """A pipe that is read, and one that is written to when there is room."""

    def __init__(self, source: int, sink: int) -> None:
        for descriptor in (source, sink):
            os.set_blocking(descriptor, False)
        self._source: int | None = source
        self._sink: int | None = sink
        self._waiting = bytearray()
        self._lost = 0

    @property
    def is_open(self) -> bool:
        """Return whether something is still to be handed on."""
        return self._sink is not None

    def interests(self) -> dict[int, int]:
        """Return for each descriptor the events that matter now."""
        found = {}
        if self._source is not None:
            found[self._source] = select.POLLIN
        if self._sink is not None:
            found[self._sink] = select.POLLOUT if self._waiting else 0  # POLLERR always comes
        return found

    def handle(self, events: dict[int, int]) -> None:
        """Read and write what is possible without waiting."""
        if self._source is not None and events.get(self._source):
            self._take(self._source)
        if self._sink is not None:
            event = events.get(self._sink, 0)
            if event & select.POLLERR:  # nobody reads
                self._close()
            elif event & select.POLLOUT:
                self._give(self._sink)
        self._close_if_done()

    def finish(self) -> None:
        """Take what has been written until now, and nothing that comes later."""
        if self._source is not None:
            self._take(self._source)
        self._close_source()
        self._close_if_done()

    def _take(self, source: int) -> None:
        try:
            data = os.read(source, _CHUNK_BYTES)
        except BlockingIOError:
            return
        if not data:
            self._close_source()
        elif len(self._waiting) + len(data) > MAX_WAITING_BYTES:
            self._lost += len(data)
        else:
            self._say_what_is_lost()
            self._waiting += data

    def _give(self, sink: int) -> None:
        try:
            del self._waiting[: os.write(sink, self._waiting[:_CHUNK_BYTES])]
        except OSError:  # no room, or no reader, which is the next event
            return

    def _say_what_is_lost(self) -> None:
        if self._lost:
            self._waiting += b"\n%d bytes are missing here\n" % self._lost
            self._lost = 0

    def _close_if_done(self) -> None:
        if self._source is None and not self._waiting:
            self._close()

    def _close_source(self) -> None:
        if self._source is not None:
            self._say_what_is_lost()
            os.close(self._source)
            self._source = None

    def _close(self) -> None:
        self._close_source()
        if self._sink is not None:
            os.close(self._sink)
            self._sink = None


def relay(*pairs: tuple[int, int], until_closed: int = _STDIN) -> None:
    """Hand on what comes from the first descriptor of each pair to the second.

    Until nobody can write any more, nobody reads any more, or *until_closed* ends.
    """
    channels = [Channel(source, sink) for source, sink in pairs]
    is_finishing = False
    while channels:
        poll = select.poll()
        if not is_finishing:
            poll.register(until_closed, select.POLLIN)
        for channel in channels:
            for descriptor, events in channel.interests().items():
                poll.register(descriptor, events)
        ready = dict(poll.poll())
        for channel in channels:
            channel.handle(ready)
        if until_closed in ready:
            is_finishing = True
            for channel in channels:
                channel.finish()
        channels = [channel for channel in channels if channel.is_open]


if __name__ == "__main__":
    # those are for the gateway, whose last lines are still to come
    for name in ("INT", "TERM", "QUIT", "USR1", "USR2", "XCPU", "HUP"):
        signal.signal(getattr(signal, f"SIG{name}"), signal.SIG_IGN)
    numbers = [int(argument) for argument in sys.argv[1:]]
    relay(*zip(numbers[::2], numbers[1::2], strict=True))
