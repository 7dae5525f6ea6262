# SPDX-License-Identifier: Apache-2.0
"""Secrets, which are in separate files, and never in a configuration or a command line."""

import re
import stat
from pathlib import Path
from typing import Final

TOKEN_PREFIX: Final = "r2g_"  # noqa: S105  # so that people, and scanners of logs, recognise one
ADVICE: Final = (
    "a secret does not belong here, where others can read it: remove it, and make tokens with"
    " `ros2-gateway token create NAME`"
)
FILE_ADVICE: Final = (
    "other users of this machine can read a command line: write the token into a file that only"
    " you can read, and name that by --token-file"
)

_NAMES: Final = re.compile(
    r"(?:^|[-_.])(token|password|passwd|secret|credentials?|api_?key)s?$", re.IGNORECASE
)
_TOKEN: Final = re.compile(rf"{TOKEN_PREFIX}[A-Za-z0-9_-]+")


def is_secret_name(name: str) -> bool:
    """Return whether a setting, variable or flag of this name would hold a secret."""
    return bool(_NAMES.search(name))


def without_tokens(text: str) -> str:
    """Return a text in which each token is only its prefix."""
    return _TOKEN.sub(f"{TOKEN_PREFIX}...", text)


def exposure(path: Path) -> str | None:
    """Return a sentence if every user can read a file with secrets, otherwise ``None``."""
    try:
        mode = path.stat().st_mode
    except OSError:  # reported when the file is read
        return None
    if mode & stat.S_IROTH:
        return f"{path} can be read by every user of this machine: run chmod o-rwx {path}"
    return None
