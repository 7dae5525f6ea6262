# SPDX-License-Identifier: Apache-2.0
"""Measurements of the gateway itself, for /metrics and /diagnostics.

Pure computation: a `State` comes in, text or a diagnosis comes out. The only importer of
prometheus_client. The map is docs/contributing/architecture.md.
docs/reference/metrics.md lists the metrics.
"""
