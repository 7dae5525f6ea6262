# SPDX-License-Identifier: Apache-2.0
"""``python -m schemas.generate [--check]``: write the files of the list of message types."""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Final

from schemas.definition import DefinitionError
from schemas.generate.catalogue import Catalogue
from schemas.generate.writers import Output
from schemas.installed import InstalledDefinitions, UnknownTypeError
from schemas.table import TABLE_PATH, Table, TableError

_ROOT: Final = Path(__file__).parents[2]

_HOW_TO_INSTALL: Final = """\
install the ROS package of that name (apt install ros-$ROS_DISTRO-NAME, with - for _), or source
the workspace that holds it; common_interfaces come with pip install '.[ros]' in the source tree"""


def main(
    arguments: Sequence[str] | None = None, installed: InstalledDefinitions | None = None
) -> int:
    """Generate, or compare with ``--check``.

    Returns:
        0: done, or nothing differs. 1: something differs. 2: generation is impossible.
    """
    parser = argparse.ArgumentParser(
        prog="python -m schemas.generate",
        description="Write models, schemas, C# classes and reference pages from the message table.",
    )
    parser.add_argument(
        "--check", action="store_true", help="write nothing, exit 1 if files differ"
    )
    parser.add_argument("--table", type=Path, default=TABLE_PATH, help="default: %(default)s")
    parser.add_argument(
        "--root", type=Path, default=_ROOT, help="tree to write, default: %(default)s"
    )
    options = parser.parse_args(arguments)
    try:
        table = Table.load(options.table)
        output = Output.of(Catalogue.of(table, installed or InstalledDefinitions()), options.root)
    except UnknownTypeError as error:
        print(f"{error}: {_HOW_TO_INSTALL}", file=sys.stderr)
        return 2
    except (TableError, DefinitionError, OSError) as error:
        print(error, file=sys.stderr)
        return 2
    changed = output.differences() if options.check else output.write()
    for path in changed:
        shown = path.relative_to(options.root)
        print(f"differs: {shown}" if options.check else f"wrote {shown}")
    if options.check and changed:
        print(f"{len(changed)} files differ; run make docs", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
