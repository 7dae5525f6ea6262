# SPDX-License-Identifier: Apache-2.0
import pytest

from gateway.codec.error_text import misspelt

KNOWN = ("throttle_rate", "args", "id", "fields")


@pytest.mark.parametrize(
    ("name", "meant"),
    [
        ("throtle_rate", "throttle_rate"),  # a letter is missing
        ("throtttle_rate", "throttle_rate"),  # one too many
        ("trhottle_rate", "throttle_rate"),  # two are swapped
        ("trottle_rat", "throttle_rate"),  # two edits
        ("trotle_rat", None),  # three
        ("arg", "args"),
        ("ar", None),
        ("ids", None),
        ("field", "fields"),
    ],
)
def test_a_misspelling_is_two_edits_away_and_fewer_than_half_of_the_name(
    name: str, meant: str | None
):
    assert misspelt(name, KNOWN) == meant
