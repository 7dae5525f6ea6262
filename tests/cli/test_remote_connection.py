# SPDX-License-Identifier: Apache-2.0
"""The words about a gateway elsewhere. `test_remote_types.py` asks real ones."""

from gateway.cli.remote_connection import Gateway, _printable


def test_a_gateway_has_ten_seconds_for_an_answer_unless_it_is_said_otherwise():
    assert Gateway("ws://robot:9090/").timeout_s == 10


def test_foreign_words_are_one_short_line():
    assert _printable("no\nway") == "no way"
    assert _printable("x" * 100_000) == "x" * 300
