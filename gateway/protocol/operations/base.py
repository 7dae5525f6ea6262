# SPDX-License-Identifier: Apache-2.0
"""What all operations have in common."""

from typing import Annotated, ClassVar, Final

from pydantic import BaseModel, ConfigDict, Field

# rosbridge clients build ids from a topic and a counter, or a UUID
MAX_ID_CHARACTERS: Final = 256
Id = Annotated[str, Field(max_length=MAX_ID_CHARACTERS)] | int

Seconds = Annotated[float, Field(ge=0, le=1e9)]
# An outgoing message longer than this, in characters, goes in pieces. Below 64 the envelopes
# would be most of what is sent.
FragmentSize = Annotated[int, Field(ge=64)]


class Operation(BaseModel):
    """What every operation has: a name, and an id that answers carry back."""

    model_config = ConfigDict(strict=True, frozen=True, extra="ignore")

    op: ClassVar[str]
    id: Id | None = None
