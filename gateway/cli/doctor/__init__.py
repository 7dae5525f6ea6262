# SPDX-License-Identifier: Apache-2.0
"""The command `ros2-gateway doctor`: checks of a machine, or of a running gateway."""
