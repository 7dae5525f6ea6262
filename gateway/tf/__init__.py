# SPDX-License-Identifier: Apache-2.0
"""A transform buffer like that of tf2. Pure computation.

The map is docs/contributing/architecture.md.
"""

from typing import Final

TF_MESSAGE: Final = "tf2_msgs/msg/TFMessage"
