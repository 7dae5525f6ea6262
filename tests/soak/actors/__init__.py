# SPDX-License-Identifier: Apache-2.0
"""The programs of the soak, each a separate process. They end with their standard input."""
