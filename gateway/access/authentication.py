# SPDX-License-Identifier: Apache-2.0
"""Identities of clients, by their tokens or without one."""

from gateway.access.permissions import Identity, Policy
from gateway.access.tokens import Tokens
from gateway.config.access import Role

ANONYMOUS = "anonymous"


class AuthenticationError(Exception):
    """Raised when a token is not valid."""


class Authentication:
    """The tokens and the policy in force. A reload replaces both.

    *anonymous_role* is the role of clients without a token, ``None`` if they need one.
    """

    def __init__(self, tokens: Tokens, policy: Policy, anonymous_role: Role | None) -> None:
        self.tokens = tokens
        self.policy = policy
        self._anonymous_role = anonymous_role

    def replace(self, tokens: Tokens, policy: Policy | None = None) -> None:
        """Use other tokens from now on, and another policy."""
        self.tokens = tokens
        self.policy = policy or self.policy

    @property
    def anonymous(self) -> Identity | None:
        """The identity of clients without a token, or ``None`` if they need one."""
        if self._anonymous_role is None:
            return None
        return Identity(ANONYMOUS, self.policy.of(self._anonymous_role))

    def without_token(self, *, is_local_page: bool) -> Identity | None:
        """Return who a client without a token is, as `anonymous` does.

        A page of another server on this machine gets no more than the role `page` permits.
        """
        anonymous = self.anonymous
        if anonymous is None or not is_local_page or anonymous.role == "viewer":
            return anonymous
        return Identity(ANONYMOUS, self.policy.of("page"))

    @property
    def looks_at_tokens(self) -> bool:
        """True if a token makes a difference: not if every client may do everything."""
        anonymous = self.anonymous
        return anonymous is None or not anonymous.permissions.is_unlimited

    def identify(self, token: str) -> Identity:
        """Return the identity of the client with this token.

        Wrong ones of its address are not counted. Other clients behind the same router or proxy
        must not lock it out, and nobody can find a token by trying.

        Raises:
            AuthenticationError: the token is not valid.
        """
        found = self.tokens.find(token)
        if found is None:
            raise AuthenticationError("the token is wrong")
        return Identity(found.name, self.policy.of(found.role), found.digest)

    def current(self, identity: Identity) -> Identity | None:
        """Return who a client is after a reload, or ``None`` if its token was revoked."""
        if identity.digest is None:
            return Identity(identity.name, self.policy.of(identity.role))
        found = self.tokens.with_digest(identity.digest)
        if found is None:
            return None
        return Identity(found.name, self.policy.of(found.role), found.digest)
