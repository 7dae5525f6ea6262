# SPDX-License-Identifier: Apache-2.0
"""Turns recordings of the gateway into a LeRobot dataset. It is not part of the gateway."""
