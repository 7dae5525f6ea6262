# SPDX-License-Identifier: Apache-2.0
import pytest

from gateway.server.url_options import UrlOptionError, image_format


@pytest.mark.parametrize(
    ("target", "expected"),
    [
        ("/", None),
        ("/?name=x", None),
        ("/?images=raw", "raw"),
        ("/?a=b&images=png", "png"),
        ("/?images=jpeg&images=raw", "raw"),
    ],
)
def test_the_format_of_pictures_is_in_the_address(target, expected):
    assert image_format(target) == expected


@pytest.mark.parametrize("value", ["", "gif", "RAW", "x" * 1000])
def test_a_format_that_is_none_is_refused_with_those_that_are(value):
    with pytest.raises(UrlOptionError, match=r"expected jpeg, .* or raw") as caught:
        image_format(f"/?images={value}")
    assert len(str(caught.value)) < 100
