# SPDX-License-Identifier: Apache-2.0
"""Write docs/reference/errors.md from the explanations in the code: python -m tools.errors_page."""

from collections.abc import Iterator
from pathlib import Path
from textwrap import fill
from typing import Final

from gateway.protocol import errors
from gateway.protocol.errors import Explanation
from gateway.server import close_codes

PAGE: Final = Path(__file__).resolve().parents[1] / "docs/reference/errors.md"

_INTRO: Final = """\
# Error codes

Look up a code here to see what it means, what causes it, and what to do.
`make docs` writes this page from the code.

## Codes in answers

An answer to an operation that fails has a `code` for programs and a `msg` for people.
[When something is wrong](protocol/connection.md#when-something-is-wrong) describes these answers.
Codes that only report an event, such as `publisher_gone`, come as warnings.
"""
_CLOSE_CODES: Final = """
## Close codes

The gateway ends a connection with one of these WebSocket close codes and a reason in text.
For the status codes of plain HTTP requests, see [HTTP](http.md#status-codes).
"""


def page() -> str:
    """Return the text of the page."""
    statuses = (_section(code, each) for code, each in errors.EXPLANATIONS.items())
    closings = (_section(str(code), each) for code, each in close_codes.EXPLANATIONS.items())
    return "".join((_INTRO, *statuses, _CLOSE_CODES, *closings))


def _section(code: str, explanation: Explanation) -> str:
    return "\n".join(_lines(code, explanation))


def _lines(code: str, explanation: Explanation) -> Iterator[str]:
    yield f"\n### {code}\n"
    yield f"{explanation.meaning}\n"
    yield _item(f"**Cause:** {explanation.cause}")
    yield _item(f"**What to do:** {explanation.cure}") + "\n"


def _item(text: str) -> str:
    return fill(
        text,
        width=100,
        initial_indent="- ",
        subsequent_indent="  ",
        break_long_words=False,
        break_on_hyphens=False,
    )


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
