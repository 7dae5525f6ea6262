# SPDX-License-Identifier: Apache-2.0
"""The bounds of a client that nobody configures; the others are in `gateway.config.limits`."""

MAX_WAITING_CALLS = 256  # a page that asks for all parameters of a robot when it starts

DEFAULT_QUEUE_LENGTH = 100  # 1 s at 100 Hz: rides out a WiFi hiccup without losing odometry
DEFAULT_QUEUE_BYTES = 256 * 1024  # but of big messages only the newest few: pictures stay fresh
