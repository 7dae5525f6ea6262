# SPDX-License-Identifier: Apache-2.0
"""The message table, the files generated from it, and the definitions that they come from."""
