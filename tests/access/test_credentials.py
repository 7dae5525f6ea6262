# SPDX-License-Identifier: Apache-2.0
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gateway.access.credentials import CredentialsError, check_target, token_in


@pytest.mark.parametrize(
    ("authorization", "subprotocols", "token"),
    [
        ([], [], None),
        (["Bearer r2g_x"], [], "r2g_x"),
        (["bearer   r2g_x "], [], "r2g_x"),
        ([], ["ros2-gateway", "bearer.r2g_x"], "r2g_x"),
        ([], ["ros2-gateway"], None),
        (["Bearer r2g_x"], ["bearer.r2g_x"], "r2g_x"),
        ([], ["bearer."], ""),
    ],
)
def test_a_token_is_found_where_it_may_be(authorization, subprotocols, token):
    assert token_in(authorization, subprotocols) == token


@pytest.mark.parametrize(
    ("authorization", "subprotocols", "reason"),
    [
        (["Basic dXNlcjpwYXNz"], [], "expected `Authorization: Bearer TOKEN`"),
        (["Bearer"], [], "expected"),
        ([""], [], "expected"),
        (["Bearer a", "Bearer b"], [], "more than one token"),
        (["Bearer a"], ["bearer.b"], "more than one token"),
        ([], ["bearer.a", "bearer.b"], "more than one token"),
    ],
)
def test_credentials_that_contradict_themselves_are_refused(authorization, subprotocols, reason):
    with pytest.raises(CredentialsError, match=reason):
        token_in(authorization, subprotocols)


@given(st.lists(st.text(), max_size=3), st.lists(st.text(), max_size=50))
def test_any_headers_give_a_token_or_a_refusal(authorization, subprotocols):
    try:
        token = token_in(authorization, subprotocols)
    except CredentialsError:
        return
    assert token is None or isinstance(token, str)


@pytest.mark.parametrize(
    "target", ["/?token=x", "/?a=b&access_token=x", "/ros?TOKEN=", "/?%74oken=x", "/?auth=x"]
)
def test_a_token_in_the_address_is_refused_with_words(target):
    with pytest.raises(CredentialsError, match="must not be in the address") as caught:
        check_target(target)
    assert "=x" not in str(caught.value)


@pytest.mark.parametrize("target", ["/", "/?", "/?name=x", "/token", "/?tokens=1"])
def test_other_addresses_pass(target):
    check_target(target)
