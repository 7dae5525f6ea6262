# SPDX-License-Identifier: Apache-2.0
"""Moving a robot: the command topics."""
