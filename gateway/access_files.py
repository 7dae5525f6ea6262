# SPDX-License-Identifier: Apache-2.0
"""Read the access rules and their files.

This module is light, because commands that check a configuration need no server.
"""

import os
import ssl
from datetime import datetime, timezone
from pathlib import Path

from gateway.access import token_file
from gateway.access.authentication import Authentication
from gateway.access.permissions import Policy
from gateway.access.posture import Posture, posture_of
from gateway.access.tokens import TokenFileError, Tokens
from gateway.config.access import TlsConfig
from gateway.config.model import Config
from gateway.config.secrets import exposure
from gateway.errors import ConfigError, system_reason


def read_access(config: Config) -> tuple[Posture, ssl.SSLContext | None, Authentication]:
    """Read the access rules, and the files that they name. Write nothing.

    Raises:
        ConfigError: the configuration contradicts itself, or a file that it names is unusable.
    """
    posture = posture_of(config)
    tls = tls_context(config.tls)
    authentication = Authentication(Tokens(), Policy(config.access), posture.anonymous_role)
    if authentication.looks_at_tokens:
        authentication.replace(read_tokens(token_path(config)))
    return posture, tls, authentication


def token_path(config: Config) -> Path:
    """Return the path of the token file."""
    if config.access.token_file is not None:
        return Path(config.access.token_file)
    return token_file.default_path(os.environ)


def read_tokens(path: Path) -> Tokens:
    """Read the token file.

    Raises:
        ConfigError: the file is unusable.
    """
    try:
        return token_file.read(path)
    except TokenFileError as error:
        raise ConfigError(f"access.token_file: {error}") from error


def tls_context(config: TlsConfig) -> ssl.SSLContext | None:
    """Return the context of a certificate, or ``None`` if none is configured.

    Raises:
        ConfigError: the certificate or the key cannot be used.
    """
    if config.cert is None:
        if config.key is not None:
            raise ConfigError("tls.key: needs tls.cert, which is missing: set both")
        if config.port is not None:
            raise ConfigError("tls.port: needs tls.cert here, which is missing: set both")
        return None
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    context.minimum_version = ssl.TLSVersion.TLSv1_2
    load_certificate(context, config)
    return context


def exposed_secrets(config: Config) -> list[str]:
    """Return a sentence for each file with secrets that every user of this machine can read."""
    keys = [config.tls.key or config.tls.cert]
    paths = [token_path(config), *(Path(key) for key in keys if key is not None)]
    return [sentence for path in paths if (sentence := exposure(path))]


def now_text() -> str:
    """Return the time for the field `created` of a token."""
    return datetime.now(timezone.utc).isoformat(timespec="seconds")


def load_certificate(context: ssl.SSLContext, config: TlsConfig) -> None:
    """Have a context use the certificate from now on.

    Raises:
        ConfigError: the certificate or the key cannot be used.
    """
    assert config.cert is not None  # noqa: S101  # the callers have checked
    try:
        # with a password, an encrypted key is an error and not a question on the terminal
        context.load_cert_chain(config.cert, config.key, password="")
    except ssl.SSLError as error:
        which = f"{config.cert}" if config.key is None else f"{config.cert} and {config.key}"
        reason = (error.reason or "").lower().replace("_", " ")
        expected = "expected a certificate and its key, unencrypted, in PEM"
        raise ConfigError(f"tls.cert: cannot use {which}, {reason or expected}") from error
    except OSError as error:
        text = f"tls.cert, tls.key: cannot read the files, {system_reason(error)}"
        raise ConfigError(text) from error
