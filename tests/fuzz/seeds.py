# SPDX-License-Identifier: Apache-2.0
"""Seeds: the examples of docs/reference/protocol.md, which show each operation."""

import re
from pathlib import Path

PAGE = Path(__file__).parents[2] / "docs/reference/protocol.md"
_EXAMPLES = re.compile(r"^```wscat\n(.*?)^```", re.DOTALL | re.MULTILINE)


def conversations() -> list[list[bytes]]:
    """Return what the client says in each example, frame by frame."""
    return [
        [line[2:].encode() for line in example.splitlines() if line.startswith("> ")]
        for example in _EXAMPLES.findall(PAGE.read_text(encoding="utf-8"))
    ]


def frames() -> list[bytes]:
    """Return each frame of the examples."""
    return sorted({frame for conversation in conversations() for frame in conversation})
