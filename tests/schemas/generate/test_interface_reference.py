# SPDX-License-Identifier: Apache-2.0
"""The reference page of services and actions."""

import re

import pytest

from schemas.generate import interface_reference, reference
from schemas.generate.catalogue import Catalogue
from schemas.installed import InstalledDefinitions
from schemas.table import InterfaceRow, Table


def catalogue_of(*names):
    rows = [InterfaceRow(name=name, purpose="Does it") for name in names]
    return Catalogue.of(Table.of([], rows), InstalledDefinitions())


def page(catalogue):
    return interface_reference.write(catalogue)["docs/reference/services.md"]


@pytest.fixture(scope="module")
def whole_table():
    return Catalogue.of(Table.load(), InstalledDefinitions())


def test_every_row_of_every_table_has_as_many_cells_as_its_head(whole_table):
    for block in re.split(r"\n\n", page(whole_table)):
        rows = [line for line in block.splitlines() if line.startswith("|")]
        cells = {len(re.findall(r"(?<!\\)\|", row)) for row in rows}
        assert len(cells) <= 1, block


def test_a_service_is_shown_with_purpose_request_and_response():
    text = page(catalogue_of("std_srvs/srv/Trigger"))
    section = text.partition("## std_srvs")[2]

    assert "Does it." in section
    request, response = section.split("**Request**")[1].split("**Response**")
    assert "No fields." in request
    assert "| message | string |" in response


def test_an_action_is_shown_with_goal_result_and_feedback_and_its_nested_messages():
    text = page(catalogue_of("test_msgs/action/NestedMessage"))

    assert re.findall(r"\*\*(\w+)\*\*", text) == ["Goal", "Result", "Feedback"]
    assert "[test_msgs/msg/Builtins](messages.md#test_msgs-msg-builtins)" in text


def test_nested_types_of_a_service_are_on_the_page_of_messages():
    messages = reference.write(catalogue_of("nav_msgs/srv/GetMap"))["docs/reference/messages.md"]

    assert '<a id="nav_msgs-msg-occupancygrid"></a>' in messages
