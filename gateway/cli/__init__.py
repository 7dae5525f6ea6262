# SPDX-License-Identifier: Apache-2.0
"""The command line: arguments to configuration to exit code; the only room that prints.

docs/contributing/architecture.md shows it among the others.
"""
