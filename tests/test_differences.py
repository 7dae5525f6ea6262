# SPDX-License-Identifier: Apache-2.0
"""Each difference from rosbridge that docs/reference/rosbridge-differences.md lists has a test."""

import ast
import re
from pathlib import Path

REPOSITORY = Path(__file__).parents[1]
PAGE = REPOSITORY / "docs/reference/rosbridge-differences.md"
SECTION = "## Differences from rosbridge_suite"

SUBSCRIPTIONS = "core/topics/test_subscriptions.py"
CLIENT_SERVICES = "core/services/test_client_services.py"
CALLS = "core/services/test_service_calls.py"
PUBLICATIONS = "core/topics/test_publications.py"
CLIENT_ACTIONS = "core/actions/test_client_actions.py"
GOALS = "core/actions/test_goals.py"
FRAGMENTS = "fronts/rosbridge/test_fragments.py"
OPERATIONS = "fronts/rosbridge/test_operations.py"
PERMISSIONS = "core/test_permission_checks.py"
DRIVE = "drive/test_drive.py"
BAD_INPUT = "core/test_bad_input.py"

# The beginning of each item on the page, and the tests that fail without it.
TESTS = {
    "**Refusals:**": [
        f"{BAD_INPUT}::test_every_operation_that_is_refused_is_answered_with_its_id",
        f"{CALLS}::test_a_call_that_fails_is_answered_with_the_reason",
        f"{CALLS}::test_a_call_whose_server_dies_is_answered",
        f"{CALLS}::test_a_call_that_nobody_answers_times_out",
        f"{GOALS}::test_a_goal_whose_server_dies_is_answered",
    ],
    "**Waiting:**": [
        f"{CALLS}::test_calls_do_not_wait_for_each_other",
        "clients/test_services.py::test_a_slow_service_holds_up_nothing_else",
        "clients/test_actions.py::test_several_goals_at_once_keep_apart",
    ],
    "**Time limit:**": [
        f"{CALLS}::test_a_call_that_nobody_answers_times_out",
        f"{CALLS}::test_no_time_limit_is_a_long_one",
    ],
    "**Types**": [
        f"{PUBLICATIONS}::test_a_message_that_does_not_fit_its_type_is_refused_with_its_path",
    ],
    "**Type of a call:**": [
        f"{CALLS}::test_a_service_of_another_type_is_not_called",
        f"{CALLS}::test_the_type_may_be_said",
        f"{CALLS}::test_rosapi_takes_any_type",
    ],
    "**NUL:**": [
        "codec/test_validation.py::test_text_without_encoding_is_refused_in_words",
    ],
    "**Long `args`:**": [
        f"{CALLS}::test_a_call_that_fails_is_answered_with_the_reason",
    ],
    "**Frames:**": [
        "codec/test_json.py::test_invalid_json_raises_json_error_with_the_place",
    ],
    "**`float32`**": [
        "codec/cdr/test_float32.py::test_every_float32_is_spelled_as_numpy_spells_it",
    ],
    "**Duplicate keys**": [
        "codec/test_json.py::test_a_duplicate_key_raises_json_error_naming_it",
    ],
    "**NaN and infinities**": [
        "codec/cdr/test_decoder.py::test_non_finite_floats_are_kept_and_written_as_null",
        "codec/test_types.py::test_null_reaches_ros_as_nan",
    ],
    "**`nanosec`**": [
        f"{PUBLICATIONS}::test_a_stamp_is_relayed_as_it_is",
        "codec/test_types.py::test_a_time_is_the_same_on_both_sides_whatever_its_nanoseconds",
        "e2e/test_message_table.py::test_messages_of_a_robot_reach_a_client",
        "e2e/test_message_table.py::test_messages_of_a_client_reach_a_robot",
        f"{OPERATIONS}::test_the_last_value_within_a_bound_is_taken_and_the_first_beyond_it_refused",
    ],
    "**Throttle:**": [
        "core/topics/test_topic.py::test_a_throttled_subscription_gets_the_newest_at_the_end_and_counts_the_others",
    ],
    "**Queues**": [
        "core/test_outbox.py::test_a_full_queue_drops_its_oldest_entry_and_counts_it",
        f"{SUBSCRIPTIONS}::test_meta_numbers_samples_and_counts_what_was_dropped",
    ],
    "**Slow clients:**": [
        "transport/test_server.py::test_a_client_that_accepts_nothing_is_cut_off_and_does_not_disturb_others",
        "transport/test_server.py::test_a_client_that_answers_no_ping_stays_and_a_late_answer_is_measured",
    ],
    "**Durability:**": [
        "sources/test_qos.py::test_reliable_and_transient_local_only_if_all_are",
    ],
    "**Images:**": [
        f"{SUBSCRIPTIONS}::test_an_image_comes_as_jpeg_in_the_shape_of_compressed_image",
        f"{SUBSCRIPTIONS}::test_raw_pixels_and_single_fields_of_an_image_come_when_asked_for",
        f"{SUBSCRIPTIONS}::test_the_default_format_is_that_of_the_connection",
    ],
    "**After a client leaves,**": [
        "clients/test_many.py::test_a_client_that_is_killed_leaves_nothing",
        f"{CLIENT_SERVICES}::test_a_client_that_leaves_lets_its_calls_fail",
        f"{GOALS}::test_a_client_that_leaves_cancels_its_goals",
        f"{PUBLICATIONS}::test_publishers_go_with_their_client",
    ],
    '**`"result":false`**': [
        f"{CLIENT_SERVICES}::test_a_failure_without_values_reaches_the_caller_as_one",
        f"{CLIENT_SERVICES}::test_a_failure_with_values_passes_them_on_with_a_warning",
    ],
    "**`action_result`**": [
        f"{CLIENT_ACTIONS}::test_a_result_may_leave_out_what_old_clients_leave_out",
    ],
    "**`fragment_size`**": [
        "fronts/rosbridge/test_session.py::test_an_answer_is_cut_only_where_that_is_asked_for",
        "fronts/rosbridge/test_session.py::test_a_malformed_fragment_is_answered_with_its_id",
        f"{FRAGMENTS}::test_pieces_of_several_messages_come_in_any_order_and_twice",
    ],
    "**CBOR:**": [
        "codec/cdr/test_to_cbor.py::test_arrays_of_numbers_are_typed_short_and_empty_ones_too",
    ],
    "**`auth`**": [
        f"{PERMISSIONS}::test_auth_goes_to_who_knows_the_tokens_and_is_ignored_where_nobody_does",
        "schemas/test_message.py::test_a_value_is_taken",
    ],
    "**Small fragments:**": [
        f"{OPERATIONS}::test_the_last_value_within_a_bound_is_taken_and_the_first_beyond_it_refused",
        f"{CALLS}::test_a_call_that_fails_is_answered_with_the_reason",
    ],
    "**Killed nodes**": [
        f"{GOALS}::test_a_goal_whose_server_dies_is_answered",
    ],
    "**Web pages:**": [
        "access/test_web_rules.py::test_a_page_of_another_server_on_this_machine_is_local",
        f"{PERMISSIONS}::test_a_local_page_watches_and_calls_but_does_not_drive",
        "transport/test_server.py::test_only_own_pages_and_allowed_ones_connect",
        "transport/test_server.py::test_a_refused_page_is_logged_once_with_the_setting_that_allows_it",
    ],
    "**Limits:**": [
        f"{SUBSCRIPTIONS}::test_subscriptions_are_limited_per_client",
        f"{PUBLICATIONS}::test_advertisements_are_limited_per_client",
        "transport/test_server.py::test_one_address_cannot_take_all_places",
    ],
    "**Command topics**": [
        "core/commands/test_commands.py::test_the_publisher_is_reliable_and_keeps_one_command_for_a_moment",
    ],
    "**Stop:**": [
        f"{DRIVE}::test_rule",
    ],
}


def rows():
    """Return the rows of the page, each on one line."""
    section = PAGE.read_text(encoding="utf-8").partition(SECTION)[2].partition("\n## ")[0]
    found = re.findall(r"^- (.*(?:\n {2}.*)*)", section, re.MULTILINE)
    return [" ".join(row.split()) for row in found]


def functions_in(path):
    tree = ast.parse(path.read_text(encoding="utf-8"))
    return {
        node.name
        for node in ast.walk(tree)
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)
    }


def test_every_difference_has_tests():
    for row in rows():
        begun = [beginning for beginning in TESTS if row.startswith(beginning)]
        assert len(begun) == 1, f"name the tests of this row in TESTS: {row}"
    assert len(rows()) == len(TESTS) > 15
    assert all(TESTS.values())


def test_each_named_test_is_there():
    named = {tuple(name.split("::")) for names in TESTS.values() for name in names}
    there = {path: functions_in(REPOSITORY / "tests" / path) for path, _ in named}
    assert sorted((path, name) for path, name in named if name not in there[path]) == []
