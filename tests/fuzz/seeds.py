# SPDX-License-Identifier: Apache-2.0
"""Seeds: the examples of docs/reference/protocol/, which show each operation."""

from tests.doc_blocks import protocol_examples


def conversations() -> list[list[bytes]]:
    """Return what the client says in each example, frame by frame."""
    return [
        [line[2:].encode() for line in example.splitlines() if line.startswith("> ")]
        for example in protocol_examples()
    ]


def frames() -> list[bytes]:
    """Return each frame of the examples."""
    return sorted({frame for conversation in conversations() for frame in conversation})
