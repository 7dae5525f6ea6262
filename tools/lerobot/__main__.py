# SPDX-License-Identifier: Apache-2.0
"""Turn recordings of the gateway into a LeRobot dataset: ``python -m tools.lerobot --help``."""

import argparse
import sys
from pathlib import Path

from gateway.errors import GatewayError


def main() -> int:
    """Convert, and return the exit code."""
    arguments = _arguments()
    try:
        from tools.lerobot.conversion import convert
        from tools.lerobot.mapping import read_mapping
    except ImportError as error:
        sys.stderr.write(
            f"{error}: run pip install '.[record]' -r tools/lerobot/requirements.txt in the"
            " source tree\n"
        )
        return 1
    output = _Terminal()
    try:
        mapping = read_mapping(arguments.mapping)
        convert(arguments.recording, mapping, arguments.output, output)
    except GatewayError as error:
        output.line(str(error))
        return 1
    except KeyboardInterrupt:
        output.line("interrupted: nothing is written")
        return 130
    return 0


class _Terminal:
    """Writes to standard error, where a terminal also shows progress."""

    def line(self, text: str) -> None:
        """Write a line."""
        sys.stderr.write(f"{self._clear}{text}\n")

    def progress(self, text: str) -> None:
        """Show it until the next text."""
        if self._clear:
            sys.stderr.write(f"{self._clear}{text}")
            sys.stderr.flush()

    @property
    def _clear(self) -> str:
        return "\r\x1b[K" if sys.stderr.isatty() else ""


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="python -m tools.lerobot",
        description="Turn recordings of the gateway into a LeRobot dataset (version 3).",
        epilog="docs/how-to/train.md explains the mapping, and tools/lerobot/sim.toml is one.",
    )
    parser.add_argument(
        "recording", nargs="+", type=Path, help="directory of a recording, or one MCAP file"
    )
    parser.add_argument(
        *("-m", "--mapping"), type=Path, required=True, help="TOML file: topics, fields, and fps"
    )
    parser.add_argument(
        *("-o", "--output"), type=Path, required=True, help="directory for the dataset, a new one"
    )
    return parser.parse_args()


if __name__ == "__main__":
    sys.exit(main())
