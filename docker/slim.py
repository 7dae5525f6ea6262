# SPDX-License-Identifier: Apache-2.0
"""Makes an environment of wheels smaller, by a third: slim.py FOLDER."""

import os
import shutil
import sys
from hashlib import sha256
from pathlib import Path

# Nothing imports these: what builds and tests others, and models of faces.
UNUSED = (
    "include",
    "share/*/cmake",
    "lib/python*/site-packages/**/*.pyi",
    "lib/python*/site-packages/numpy/distutils",
    "lib/python*/site-packages/numpy/f2py",
    "lib/python*/site-packages/**/tests",
    "lib/python*/site-packages/cv2/data",
    "lib/python*/site-packages/pip",
    "lib/python*/site-packages/setuptools",
    "lib/python*/site-packages/pkg_resources",
    "lib/python*/site-packages/_distutils_hack",
    "lib/python*/site-packages/distutils-precedence.pth",
)


def remove_unused(root: Path) -> None:
    """Remove files and folders that nothing imports."""
    for pattern in UNUSED:
        for path in list(root.glob(pattern)):
            if path.is_dir():
                shutil.rmtree(path, ignore_errors=True)
            else:
                path.unlink()


def link_copies(root: Path) -> None:
    """Leave each library once. Wheels cannot hold links, so those of ROS have up to eight."""
    first: dict[bytes, Path] = {}
    for path in sorted(root.rglob("*.so*")):
        if path.is_symlink() or not path.is_file():
            continue
        same = first.setdefault(sha256(path.read_bytes()).digest(), path)
        if same is not path:
            path.unlink()
            path.symlink_to(os.path.relpath(same, path.parent))


if __name__ == "__main__":
    remove_unused(Path(sys.argv[1]))
    link_copies(Path(sys.argv[1]))
