# SPDX-License-Identifier: Apache-2.0
"""The attachment of samples, requests and replies in rmw_zenoh: number, time, and whose it is."""

import struct
from typing import Final, NamedTuple

from gateway.sources.zenoh.keys import WireError

_FORM: Final = struct.Struct("<qqB16s")
_GID_BYTES: Final = 16
# Before April 2025: each value followed its label, and texts their length.
_OLD_FORM: Final = struct.Struct("<B15sqB16sqB10sB16s")
_OLD_LABELS: Final = (b"sequence_number", b"source_timestamp", b"source_gid")


class Attachment(NamedTuple):
    """Number, time and sender of a message. A reply repeats the number and gid of its request."""

    number: int  # of its sender's, from 1
    source_ns: int  # the sender's system clock
    gid: bytes  # of the sender's token, see `gateway.sources.zenoh.tokens.gid_of`

    @property
    def packed(self) -> bytes:
        """The bytes on the wire. See also `read_attachment`."""
        return _FORM.pack(self.number, self.source_ns, _GID_BYTES, self.gid)


def read_attachment(data: bytes) -> Attachment:
    """Read the attachment of any version of rmw_zenoh.

    Raises:
        WireError: it is another one.
    """
    if len(data) == _FORM.size:
        number, source_ns, size, gid = _FORM.unpack(data)
        if size == _GID_BYTES:
            return Attachment(number, source_ns, gid)
    if len(data) == _OLD_FORM.size:
        of_number, first, number, of_time, second, source_ns, of_gid, third, size, gid = (
            _OLD_FORM.unpack(data)
        )
        lengths = (of_number, of_time, of_gid)
        is_labelled = (first, second, third) == _OLD_LABELS
        if is_labelled and (*lengths, size) == (*map(len, _OLD_LABELS), _GID_BYTES):
            return Attachment(number, source_ns, gid)
    raise WireError(f"attachment of {len(data)} bytes is not that of rmw_zenoh")
