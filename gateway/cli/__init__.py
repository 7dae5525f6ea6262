# SPDX-License-Identifier: Apache-2.0
"""The command line: from arguments and configuration to an exit code. Only this package prints.

docs/contributing/architecture.md shows it among the others.
"""
