# SPDX-License-Identifier: Apache-2.0
"""The definitions that the gateway knows: installed, in folders that are named, and its own."""

from collections.abc import Iterable
from pathlib import Path

from gateway.core.rosapi.interfaces import interfaces_prefix
from gateway.errors import ConfigError
from schemas.folders import SHIPPED, STANDARD
from schemas.installed import InstalledDefinitions, installed_prefixes


def known_definitions(paths: Iterable[str | Path], source: str) -> InstalledDefinitions:
    """Return what is installed, in the folders *paths*, and shipped with the gateway.

    On a machine without ROS, the last of these are all that there is.

    Raises:
        ConfigError: a directory cannot be read. The text begins with *source*, which named it.
    """
    prefixes = [*installed_prefixes(), interfaces_prefix()]
    folders = [*(Path(path).expanduser() for path in paths), SHIPPED, STANDARD]
    try:
        return InstalledDefinitions(prefixes, folders)
    except OSError as error:
        place = f"{error.filename}: " if error.filename else ""
        raise ConfigError(f"{source}: {place}{(error.strerror or '').lower()}") from error
