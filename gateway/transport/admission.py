# SPDX-License-Identifier: Apache-2.0
"""Admission: the identity of a client, from its handshake or first frame, and after a reload."""

import logging
import time
from collections import Counter
from collections.abc import Callable, Iterable
from typing import Final, Protocol

from websockets.datastructures import Headers
from websockets.http11 import Request

from gateway.access.audit import Audit
from gateway.access.authentication import Authentication, AuthenticationError
from gateway.access.credentials import token_in
from gateway.access.permissions import Identity, Policy
from gateway.access.tokens import Tokens
from gateway.access.web_rules import WebRules
from gateway.config.access import AccessConfig
from gateway.core.errors import ProtocolError, StatusCode
from gateway.core.requests import Request as CoreRequest
from gateway.transport.close_codes import (
    GOING_AWAY,
    OVER_CAPACITY,
    POLICY_VIOLATION,
    ROLE_REMOVED,
    UNAUTHENTICATED,
)
from gateway.transport.front import ClientSession
from gateway.transport.http import offered_subprotocols
from gateway.transport.http_connection import HttpConnection

# Operations that are refused with an answer before a client is cut off. A page may subscribe to all
# that it shows before it sends the token, and gets an answer to each.
MAX_REFUSALS: Final = 64


class ClientConnection(Protocol):
    """The part of a connection that admission needs."""

    address: str
    is_encrypted: bool  # by TLS

    @property
    def name(self) -> str:
        """The address and number, for the log."""

    @property
    def session(self) -> ClientSession | None:
        """The session, while the WebSocket is open."""

    def close(self, code: int, reason: str) -> None:
        """Begin the closing handshake."""

    def limit_messages(self, max_bytes: int) -> None:
        """Accept messages of at most so many bytes from now on."""


RoomFor = Callable[[ClientConnection], str | None]


class NotAdmittedError(Exception):
    """Raised when a client is not admitted, with a close code and a text."""

    def __init__(self, close_code: int, status: StatusCode, reason: str) -> None:
        super().__init__(reason)
        self.close_code = close_code
        self.status: StatusCode = status


class Admission:
    """Admits clients, and limits the number of those that have not sent their token.

    *room_for* returns the reason why there is no room for another client, or ``None``. *rules* say
    which pages get less than a program would.
    """

    def __init__(
        self,
        authentication: Authentication,
        config: AccessConfig,
        audit: Audit,
        room_for: RoomFor,
        rules: WebRules,
    ) -> None:
        self._authentication = authentication
        self._config = config
        self._audit = audit
        self._room_for = room_for
        self._rules = rules
        self.failures: Counter[str] = Counter()  # of authentication, by kind
        self._waiting: dict[ClientConnection, float] = {}  # since when, the oldest first

    def __len__(self) -> int:
        """Count the clients that have not sent their token."""
        return len(self._waiting)

    def identify(self, connection: ClientConnection, headers: Headers) -> Identity | None:
        """Return who a client is by its handshake, or ``None`` if its first frame must say it.

        Raises:
            NotAdmittedError: the token is invalid, or there is no room.
        """
        identity = self._without_token(connection, headers)
        token = token_in(headers.get_all("Authorization"), offered_subprotocols(headers))
        if token is not None and self._authentication.looks_at_tokens:
            identity = self._identify(connection.address, token, connection.name)
        if identity is not None:
            self._check_room(connection)
        return identity

    def identify_scraper(
        self, connection: HttpConnection, address: str, headers: Headers
    ) -> Identity:
        """Return the identity behind an HTTP request for metrics or images.

        Raises:
            NotAdmittedError: the token is missing or wrong.
            CredentialsError: there are several tokens.
        """
        identity = self._without_token(connection, headers)
        token = token_in(headers.get_all("Authorization"), ())
        if token is not None and self._authentication.looks_at_tokens:
            return self._identify(address, token, None)
        if identity is None:
            reason = "send a token: Authorization: Bearer TOKEN"
            raise NotAdmittedError(UNAUTHENTICATED, "forbidden", reason)
        return identity

    def enter(
        self, connection: ClientConnection, session: ClientSession, request: Request, now_s: float
    ) -> None:
        """Take note of a client whose session has begun."""
        if session.identity is not None:
            self._record_connected(session, _shown_origin(request.headers))
            return
        self._waiting[connection] = now_s
        connection.limit_messages(self._config.unauthenticated_message_bytes)
        if len(self._waiting) > self._config.max_unauthenticated:
            self._make_room()

    def tick(self, now_s: float) -> None:
        """Refuse clients that send no token for too long, or too many other operations."""
        for connection, since_s in list(self._waiting.items()):
            session = connection.session
            if session is not None and session.refused > MAX_REFUSALS:
                self._refuse_waiting(
                    connection,
                    POLICY_VIOLATION,
                    "too many operations without a token: send the token first",
                )
            elif now_s - since_s > self._config.auth_timeout_s:
                reason = f"no token within {self._config.auth_timeout_s:g} s"
                self.failures["timeout"] += 1
                self._refuse_waiting(connection, UNAUTHENTICATED, reason)

    def left(self, connection: ClientConnection, session: ClientSession | None) -> None:
        """Forget a client."""
        self._waiting.pop(connection, None)
        if session is not None and session.identity is not None:
            identity = session.identity
            self._audit.record(
                "disconnected",
                client=session.client,
                name=identity.name,
                role=identity.role,
                address=session.address,
            )

    def reload(
        self,
        tokens: Tokens,
        policy: Policy,
        clients: Iterable[tuple[ClientConnection, ClientSession]],
    ) -> list[ClientSession]:
        """Use other tokens and permissions, and close the clients that these no longer fit.

        A client whose permissions have changed is also closed, so everything that it has open ends.
        It connects again with the new permissions. Return the sessions of closed clients.
        """
        ended = []
        self._authentication.replace(tokens, policy)
        for connection, session in clients:
            before = session.identity
            if before is None:
                continue
            now = self._authentication.current(before)
            if now is None:
                code, reason = UNAUTHENTICATED, "the token was revoked"
            elif now.role != before.role:
                code = ROLE_REMOVED
                reason = f"the role of the token is {now.role} now, not {before.role}"
            elif now.permissions.rules != before.permissions.rules:
                code = GOING_AWAY
                reason = f"the permissions of role {now.role} have changed, connect again"
            else:
                session.sign_in(now)
                continue
            self._audit.record(
                "revoked",
                client=connection.name,
                name=before.name,
                address=connection.address,
                code=code,
                reason=reason,
            )
            connection.close(code, reason)
            ended.append(session)
        return ended

    def authenticate(
        self,
        connection: ClientConnection,
        token: str | None,
        request: CoreRequest,
    ) -> None:
        """Take the token of a client.

        Raises:
            ProtocolError: the token is missing, or the client has signed in already.
        """
        session = connection.session
        if session is None:  # it has ended
            return
        if token is None:
            if session.identity is None:
                raise ProtocolError(
                    "bad_request",
                    "token is missing: send it as `token`, because rosbridge's `mac` is not used",
                )
            return  # from an old client, which needs no token
        if self._authentication.looks_at_tokens:
            try:
                self._take_token(connection, session, token)
            except NotAdmittedError as error:
                session.refuse(ProtocolError(error.status, str(error)), request)
                self._waiting.pop(connection, None)
                connection.close(error.close_code, str(error))
                return
        if request.id is not None and session.identity is not None:
            identity = session.identity
            session.answer(request.kind, request.id, name=identity.name, role=identity.role)

    def _take_token(self, connection: ClientConnection, session: ClientSession, token: str) -> None:
        identity = self._identify(connection.address, token, connection.name)
        before = session.identity
        if before is not None and before.digest is not None:
            if before.digest != identity.digest:
                text = f"this client is {before.name} already: connect again to be another"
                raise ProtocolError("bad_request", text)
            return
        if before is None:
            self._check_room(connection)
        self._waiting.pop(connection, None)
        session.sign_in(identity)
        connection.limit_messages(session.limits.max_message_bytes)
        self._record_connected(session, None)

    def _without_token(
        self, connection: ClientConnection | HttpConnection, headers: Headers
    ) -> Identity | None:
        origin, host = headers.get("Origin"), headers["Host"]
        standing = self._rules.standing(origin, host, is_encrypted=connection.is_encrypted)
        return self._authentication.without_token(is_local_page=standing == "local")

    def _identify(self, address: str, token: str, client: str | None) -> Identity:
        try:
            return self._authentication.identify(token)
        except AuthenticationError as error:
            self.failures["wrong"] += 1
            self._audit.record("refused", client=client, address=address, reason=str(error))
            raise NotAdmittedError(UNAUTHENTICATED, "forbidden", str(error)) from error

    def _check_room(self, connection: ClientConnection) -> None:
        reason = self._room_for(connection)
        if reason is not None:
            raise NotAdmittedError(OVER_CAPACITY, "limit_exceeded", reason)

    def _make_room(self) -> None:
        counts = Counter(connection.address for connection in self._waiting)
        oldest = max(self._waiting, key=lambda each: counts[each.address])  # the first of equals
        limit = self._config.max_unauthenticated
        reason = f"over capacity: at most {limit} clients without a token"
        self._refuse_waiting(oldest, OVER_CAPACITY, reason)

    def _refuse_waiting(self, connection: ClientConnection, code: int, reason: str) -> None:
        del self._waiting[connection]
        self._audit.record(
            "refused", client=connection.name, address=connection.address, reason=reason
        )
        connection.close(code, reason)

    def _record_connected(self, session: ClientSession, origin: str | None) -> None:
        assert session.identity is not None  # noqa: S101  # the callers have set it
        self._audit.record(
            "connected",
            client=session.client,
            name=session.identity.name,
            role=session.identity.role,
            address=session.address,
            origin=origin,
        )


def everybody(room_for: RoomFor, rules: WebRules) -> Admission:
    """Return an admission that needs no tokens."""
    policy = Policy(AccessConfig())
    audit = Audit(time.time_ns, level=logging.DEBUG)
    authentication = Authentication(Tokens(), policy, "admin")
    return Admission(authentication, AccessConfig(), audit, room_for, rules)


def _shown_origin(headers: Headers) -> str | None:
    values = headers.get_all("Origin")
    return values[0] if values else None
