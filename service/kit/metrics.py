"""Figures for Prometheus: requests by operation and status with their time, uploads by outcome, and failed background
work.
"""

from collections.abc import Mapping

from prometheus_client import CollectorRegistry, Counter, Gauge, Histogram, generate_latest

from service.kit.failure import FailedKind

BUCKETS = (0.005, 0.02, 0.05, 0.1, 0.25, 0.5, 1, 2.5, 5, 15)
"""Upper bounds of the time of an answer, s: a page takes milliseconds, a large upload seconds."""


class Metrics:
    """The figures of one service."""

    def __init__(self) -> None:
        self._registry = CollectorRegistry()
        self._requests = Histogram(
            "imu_health_request_seconds",
            "Time to answer.",
            ("method", "operation", "status"),
            registry=self._registry,
            buckets=BUCKETS,
        )
        self._uploads = Counter(
            "imu_health_uploads", "Uploads by what became of them.", ("result",), registry=self._registry
        )

        self._faults = Counter(
            "imu_health_background_faults",
            "Work beside the requests that failed, by what was done and what went wrong.",
            ("work", "fault"),
            registry=self._registry,
        )

        self._files = Counter(
            "imu_health_file_faults",
            "Stored files that were missing or damaged when they were read, and those put back by another upload.",
            ("fault",),
            registry=self._registry,
        )

        self._room = Gauge(
            "imu_health_free_bytes", "Room on the disk of uploaded files, bytes.", registry=self._registry
        )

        self._pending = Gauge(
            "imu_health_pending_diagnoses", "Diagnoses that are still to be made.", registry=self._registry
        )

        self._failed = Gauge(
            "imu_health_failed_work",
            "Work beside the requests that has failed and waits for the administrator, by kind.",
            ("kind",),
            registry=self._registry,
        )

    def note_failed(self, counts: Mapping[FailedKind, int]) -> None:
        """Sets the amounts of failed work, by kind."""
        for kind, number in counts.items():
            self._failed.labels(kind.value).set(number)

    def note_room(self, free: int) -> None:
        """Sets the free room for uploads, bytes."""
        self._room.set(free)

    def note_pending(self, count: int) -> None:
        """Sets the number of diagnoses still to be made."""
        self._pending.set(count)

    def count_upload(self, outcome: str) -> None:
        """A session that was stored, by its verdict, or was stored before."""
        self._uploads.labels(outcome).inc()

    def count_request(self, method: str, operation: str | None, status: int, seconds: float) -> None:
        """One answer; requests that no route took are counted together."""
        named = (method, operation) if operation else ("any", "none")
        self._requests.labels(*named, str(status)).observe(seconds)

    def count_fault(self, work: str, fault: str) -> None:
        """A piece of work beside the requests that failed."""
        self._faults.labels(work, fault).inc()

    def count_file_fault(self, fault: str) -> None:
        """A stored file that is missing or damaged, or was put back."""
        self._files.labels(fault).inc()

    def text(self) -> bytes:
        """All figures in Prometheus' form."""
        return generate_latest(self._registry)
