# SPDX-License-Identifier: Apache-2.0
"""``python -m gateway`` is ``ros2-gateway``."""

import sys

from gateway.cli.main import main

sys.exit(main())
