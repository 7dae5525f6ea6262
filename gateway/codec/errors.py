# SPDX-License-Identifier: Apache-2.0
"""The exceptions of the codecs."""


class CodecError(ValueError):
    """Bytes or a value do not fit the type. ``offset`` is the position in the bytes, if known."""

    def __init__(self, reason: str, *, offset: int | None = None) -> None:
        super().__init__(reason)
        self.offset = offset


class FieldError(CodecError):
    """A path names no field of a message type. The text lists the fields."""


class JsonError(CodecError):
    """A client sent something else than the JSON it may send. The text says where and why."""
