# SPDX-License-Identifier: Apache-2.0
"""``ros2-gateway`` with more time for its end than the 1.8 s after which it ends by force.

On a machine that is ten times slower an orderly end takes longer, and tests want to see one.
"""

from gateway import forced_end
from gateway.__main__ import run


def main() -> None:
    """Run it."""
    forced_end.SHUTDOWN_S = 60  # type: ignore[misc]  # final everywhere else
    run()


if __name__ == "__main__":
    main()
