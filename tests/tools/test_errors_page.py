# SPDX-License-Identifier: Apache-2.0
"""The page of error codes explains each code that the gateway sends."""

import re
from pathlib import Path
from typing import get_args

from gateway.core.errors import StatusCode
from gateway.transport import close_codes

PAGE = Path(__file__).parents[2] / "docs/reference/errors.md"


def test_every_code_is_explained_once_with_its_cause_and_the_cure():
    sections = PAGE.read_text("utf-8").split("\n### ")[1:]
    closings = [str(code) for code in vars(close_codes).values() if isinstance(code, int)]
    assert sorted(each.split("\n")[0] for each in sections) == sorted(
        [*get_args(StatusCode), *closings]
    )
    form = re.compile(
        r"\w+\n\n[A-Z][^*]+\.\n\n- \*\*Cause:\*\* .+\.\n- \*\*What to do:\*\* .+\.\n", re.DOTALL
    )
    assert [each for each in sections if not form.match(each)] == []
