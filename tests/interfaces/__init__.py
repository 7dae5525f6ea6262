# SPDX-License-Identifier: Apache-2.0
"""ROS packages that tests need and PyPI lacks, built from their definitions.

``idl_msgs`` is made up: its definitions are `.idl` files alone. Those of ``tf2_msgs`` come with the
gateway.

`python -m tests.interfaces` builds them (gcc needed, a few seconds, once) against the wheels, and
the tests' `conftest.py` uses them from then on.
"""

import hashlib
import importlib.metadata
import os
import sys
from pathlib import Path
from typing import Final

from schemas.folders import SHIPPED

FOLDER: Final = Path(__file__).parent
SOURCES: Final = {"tf2_msgs": SHIPPED / "tf2_msgs", "idl_msgs": FOLDER / "idl_msgs"}
HOW: Final = (
    "tf2_msgs and idl_msgs are not built: `python -m tests.interfaces` builds them, with gcc"
)

_CACHE: Final = FOLDER.parents[1] / ".cache/interfaces"
# the built code depends on these, on the definitions, and on the interpreter
_GENERATORS: Final = ("ros-rosidl-generator-py", "ros-rosidl-typesupport-fastrtps-c", "numpy")


def prefix() -> Path | None:
    """Return the folder into which this interpreter's packages are built.

    ``None``: rclpy is not from the wheels, and such a ROS installation has its own packages.
    """
    key = hashlib.sha256(f"{sys.prefix} {sys.version}".encode())
    try:
        for name in _GENERATORS:
            key.update(f" {name} {importlib.metadata.version(name)}".encode())
    except importlib.metadata.PackageNotFoundError:
        return None
    definitions = (path for source in SOURCES.values() for path in source.rglob("*.*"))
    for path in (FOLDER / "build.py", *sorted(definitions)):
        key.update(f"\n{'/'.join(path.parts[-3:])}\n".encode() + path.read_bytes())
    return _CACHE / key.hexdigest()[:16]


def use() -> None:
    """Let this process and its children find the built packages. Call it before rclpy."""
    built = prefix()
    if built is None or not built.is_dir():
        return
    modules = str(built / "python")
    for variable, entry in (("PYTHONPATH", modules), ("AMENT_PREFIX_PATH", str(built))):
        entries = os.environ.get(variable, "").split(os.pathsep)
        os.environ[variable] = os.pathsep.join([entry, *filter(None, entries)])
    sys.path.insert(0, modules)
