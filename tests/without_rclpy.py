# SPDX-License-Identifier: Apache-2.0
"""The command line in a process that cannot import rclpy."""

import sys

from gateway.cli.main import main

if __name__ == "__main__":
    sys.modules["rclpy"] = None  # type: ignore[assignment]  # every import of it fails
    sys.exit(main())
