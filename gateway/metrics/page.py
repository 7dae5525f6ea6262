# SPDX-License-Identifier: Apache-2.0
"""The text of /metrics, in pieces that each take little time."""

from collections.abc import Iterable, Iterator, Mapping
from itertools import islice
from typing import Any, Final

from prometheus_client import generate_latest
from prometheus_client.core import CounterMetricFamily, GaugeMetricFamily, HistogramMetricFamily
from prometheus_client.metrics_core import Metric
from prometheus_client.process_collector import ProcessCollector
from prometheus_client.registry import Collector

from gateway.metrics.families import FAMILIES, PREFIX, Family, Kind
from gateway.metrics.histogram import Observed
from gateway.metrics.state import State

CONTENT_TYPE: Final = "text/plain; version=0.0.4; charset=utf-8"
# Samples that are written in one go, 7 us each: a few hundred are far from being felt by clients.
PIECE_SAMPLES: Final = 256
# A histogram has 16 samples.
PIECE_HISTOGRAMS: Final = PIECE_SAMPLES // 16

_METRICS: Final[Mapping[Kind, Any]] = {  # they take different values
    "counter": CounterMetricFamily,
    "gauge": GaugeMetricFamily,
    "histogram": HistogramMetricFamily,
}
_PROCESS: Final = ProcessCollector(registry=None)


class _Part(Collector):
    """A part of a family, as a collector."""

    def __init__(self, family: Metric) -> None:
        self._family = family

    def collect(self) -> Iterable[Metric]:
        return [self._family]


def pieces(state: State) -> Iterator[str]:
    """Write a state as the text that Prometheus reads, a bounded piece at a time."""
    for family in FAMILIES:
        yield from _written(family, state)
    yield generate_latest(_PROCESS).decode()


def _written(family: Family, state: State) -> Iterator[str]:
    rows = iter(family.rows(state))
    size = PIECE_HISTOGRAMS if family.kind == "histogram" else PIECE_SAMPLES
    is_first = True
    while part := list(islice(rows, size)):
        metric = _METRICS[family.kind](PREFIX + family.name, family.text, labels=family.labels)
        for labels, value in part:
            if isinstance(value, Observed):
                metric.add_metric(labels, value.buckets(), value.sum_s)
            else:
                metric.add_metric(labels, value)
        yield _text(metric, is_first=is_first)
        is_first = False


def _text(metric: Metric, *, is_first: bool) -> str:
    """Write one part. HELP and TYPE stand before the first one only."""
    text = generate_latest(_Part(metric)).decode()
    return text if is_first else text.split("\n", 2)[2]
