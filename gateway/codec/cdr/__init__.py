# SPDX-License-Identifier: Apache-2.0
"""CDR, the wire format of DDS, to values and back: straight-line code, compiled per type.

ROS 2 uses plain CDR, encoding version 1 (DDS-XTypes 1.3, 7.4.3). A 4-byte encapsulation header
comes first. Then every primitive is aligned to its size, counted from after the header.
"""

from gateway.codec.cdr.compiled import (
    Decoder,
    SlicedDecoder,
    SlicedTranscoder,
    Transcoder,
    compile_decoder,
    compile_sliced_decoder,
    compile_sliced_transcoder,
    compile_transcoder,
)
from gateway.codec.cdr.encoder import Encoder, compile_encoder
from gateway.codec.cdr.layout import Cdr
from gateway.codec.cdr.target import Octets

__all__ = [
    "Cdr",
    "Decoder",
    "Encoder",
    "Octets",
    "SlicedDecoder",
    "SlicedTranscoder",
    "Transcoder",
    "compile_decoder",
    "compile_encoder",
    "compile_sliced_decoder",
    "compile_sliced_transcoder",
    "compile_transcoder",
]
