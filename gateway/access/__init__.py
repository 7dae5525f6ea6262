# SPDX-License-Identifier: Apache-2.0
"""The rules of who may connect, and do what: tokens, roles, permissions, web pages, audit.

Time and bytes come as arguments. Only `token_file` and `audit_file` touch a disk. The map is
docs/contributing/architecture.md.
"""
