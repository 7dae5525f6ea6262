# SPDX-License-Identifier: Apache-2.0
"""The settings of Zenoh by which a router knows who connects, and is known itself."""

import ssl
from pathlib import Path

from gateway.config.zenoh import ZenohLinkConfig
from gateway.errors import ConfigError, system_reason
from gateway.sources.zenoh.unusable import TLS, USER


def link_settings(config: ZenohLinkConfig, section: str) -> dict[str, object]:
    """Return what `gateway.sources.zenoh.options.ZenohOptions` takes as settings.

    Raises:
        ConfigError: settings of the *section* contradict each other, or a file cannot be read.
    """
    if (config.cert is None) != (config.key is None):
        raise ConfigError(f"{section}.cert and {section}.key belong together: set both")
    if (config.user is None) != (config.user_file is None):
        raise ConfigError(f"{section}.user and {section}.user_file belong together: set both")
    _check_certificates(config, section)
    settings: dict[str, object] = {}
    if config.ca is not None:
        settings[f"{TLS}/root_ca_certificate"] = config.ca
    if config.cert is not None:
        settings[f"{TLS}/connect_certificate"] = config.cert
        settings[f"{TLS}/connect_private_key"] = config.key
        settings[f"{TLS}/enable_mtls"] = True
    if config.user_file is not None:
        settings[f"{USER}/user"] = config.user
        settings[f"{USER}/password"] = _password(config.user_file, f"{section}.user_file")
    return settings


def _check_certificates(config: ZenohLinkConfig, section: str) -> None:
    """Check the files, of which Zenoh would only say that it cannot connect."""
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
    name = f"{section}.ca: {config.ca}"
    try:
        if config.ca is not None:
            context.load_verify_locations(config.ca)
        if config.cert is not None and config.key is not None:
            name = f"{section}.cert and {section}.key: {config.cert}, {config.key}"
            context.load_cert_chain(config.cert, config.key)
    except ssl.SSLError as error:
        why = f"no certificate in PEM, or no key that fits ({error.reason or error})"
        raise ConfigError(f"{name}: {why}") from error
    except OSError as error:
        raise ConfigError(f"{name}: cannot be read, {system_reason(error)}") from error


def _password(path: str, setting: str) -> str:
    try:
        password = Path(path).read_text(encoding="utf-8").strip()
    except (OSError, UnicodeDecodeError) as error:
        why = system_reason(error) if isinstance(error, OSError) else "it is not text"
        raise ConfigError(f"{setting}: {path} cannot be read, {why}") from error
    if not password:
        raise ConfigError(f"{setting}: {path} is empty: write the password into it")
    return password
