# SPDX-License-Identifier: Apache-2.0
"""A stop as both processes send it, the gateway and its guard: zeros, then silence."""

from typing import Final

ZEROS: Final = 5  # one is enough for a reliable reader; a best-effort one may lose some
ZERO_PERIOD_NS: Final = 50_000_000  # the last one after 200 ms
LIFESPAN_NS: Final = 250_000_000  # of every command, in DDS: an old one must not move anything
