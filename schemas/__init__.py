# SPDX-License-Identifier: Apache-2.0
"""The message table, what is generated from it, and the definitions it is generated from."""
