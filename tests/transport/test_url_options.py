# SPDX-License-Identifier: Apache-2.0
import pytest

from gateway.transport.url_options import UrlOptionError, url_options


@pytest.mark.parametrize(
    ("target", "expected"),
    [
        ("/", (None, None)),
        ("/?name=x", (None, None)),
        ("/?images=raw", ("raw", None)),
        ("/?a=b&images=png", ("png", None)),
        ("/?images=jpeg&images=raw", ("raw", None)),
        ("/?status=warning", (None, "warning")),
        ("/?status=info&images=raw", ("raw", "info")),
        ("/?status=warning&status=none", (None, "none")),
    ],
)
def test_an_address_asks_for_pictures_and_a_level(target, expected):
    assert url_options(target) == expected


@pytest.mark.parametrize("value", ["", "gif", "RAW", "x" * 1000])
@pytest.mark.parametrize(
    ("name", "known"),
    [("images", r"expected jpeg, .* or raw"), ("status", r"expected none, .* or")],
)
def test_an_option_with_an_unknown_value_is_refused_with_those_that_are_known(name, known, value):
    with pytest.raises(UrlOptionError, match=known) as caught:
        url_options(f"/?{name}={value}")
    assert len(str(caught.value)) < 100
