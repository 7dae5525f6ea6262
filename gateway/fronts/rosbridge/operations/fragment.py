# SPDX-License-Identifier: Apache-2.0
"""Pieces of messages."""

from typing import Annotated

from pydantic import Field

from gateway.fronts.rosbridge.operations.base import Id, Operation


class Fragment(Operation):
    """One piece of a message. The pieces of one message share an id."""

    op = "fragment"
    id: Id
    num: Annotated[int, Field(ge=0)]
    total: Annotated[int, Field(ge=1)]
    data: str
