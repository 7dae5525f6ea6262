# SPDX-License-Identifier: Apache-2.0
"""A log line for each failed TLS handshake, which asyncio does not report."""

import logging
import ssl
from collections.abc import Mapping
from types import MappingProxyType
from typing import Final

logger = logging.getLogger(__name__)

_DISTRUST: Final = "the client does not trust the certificate"
# OpenSSL's names of what happens to people, in their words
_REASONS: Final[Mapping[str, str]] = MappingProxyType(
    {
        "HTTP_REQUEST": "the client speaks without TLS, it needs wss:// or https://",
        "WRONG_VERSION_NUMBER": "the client speaks without TLS, or by no protocol that is known",
        "TLSV1_ALERT_UNKNOWN_CA": _DISTRUST,
        "SSLV3_ALERT_CERTIFICATE_UNKNOWN": _DISTRUST,
        "SSLV3_ALERT_BAD_CERTIFICATE": _DISTRUST,
        "SSLV3_ALERT_CERTIFICATE_EXPIRED": "the client says that the certificate has expired",
    }
)


def log_failed_handshakes(context: ssl.SSLContext) -> None:
    """Let a context of a server log why handshakes fail.

    The address is not known there: `client` is ``?``, by which `gateway.log_rate` bounds the lines.
    """
    context.sslobject_class = _Logged


class _Logged(ssl.SSLObject):
    def do_handshake(self) -> None:
        """Go on with the handshake."""
        try:
            super().do_handshake()
        except (ssl.SSLWantReadError, ssl.SSLWantWriteError):  # it goes on later
            raise
        except ssl.SSLError as error:
            known = error.reason or "no reason given"
            why = _REASONS.get(known) or known.lower().replace("_", " ")
            logger.info("a TLS handshake failed: %s", why, extra={"client": "?"})
            raise
