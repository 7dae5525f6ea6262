# SPDX-License-Identifier: Apache-2.0
"""The profile that Fast DDS, the middleware of ROS' wheels, reads in a process of ours."""

import contextlib
import os
from collections.abc import Iterator
from pathlib import Path
from typing import Final

# Fast DDS 2 reads the first name, Fast DDS 3 the second.
_VARIABLES: Final = ("FASTRTPS_DEFAULT_PROFILES_FILE", "FASTDDS_DEFAULT_PROFILES_FILE")


@contextlib.contextmanager
def profile(path: Path) -> Iterator[None]:
    """Let Fast DDS read the file *path*, unless the environment names one itself.

    It does so once in a process, when the first node is created. The environment is as before
    afterwards: what this process starts chooses for itself.
    """
    if any(name in os.environ for name in _VARIABLES):
        yield
        return
    os.environ.update(dict.fromkeys(_VARIABLES, str(path)))
    try:
        yield
    finally:
        for name in _VARIABLES:
            os.environ.pop(name, None)
