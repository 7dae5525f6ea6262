# SPDX-License-Identifier: Apache-2.0
import argparse

import pytest

from gateway.cli.argument_types import seconds


def test_a_time_has_ten_minutes_at_most():
    assert seconds("600") == 600
    with pytest.raises(argparse.ArgumentTypeError, match=r"got '600\.1', expected seconds"):
        seconds("600.1")
