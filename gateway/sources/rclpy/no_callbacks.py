# SPDX-License-Identifier: Apache-2.0
"""Event callbacks for rclpy's entities that do nothing: rclpy's own need an executor.

See `gateway.sources.rclpy.qos_events`.
"""

from typing import Final

try:
    from rclpy.event_handler import PublisherEventCallbacks, SubscriptionEventCallbacks
except ImportError:  # their module before Iron
    from rclpy.qos_event import (
        PublisherEventCallbacks,
        SubscriptionEventCallbacks,
    )

NO_SUBSCRIPTION_EVENTS: Final = SubscriptionEventCallbacks(use_default_callbacks=False)
NO_PUBLISHER_EVENTS: Final = PublisherEventCallbacks(use_default_callbacks=False)
