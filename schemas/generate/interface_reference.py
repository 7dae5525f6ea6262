# SPDX-License-Identifier: Apache-2.0
"""Write the reference page of services and actions: the table, and every type with its parts."""

from typing import Final

from schemas.generate.catalogue import GENERATED, Catalogue, by_package
from schemas.generate.markdown import anchor, members
from schemas.interface import Interface
from schemas.table import InterfaceRow

_MESSAGES: Final = "messages.md"  # next to this page

_INTRODUCTION: Final = f"""\
<!-- {GENERATED} -->
# Services and actions

Look up a service or action type here: its parts, its fields, and its constants.

Clients name a type as `pkg/srv/Name`, as `pkg/action/Name`, or as `pkg/Name`. Nested types and the
values in JSON are in [Messages]({_MESSAGES}). Types that are not in this list also work.
[Use your own messages](../how-to/own-messages.md) explains how.

If a client leaves out a field, it gets its default. Unknown fields are refused. A client can also
send an array instead of an object: the values of the fields, in the order of the tables below.
"""


def write(catalogue: Catalogue) -> dict[str, str]:
    """Return the page."""
    rows = {row.name: row for row in catalogue.interface_rows}
    parts = [_INTRODUCTION, "| Type | Purpose |\n|---|---|"]
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
