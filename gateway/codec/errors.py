# SPDX-License-Identifier: Apache-2.0
"""What the codecs raise."""


class CodecError(ValueError):
    """Bytes or a value do not fit the type; ``offset`` is where in the bytes, if known."""

    def __init__(self, reason: str, *, offset: int | None = None) -> None:
        super().__init__(reason)
        self.offset = offset


class FieldError(CodecError):
    """A path names no field of a message type; the text says which fields there are."""
