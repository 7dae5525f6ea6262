# SPDX-License-Identifier: Apache-2.0
"""Messages out of frames, as `websockets` parses them."""

from websockets.frames import Frame, Opcode

from gateway.transport.frame_reader import MessageAssembly


def test_a_whole_message_is_passed_on_with_its_kind():
    assembly = MessageAssembly()
    assert assembly.add(Frame(Opcode.TEXT, b"text")) == b"text"
    assert assembly.is_text
    assert assembly.add(Frame(Opcode.BINARY, b"octets")) == b"octets"
    assert not assembly.is_text


def test_fragments_are_joined_and_the_first_says_their_kind():
    assembly = MessageAssembly()
    assert assembly.add(Frame(Opcode.TEXT, b"a", fin=False)) is None
    assert assembly.add(Frame(Opcode.CONT, b"b", fin=False)) is None
    assert assembly.add(Frame(Opcode.CONT, b"c")) == b"abc"
    assert assembly.is_text
    assert assembly.add(Frame(Opcode.BINARY, b"", fin=False)) is None
    assert assembly.add(Frame(Opcode.CONT, b"d")) == b"d"
    assert not assembly.is_text


def test_a_whole_message_that_is_taken_ahead_leaves_the_fragments_around_it_as_they_are():
    assembly = MessageAssembly()
    assert assembly.add(Frame(Opcode.BINARY, b"a", fin=False)) is None
    assert assembly.add(Frame(Opcode.TEXT, b"text")) == b"text"
    assert assembly.is_text
    assert assembly.add(Frame(Opcode.CONT, b"b")) == b"ab"
    assert not assembly.is_text


def test_empty_fragments_are_not_kept():
    assembly = MessageAssembly()
    assembly.add(Frame(Opcode.TEXT, b"", fin=False))
    for _ in range(1000):
        assembly.add(Frame(Opcode.CONT, b"", fin=False))
    assert assembly._fragments == []
    assert assembly.add(Frame(Opcode.CONT, b"")) == b""
