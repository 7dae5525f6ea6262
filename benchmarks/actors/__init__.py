# SPDX-License-Identifier: Apache-2.0
"""The programs that scenarios start, each in a separate process."""
