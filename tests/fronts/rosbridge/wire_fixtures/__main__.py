# SPDX-License-Identifier: Apache-2.0
"""Write the recordings again, all or those named."""

import argparse

from tests.fronts.rosbridge.wire_fixtures.stage import FILES, replay


def main() -> None:
    """Do it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--write", action="store_true", required=True)
    parser.add_argument("names", nargs="*", help="of the conversations, without .txt")
    names = parser.parse_args().names
    for file in FILES:
        if not names or file.stem in names:
            file.write_text(replay(file.read_text()))


main()
