# SPDX-License-Identifier: Apache-2.0
"""The messages in the files of services and actions."""

from contextlib import suppress

import pytest
from hypothesis import given
from hypothesis import strategies as st

from schemas.definition import DefinitionError
from schemas.interface import parse_interface, part_name

SERVICE = "some_msgs/srv/Thing"
ACTION = "some_msgs/action/Thing"


def fields(part):
    return [field.name for field in part.fields]


def test_a_service_is_a_request_and_a_response():
    service = parse_interface(SERVICE, "int8 a\nint8 b\n---\nint8 c\n")

    assert list(service.parts) == ["request", "response"]
    assert [part.name for part in service.parts.values()] == [
        "some_msgs/srv/Thing_Request",
        "some_msgs/srv/Thing_Response",
    ]
    assert [fields(part) for part in service.parts.values()] == [["a", "b"], ["c"]]
    assert service.package == "some_msgs"


def test_an_action_is_a_goal_a_result_and_a_feedback():
    action = parse_interface(ACTION, "int8 a\n---\nint8 b\n---\nint8 c")

    assert list(action.parts) == ["goal", "result", "feedback"]
    assert [fields(part) for part in action.parts.values()] == [["a"], ["b"], ["c"]]
    assert action.parts["feedback"].name == part_name(ACTION, "feedback") == f"{ACTION}_Feedback"


@pytest.mark.parametrize("text", ["---", "---\n", "\n---\n\n", "# no field\n---\n# none"])
def test_parts_may_be_empty(text):
    service = parse_interface(SERVICE, text)

    assert [part.fields for part in service.parts.values()] == [(), ()]


def test_only_three_dashes_alone_on_their_line_separate():
    text = "# ---\nstring a '---'\nstring<=3 b # ---\n# a line:\n#---\n---\nint8 c"
    service = parse_interface(SERVICE, text)

    assert [fields(part) for part in service.parts.values()] == [["a", "b"], ["c"]]


def test_lines_may_end_as_on_windows():
    service = parse_interface(SERVICE, "int8 a # one\r\n---\r\nint8 b 2\r\n")

    assert [fields(part) for part in service.parts.values()] == [["a"], ["b"]]
    assert service.parts["request"].fields[0].comment == "one"
    assert service.parts["response"].fields[0].default == 2


def test_each_part_keeps_its_own_comments_constants_and_text():
    text = "# What it does.\n\nint8 ONE=1\nint8 a # first\n---\n# Says how it went.\nint8 b\n"
    request, response = parse_interface(SERVICE, text).parts.values()

    assert request.comment == "What it does."
    assert [constant.name for constant in request.constants] == ["ONE"]
    assert (response.comment, response.fields[0].comment) == ("", "Says how it went.")
    assert (request.text, response.text) == (text.split("---\n")[0], text.split("---\n")[1])


def test_a_type_without_package_is_a_message_of_the_same_package():
    (request, _) = parse_interface(SERVICE, "Part part\n---").parts.values()

    assert request.fields[0].type.base == "some_msgs/msg/Part"


@pytest.mark.parametrize(
    ("name", "text", "expected", "got"),
    [
        (SERVICE, "int8 a", "2 parts (request, response)", 1),
        (SERVICE, "---\n---", "2 parts (request, response)", 3),
        (ACTION, "---", "3 parts (goal, result, feedback)", 2),
    ],
)
def test_another_number_of_parts_raises_definition_error(name, text, expected, got):
    with pytest.raises(DefinitionError) as caught:
        parse_interface(name, text)
    assert str(caught.value) == (
        f"{name}: expected {expected} with a line --- between them, got {got}"
    )


# to rosidl the first two are declarations too, which it refuses
@pytest.mark.parametrize("line", ["--- ", " ---", "----", "???"])
def test_a_bad_line_raises_definition_error_with_its_part_and_its_line_in_the_file(line):
    with pytest.raises(DefinitionError, match=r"^some_msgs/srv/Thing_Response, line 4: "):
        parse_interface(SERVICE, f"int8 a\n---\nint8 b\n{line}")


LINES = st.one_of(
    st.sampled_from(["---", "", "# words", "T[] nested"]),
    st.builds(
        "{} {}{}{}".format,
        st.sampled_from(["int8", "string", "string<=2[]", "float64[3]", "bool", "byte[<=2]", "T"]),
        st.sampled_from(["a", "A", "_", "1"]),
        st.sampled_from([" ", "=", " # "]),
        st.text("[]'\"\\\\,1ax. ", max_size=8),
    ),
    st.text(max_size=8),
)


@given(st.sampled_from([SERVICE, ACTION]), st.lists(LINES, max_size=6))
def test_nothing_but_a_definition_error_comes_out_of_any_text(name, lines):
    with suppress(DefinitionError):
        parse_interface(name, "\n".join(lines))


def test_the_installed_hashes_are_those_of_the_whole_and_of_its_parts():
    hashes = {SERVICE: "RIHS01_0", f"{SERVICE}_Request": "RIHS01_1"}
    service = parse_interface(SERVICE, "---", hashes)

    assert service.type_hash == "RIHS01_0"
    assert [part.type_hash for part in service.parts.values()] == ["RIHS01_1", None]


def test_people_are_told_of_the_request_of_a_service_and_of_the_goal_of_an_action():
    service = parse_interface(SERVICE, "---")
    action = parse_interface(ACTION, "---\n---")

    assert service.parts["request"].title == "the some_msgs/srv/Thing request"
    assert action.parts["goal"].title == "the some_msgs/action/Thing goal"
