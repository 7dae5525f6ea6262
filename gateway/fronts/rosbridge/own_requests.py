# SPDX-License-Identifier: Apache-2.0
"""The requests that this front carries out itself."""

from dataclasses import dataclass
from typing import TypeAlias

from gateway.core.errors import Level
from gateway.core.requests import Request


class FrontRequest(Request):
    """The base of these."""

    needs_permission = False


@dataclass(frozen=True, kw_only=True)
class SetLevelRequest(FrontRequest):
    """Choose the reports that the client gets."""

    kind = "set_level"
    level: Level


@dataclass(frozen=True, kw_only=True)
class HelpRequest(FrontRequest):
    """Ask for lines to try."""

    kind = "help"


@dataclass(frozen=True, kw_only=True)
class LogRequest(FrontRequest):
    """Ask for the last lines of ``/rosout``."""

    kind = "log"


@dataclass(frozen=True, kw_only=True)
class AuthRequest(FrontRequest):
    """Show a token."""

    kind = "auth"
    token: str | None


OwnRequest: TypeAlias = SetLevelRequest | HelpRequest | LogRequest | AuthRequest
