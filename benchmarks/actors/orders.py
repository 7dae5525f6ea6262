# SPDX-License-Identifier: Apache-2.0
"""Orders to the programs: a line on stdin is an order, a line of JSON answers it.

The end of stdin ends the program, so that none outlives the benchmark, however that ends. SIGINT
does the same.
"""

import json
import os
import select
import signal
import sys
import threading
from collections.abc import Callable, Mapping


def reply(value: object) -> None:
    """Answer with one line of JSON."""
    sys.stdout.write(json.dumps(value) + "\n")
    sys.stdout.flush()


def obey(orders: Mapping[str, Callable[..., object]], on_end: Callable[[], object]) -> None:
    """Carry out each line ``WORD ARGUMENT ...`` in a separate thread. Call it in the main thread.

    The answer is what the order returns. After ``None``, the order answers later. *on_end* must
    make the main thread end, wherever it waits.
    """
    woken, wake = os.pipe()
    os.set_blocking(wake, False)
    # the signal itself writes the wake-up, even while the main thread waits inside rclpy
    signal.signal(signal.SIGINT, lambda *_: None)
    signal.set_wakeup_fd(wake)
    threading.Thread(target=_obey, args=(orders, on_end, woken), daemon=True).start()


def _obey(
    orders: Mapping[str, Callable[..., object]], on_end: Callable[[], object], woken: int
) -> None:
    rest = b""
    while True:
        readable, _, _ = select.select([sys.stdin.fileno(), woken], [], [])
        chunk = b"" if woken in readable else os.read(sys.stdin.fileno(), 4096)
        if not chunk:
            on_end()
            return
        *lines, rest = (rest + chunk).split(b"\n")
        for line in lines:
            word, *arguments = line.decode().split()
            answer = orders[word](*arguments)
            if answer is not None:
                reply(answer)
