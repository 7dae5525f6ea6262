# SPDX-License-Identifier: Apache-2.0
"""A process that wants all of a core."""

while True:
    pass
