# SPDX-License-Identifier: Apache-2.0
"""A sum of /metrics that does not come out is found."""

from tests.soak.accounting import Accounting

PAGE = """\
# HELP ros2_gateway_client_messages_received_total For a client.
# TYPE ros2_gateway_client_messages_received_total counter
ros2_gateway_client_messages_received_total{client="1",topic="/a"} 10
ros2_gateway_client_messages_sent_total{client="1",topic="/a"} 4
ros2_gateway_client_messages_coalesced_total{topic="/a",client="1"} 3
ros2_gateway_client_messages_dropped_total{client="1",topic="/a"} 2
ros2_gateway_client_messages_pending{client="1",topic="/a"} 1
ros2_gateway_ros_entities 7
"""


def checked(page: str) -> Accounting:
    accounting = Accounting()
    accounting.check(page)
    return accounting


def test_a_correct_sum_is_not_a_fault():
    found = checked(PAGE)
    assert (found.sums, found.faults) == (1, [])


def test_a_drop_that_is_not_counted_is_found():
    found = checked(PAGE.replace('dropped_total{client="1",topic="/a"} 2', "dropped_total 1"))
    [fault] = found.faults
    assert fault.startswith("('1', '/a'): received 10, but sent_total 4 + ")


def test_a_page_without_clients_has_no_sums():
    assert checked("ros2_gateway_ros_entities 7\n").sums == 0
