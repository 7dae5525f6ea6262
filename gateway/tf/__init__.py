# SPDX-License-Identifier: Apache-2.0
"""Where frames are in each other: a transform buffer as tf2 has it. Pure computation.

The map is docs/architecture.md.
"""

from typing import Final

TF_MESSAGE: Final = "tf2_msgs/msg/TFMessage"
