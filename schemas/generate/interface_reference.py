# SPDX-License-Identifier: Apache-2.0
"""Write the reference page of services and actions: the table, and every type with its parts."""

from typing import Final

from schemas.generate.catalogue import GENERATED, Catalogue, by_package
from schemas.generate.markdown import anchor, members
from schemas.interface import Interface
from schemas.table import InterfaceRow

_MESSAGES: Final = "messages.md"  # beside this page

_INTRODUCTION: Final = f"""\
<!-- {GENERATED} -->
# Services and actions

Clients name a type as `pkg/srv/Name` or `pkg/action/Name`, or as `pkg/Name`. What JSON carries, and
the types that are nested here, stand on the page of [messages]({_MESSAGES}). Services and actions
outside this table work too, if their packages or their definitions are installed on the machine
of the gateway. [Your own messages](../how-to/own-messages.md) says how, and what a row here is
good for.

A field that a client leaves out gets its default; one that the type does not have is refused. Where
a client sends an array instead of an object, its elements are the values of the fields in the order
of the tables below.
"""


def write(catalogue: Catalogue) -> dict[str, str]:
    """Return the page."""
    rows = {row.name: row for row in catalogue.interface_rows}
    parts = [_INTRODUCTION, "| type | purpose |\n|---|---|"]
    parts += [f"| [{name}](#{anchor(name)}) | {row.purpose} |" for name, row in rows.items()]
    for package, interfaces in by_package(catalogue.interfaces.values()).items():
        parts.append(f"\n## {package}")
        parts += [_section(interface, rows[interface.name]) for interface in interfaces]
    return {"docs/reference/services.md": "\n".join(parts) + "\n"}


def _section(interface: Interface, row: InterfaceRow) -> str:
    lines = [f'\n### <a id="{anchor(interface.name)}"></a>{interface.name}\n']
    lines.append(f"{row.purpose}.")
    for role, part in interface.parts.items():
        lines += [f"\n**{role.capitalize()}**\n", *members(part, _MESSAGES)]
    return "\n".join(lines)
