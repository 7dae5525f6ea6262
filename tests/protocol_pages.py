# SPDX-License-Identifier: Apache-2.0
"""The examples in docs/reference/protocol/: conversations between a client and the gateway."""

import re
from pathlib import Path

REFERENCE = Path(__file__).parents[1] / "docs/reference"
PAGES = sorted((REFERENCE / "protocol").glob("*.md"))
_EXAMPLE = re.compile(r"^```wscat\n(.*?)^```", re.DOTALL | re.MULTILINE)


def examples() -> list[str]:
    """Return each example: lines that begin with `> ` (sent) or `< ` (received)."""
    texts = (page.read_text(encoding="utf-8") for page in PAGES)
    return [example for text in texts for example in _EXAMPLE.findall(text)]
