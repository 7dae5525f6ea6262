# SPDX-License-Identifier: Apache-2.0
"""The command ``router``."""

import argparse
import json
import logging
import sys

from gateway.cli.output import announce
from gateway.cli.report import EXIT_OK
from gateway.errors import UsageError


def router(arguments: argparse.Namespace) -> int:
    """Run a router of Zenoh."""
    if sys.platform == "win32":
        raise UsageError("router: it does not run on Windows: start it on Linux")
    from gateway.cli.logs import configure_logging
    from gateway.cli.serving import require_zenoh

    require_zenoh("router")
    from gateway.relay import router as routers
    from gateway.relay.router_file import RouterConfig, checked, read_router_file

    config = RouterConfig() if arguments.config is None else read_router_file(arguments.config)
    if arguments.listen:
        config = checked({**config.model_dump(), "listen": arguments.listen}, "--listen")
    if arguments.print_config:
        settings = routers.settings_of(config, "(passwords)" if config.passwords else None)
        sys.stdout.write(json.dumps(settings, indent=2) + "\n")
        return EXIT_OK
    configure_logging("info", "text")
    routers.check(config, allows_everybody=arguments.open)
    for warning in routers.warnings(config, arguments.config):
        logging.getLogger("gateway").warning("%s", warning)
    who = "for everybody" if config.is_open else _counts(len(config.robots), len(config.relays))
    return routers.run(config, lambda: announce(f"routing on {', '.join(config.listen)}, {who}"))


def _counts(robots: int, relays: int) -> str:
    return f"for robots: {robots}, relays: {relays}"
