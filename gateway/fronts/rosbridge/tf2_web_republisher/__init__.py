# SPDX-License-Identifier: Apache-2.0
"""tf2_web_republisher, which clients of roslib and roslibpy ask for transforms."""
