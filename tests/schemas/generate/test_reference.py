# SPDX-License-Identifier: Apache-2.0
"""The reference page of messages."""

import re

from schemas.generate.catalogue import Catalogue
from schemas.generate.reference import write
from schemas.installed import InstalledDefinitions
from schemas.table import Row, Table


def page(table):
    return write(Catalogue.of(table, InstalledDefinitions()))["docs/reference/messages.md"]


def test_every_row_of_every_table_has_as_many_cells_as_its_head():
    for block in re.split(r"\n\n", page(Table.load())):
        rows = [line for line in block.splitlines() if line.startswith("|")]
        cells = {len(re.findall(r"(?<!\\)\|", row)) for row in rows}
        assert len(cells) <= 1, block


def test_a_type_is_shown_with_number_purpose_fields_and_defaults():
    row = Row(number=3, name="geometry_msgs/msg/Quaternion", directions="both", purpose="To turn")
    text = page(Table.of([row]))

    assert "| 3 | [geometry_msgs/msg/Quaternion](#geometry_msgs-msg-quaternion) | both" in text
    assert "Number 3. To turn." in text
    assert "| w | float64 | `1.0` |  |" in text
