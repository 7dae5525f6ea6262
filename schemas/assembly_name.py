# SPDX-License-Identifier: Apache-2.0
"""The names that assemblies of Unity may have here: words with dots, which a command can take."""

import re
from typing import Final

_NAME: Final = re.compile(r"[A-Za-z_]\w*(\.[A-Za-z_]\w*)*", re.ASCII)
MAX_ASSEMBLY_NAME: Final = 100  # characters: a file is called so
EXPECTATION: Final = (
    "a name such as Robot.Messages: words of letters, digits and _ with dots between them, at most "
    f"{MAX_ASSEMBLY_NAME} characters, and not Ros2Gateway, which is the package's"
)


def is_assembly_name(text: str) -> bool:
    """Return whether generated classes may be an assembly of this name."""
    is_own = text.partition(".")[0] == "Ros2Gateway"
    return len(text) <= MAX_ASSEMBLY_NAME and not is_own and bool(_NAME.fullmatch(text))
