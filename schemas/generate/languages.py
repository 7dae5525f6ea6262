# SPDX-License-Identifier: Apache-2.0
"""The languages of clients' code, and the functions that write each."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final

from schemas.generate import (
    csharp_assembly,
    csharp_clients,
    json_clients,
    python_clients,
    typescript_clients,
)
from schemas.generate.request import GenerateRequest


@dataclass(frozen=True, slots=True)
class Language:
    """One language: ``files`` returns texts by relative path with ``/``, ``text`` one of all.

    Files whose names fit one of the patterns ``optional`` may as well be the user's own. ``notes``
    returns what people should know of the files.
    """

    files: Callable[[GenerateRequest], Mapping[str, str]]
    text: Callable[[GenerateRequest], str]
    optional: tuple[str, ...] = ()
    notes: Callable[[GenerateRequest], tuple[str, ...]] = lambda _: ()


LANGUAGES: Final[Mapping[str, Language]] = MappingProxyType(
    {
        "csharp": Language(
            csharp_clients.files,
            csharp_clients.text,
            (csharp_assembly.DEFINITIONS,),
            csharp_clients.notes,
        ),
        "typescript": Language(typescript_clients.files, typescript_clients.text),
        "python": Language(python_clients.files, python_clients.text, (python_clients.INIT,)),
        "json-schema": Language(json_clients.files, json_clients.text),
    }
)
