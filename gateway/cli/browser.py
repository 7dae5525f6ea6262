# SPDX-License-Identifier: Apache-2.0
"""Opens a page in the browser of whoever started the program, if there is a desktop."""

import os
import sys
import threading


def open_page(url: str) -> bool:
    """Open a page, unless nobody sits there; return whether that is tried.

    Somebody does if the output goes to a terminal of a desktop. It is done in a thread: a browser
    that starts may take seconds, and its failure is nobody's concern, as the address is printed.
    """
    desktop = os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")
    if not desktop or not sys.stdout.isatty():
        return False
    import webbrowser

    threading.Thread(target=webbrowser.open, args=(url,), name="browser", daemon=True).start()
    return True
