# SPDX-License-Identifier: Apache-2.0
"""The limits, and their names on the wire."""

from gateway.config.limits import Limits

# Each value is unlike every other and unlike every default.
LIMITS = Limits(
    max_message_bytes=1201,
    max_json_depth=109,
    max_json_items=1310,
    max_name_characters=108,
    frames_per_s=1301,
    frame_burst=1302,
    client_time_share=0.13,
    address_time_share=0.14,
    max_subscriptions=1305,
    max_advertisements=1306,
    max_pending_calls=1312,
    max_goals=1313,
    max_transforms=1314,
    service_timeout_s=16,
    send_queue_bytes=65_537,
    max_queue_length=1311,
)


def test_hello_reports_the_limits_by_the_names_that_clients_know():
    assert LIMITS.for_hello() == {
        "message_bytes": 1201,
        "json_depth": 109,
        "json_items": 1310,
        "name_characters": 108,
        "frames_per_s": 1301,
        "frames_burst": 1302,
        "client_time_share": 0.13,
        "address_time_share": 0.14,
        "subscriptions": 1305,
        "advertisements": 1306,
        "pending_calls": 1312,
        "goals": 1313,
        "transforms": 1314,
        "service_timeout_s": 16,
        "send_queue_bytes": 65_537,
        "queue_length": 1311,
    }


def test_the_values_of_hello_cannot_be_mistaken_for_each_other_or_for_defaults():
    told = LIMITS.for_hello()
    assert len(set(told.values())) == len(told)
    assert not set(told.items()) & set(Limits().for_hello().items())
