# SPDX-License-Identifier: Apache-2.0
"""Times as values."""


def stamp(nanoseconds: int) -> dict[str, int]:
    """Split nanoseconds as builtin_interfaces/msg/Time does."""
    sec, nanosec = divmod(nanoseconds, 1_000_000_000)
    return {"sec": sec, "nanosec": nanosec}
