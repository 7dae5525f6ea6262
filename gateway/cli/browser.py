# SPDX-License-Identifier: Apache-2.0
"""Opens a page in the user's browser, if there is a desktop."""

import os
import sys
import threading


def open_page(url: str) -> bool:
    """Open a page if the output goes to a terminal of a desktop, and return whether that is tried.

    It runs in a thread, because a browser may take seconds to start. Its failure does not matter,
    because the address is also printed.
    """
    desktop = os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")
    if not desktop or not sys.stdout.isatty():
        return False
    import webbrowser

    threading.Thread(target=webbrowser.open, args=(url,), name="browser", daemon=True).start()
    return True
