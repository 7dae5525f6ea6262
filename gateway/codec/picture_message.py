# SPDX-License-Identifier: Apache-2.0
"""A compressed picture and the other fields of its message, in the shape of CompressedImage."""

from dataclasses import dataclass
from typing import Any

import pybase64

from gateway.codec import cbor
from gateway.codec.json import dumps


@dataclass(frozen=True, slots=True)
class PictureMessage:
    """The members of a message, of which ``data`` is a file in the format ``format``."""

    members: dict[str, Any]

    @property
    def data(self) -> bytes:
        """The file alone."""
        data: bytes = self.members["data"]
        return data

    def json(self) -> bytes:
        """Return the message in JSON, with ``data`` in base64."""
        return dumps({**self.members, "data": pybase64.b64encode_as_string(self.data)})

    def cbor(self) -> bytes:
        """Return the message in CBOR, with ``data`` as a byte string."""
        return cbor.dumps(self.members)
