"""Figures for Prometheus: requests by operation and status with their time, uploads by what became of them."""

from time import perf_counter

from prometheus_client import CollectorRegistry, Counter, Histogram, generate_latest
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from service.records import Receipt

BUCKETS = (0.005, 0.02, 0.05, 0.1, 0.25, 0.5, 1, 2.5, 5, 15)


class Metrics:
    """The figures of one service."""

    def __init__(self) -> None:
        self.registry = CollectorRegistry()
        self.requests = Histogram(
            "imu_health_request_seconds",
            "Time to answer.",
            ("method", "operation", "status"),
            registry=self.registry,
            buckets=BUCKETS,
        )
        self.uploads = Counter(
            "imu_health_uploads", "Uploads by what became of them.", ("result",), registry=self.registry
        )

    def count_upload(self, receipt: Receipt) -> None:
        """A session that was stored, or was stored before."""
        self.uploads.labels(receipt.verdict.value if receipt.created else "stored-before").inc()

    def count_request(self, scope: Scope, status: int, seconds: float) -> None:
        """One answer; requests that no route took are counted together."""
        operation = getattr(scope.get("route"), "name", None) or "none"
        method = scope["method"] if operation != "none" else "any"
        self.requests.labels(method, operation, str(status)).observe(seconds)

    def text(self) -> bytes:
        """All figures in Prometheus' form."""
        return generate_latest(self.registry)


class Measured:
    """Times every request."""

    def __init__(self, app: ASGIApp, metrics: Metrics) -> None:
        self.app = app
        self.metrics = metrics

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Passes everything through and notes the status and the time."""
        if scope["type"] != "http":
            await self.app(scope, receive, send)
            return
        start, status = perf_counter(), 500

        async def noted(message: Message) -> None:
            nonlocal status
            if message["type"] == "http.response.start":
                status = message["status"]
            await send(message)

        try:
            await self.app(scope, receive, noted)
        finally:
            self.metrics.count_request(scope, status, perf_counter() - start)
