# SPDX-License-Identifier: Apache-2.0
"""The definitions on this machine, for the commands that need no gateway."""

import argparse
from collections.abc import Mapping

from gateway.config.settings import load
from gateway.definitions import known_definitions
from schemas.installed import InstalledDefinitions


def local_definitions(
    arguments: argparse.Namespace, environment: Mapping[str, str]
) -> InstalledDefinitions:
    """Return those of installed packages and of the folders that options or a file name.

    Raises:
        ConfigError: a folder, or the configuration that names it, is wrong.
    """
    configured = load(environment=environment, file=arguments.config).config.types.paths
    sources = {"--types-path": arguments.types_path, "types.paths": configured}
    named = " or ".join(source for source, paths in sources.items() if paths)
    return known_definitions([*arguments.types_path, *configured], named)
