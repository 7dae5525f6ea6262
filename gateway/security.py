# SPDX-License-Identifier: Apache-2.0
"""Access as it is configured: tokens, permissions, certificate, audit log."""

import contextlib
import logging
import ssl
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from gateway.access import token_file
from gateway.access.audit import Audit
from gateway.access.audit_file import AuditFile
from gateway.access.authentication import Authentication
from gateway.access.permissions import Policy
from gateway.access.posture import Posture
from gateway.access.tokens import TokenFileError, Tokens, make_token
from gateway.access.web_rules import WebRules
from gateway.access_files import (
    exposed_secrets,
    load_certificate,
    now_text,
    read_access,
    read_tokens,
    token_path,
)
from gateway.config.model import Config
from gateway.faults import Fault
from gateway.transport.http import own_names

logger = logging.getLogger(__name__)

# created if tokens are needed and the file has no token
FIRST_NAME: Final = "first"
FIRST_ROLE: Final = "operator"


@dataclass(frozen=True)
class Security:
    """The parts that decide who may connect and do what."""

    posture: Posture
    authentication: Authentication
    audit: Audit
    rules: WebRules
    tls: ssl.SSLContext | None
    token_path: Path
    new_token: str | None  # created just now, shown once, and kept nowhere
    audit_faults: Callable[[], Sequence[Fault]]

    def reload(self, config: Config) -> tuple[Tokens, Policy]:
        """Read what may change while the gateway runs: tokens, permissions, the certificate.

        Raises:
            ConfigError: something is wrong. Nothing has changed.
        """
        tokens = Tokens()
        if self.authentication.looks_at_tokens:
            path = token_path(config)
            tokens = read_tokens(path)
            if self.authentication.tokens.known and not path.exists():
                # the file was moved, or could never be written: that must not lock everybody out
                logger.warning("%s is missing: the old tokens stay valid", path)
                tokens = self.authentication.tokens
        if self.tls is not None and config.tls.cert is not None:
            load_certificate(self.tls, config.tls)
        return tokens, Policy(config.access)


@contextlib.contextmanager
def open_security(config: Config) -> Iterator[Security]:
    """Open everything, and create a first token if one is needed.

    Raises:
        ConfigError: the configuration contradicts itself, or a file that it names is unusable.
    """
    posture, tls, authentication = read_access(config)
    for sentence in exposed_secrets(config):
        logger.warning("%s", sentence)
    path = token_path(config)
    new_token = None
    if posture.needs_token and not authentication.tokens.known:
        new_token = _make_first(authentication, path)
    # a proxy may bring pages of other machines, whose localhost is another one
    is_local = not posture.is_open and not config.trusted_proxies
    rules = WebRules(
        own_names(), config.allowed_hosts, config.allowed_origins, allows_local=is_local
    )
    with _audit(config, is_wanted=posture.is_open or posture.needs_token) as (audit, faults):
        yield Security(posture, authentication, audit, rules, tls, path, new_token, faults)


def _make_first(authentication: Authentication, path: Path) -> str:
    text, token = make_token(FIRST_NAME, FIRST_ROLE, now_text())
    try:
        token_file.change(path, lambda tokens: tokens.added(token))
    except TokenFileError as error:
        # a container with read-only files must start anyway, and stay closed
        logger.warning("%s: the new token is valid until the gateway ends", error)
    authentication.replace(Tokens((token,)))
    return text


@contextlib.contextmanager
def _audit(
    config: Config, *, is_wanted: bool
) -> Iterator[tuple[Audit, Callable[[], Sequence[Fault]]]]:
    """Open the audit log. Without a network and without a file, its level is debug."""
    path = config.audit.file
    level = logging.INFO if is_wanted or path is not None else logging.DEBUG
    if path is None:
        yield Audit(time.time_ns, level=level), tuple
        return
    file = AuditFile(Path(path), config.audit.max_bytes)
    try:
        yield Audit(time.time_ns, file.write, level), file.faults
    finally:
        file.close()
