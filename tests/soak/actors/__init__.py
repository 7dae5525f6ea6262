# SPDX-License-Identifier: Apache-2.0
"""The programs of the soak, each a process of its own. They end with their standard input."""
