# SPDX-License-Identifier: Apache-2.0
import pytest

from gateway.access.authentication import Authentication, AuthenticationError
from gateway.access.permissions import Policy
from gateway.access.tokens import Tokens, make_token
from gateway.config.access import AccessConfig, ViewerConfig

NOW = "2026-01-02T03:04:05+00:00"
TEXT, TOKEN = make_token("tablet", "operator", NOW)
POLICY = Policy(AccessConfig())


def authentication(anonymous_role=None) -> Authentication:
    return Authentication(Tokens((TOKEN,)), POLICY, anonymous_role)


def test_a_token_identifies_its_client():
    identity = authentication().identify(TEXT)
    assert (identity.name, identity.role, identity.digest) == ("tablet", "operator", TOKEN.digest)
    assert identity.permissions is POLICY.of("operator")


def test_a_right_token_passes_after_any_number_of_wrong_ones():
    known = authentication()
    for _ in range(20):
        with pytest.raises(AuthenticationError, match="the token is wrong"):
            known.identify("wrong")
    assert known.identify(TEXT).name == "tablet"


def test_without_a_token_a_client_is_anonymous_or_nobody():
    assert authentication().anonymous is None
    viewer = authentication("viewer").anonymous
    assert viewer is not None
    assert (viewer.name, viewer.role, viewer.digest) == ("anonymous", "viewer", None)


@pytest.mark.parametrize(("role", "looks"), [(None, True), ("viewer", True), ("admin", False)])
def test_tokens_are_checked_if_they_make_a_difference(role, looks):
    assert authentication(role).looks_at_tokens is looks


def test_after_a_reload_a_client_has_the_identity_of_its_token():
    known = authentication("viewer")
    tablet, anonymous = known.identify(TEXT), known.anonymous
    assert anonymous is not None
    assert known.current(tablet) == tablet
    demoted = TOKEN.model_copy(update={"role": "viewer"})
    policy = Policy(AccessConfig(viewer=ViewerConfig(subscribe=("/a",))))
    known.tokens, known.policy = Tokens((demoted,)), policy
    now = known.current(tablet)
    assert now is not None
    assert (now.role, now.permissions) == ("viewer", policy.of("viewer"))
    unnamed = known.current(anonymous)
    assert unnamed is not None
    assert unnamed.permissions is policy.of("viewer")
    known.tokens = Tokens()
    assert known.current(tablet) is None
