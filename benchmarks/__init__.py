# SPDX-License-Identifier: Apache-2.0
"""What the path from DDS to a socket costs, beside a bare rclpy subscriber in the same run."""
