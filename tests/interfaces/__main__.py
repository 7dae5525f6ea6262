# SPDX-License-Identifier: Apache-2.0
"""Build the packages that the tests need, unless they are built already."""

import contextlib
import io
import shutil
import sys
import sysconfig
import tempfile
from pathlib import Path

from tests.interfaces import SOURCES, prefix


def main() -> int:
    """Build missing packages. Without a compiler, say so, and let the tests be skipped."""
    target = prefix()
    if target is None or target.is_dir():
        return 0
    has_headers = Path(sysconfig.get_path("include"), "Python.h").is_file()
    if not (shutil.which("gcc") and shutil.which("g++") and has_headers):
        print("no gcc, g++ or Python.h: tests that need tf2_msgs or idl_msgs will be skipped")  # noqa: T201
        return 0
    from tests.interfaces.build import build  # only now: it needs the generators

    print(f"building {', '.join(SOURCES)} for the tests ...", flush=True)  # noqa: T201
    target.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=target.parent) as scratch:
        built = Path(scratch) / "built"
        with contextlib.redirect_stdout(io.StringIO()):  # rosidl tells of every file
            for package, source in SOURCES.items():
                build(package, source, built)
        if not target.is_dir():  # another process may have been faster
            built.rename(target)
    return 0


if __name__ == "__main__":
    sys.exit(main())
