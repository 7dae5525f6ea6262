# SPDX-License-Identifier: Apache-2.0
"""Recordings."""

import re
from typing import Annotated, Final, Literal

from pydantic import AfterValidator, Field

from gateway.config.access import GLOB
from gateway.core import requests
from gateway.fronts.rosbridge.operations.base import Operation

MAX_TEXT: Final = 200  # characters, as in the audit log
MAX_GLOBS: Final = 256  # as in the permissions of a role


def _glob(text: str) -> str:
    if not re.match(GLOB, text):
        raise ValueError("expected a pattern such as /camera/** or /*/odom")
    return text


Globs = Annotated[
    tuple[Annotated[str, AfterValidator(_glob)], ...], Field(strict=False, max_length=MAX_GLOBS)
]
Text = Annotated[str, Field(max_length=MAX_TEXT)]


class Record(Operation):
    """Start or stop a recording, mark something in it, or ask for its state.

    With ``watch: true``, also for all later changes. ``watch: false`` ends these.
    """

    op = "record"
    makes = requests.Record
    action: Literal["start", "stop", "mark", "status"] = "status"
    topics: Globs | None = None
    images: Literal["raw", "jpeg"] = "raw"
    task: Text | None = None
    operator: Text | None = None
    text: Text | None = None
    episode: Literal["start", "end"] | None = None
    success: bool | None = None
    watch: bool | None = None
