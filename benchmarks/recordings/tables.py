"""Ours beside the published values, recording by recording, as Markdown tables."""

from collections.abc import Callable, Iterable, Sequence
from itertools import pairwise

import numpy as np

from benchmarks.recordings.held_out import held_out, misses, rms
from benchmarks.recordings.published import ferraris, mpu9150, xsens
from benchmarks.recordings.sets import Recording, recordings
from benchmarks.recordings.triad import Triad, nominal, norm_fit, triad_of
from estimator.calibration import calibrate
from estimator.results import Calibration
from estimator.session import Array, CalibrationSession, Sensor

Quantity = Callable[[Triad], Array]


def table(head: Sequence[str], body: Iterable[Sequence[str]]) -> str:
    """A Markdown table."""
    lines = [head, ["---"] * len(head), *body]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def ours(recording: Recording, quadratic: bool | None = False) -> Callable[[CalibrationSession], list[Triad]]:
    """Our calibration as something to hold positions out of."""

    def run(session: CalibrationSession) -> list[Triad]:
        result = calibrate(session, quadratic=quadratic)
        return [triad_of(result, sensors) for sensors in recording.triads]

    return run


def literature(recording: Recording, start: Triad) -> Callable[[CalibrationSession], list[Triad]]:
    """The usual nine-parameter fit of |a| − g, triad by triad."""

    def run(session: CalibrationSession) -> list[Triad]:
        count = len(recording.triads)
        return [norm_fit(session.readings[:, 3 * k : 3 * k + 3], recording.g, start) for k in range(count)]

    return run


def start_of(recording: Recording) -> Triad:
    """The ideal triad of a recording's nominal scale and offset."""
    sensor = recording.session.sensors[0]
    return nominal(sensor.nominal_scale, sensor.nominal_offset or 0.0)


def known_triads(recording: Recording) -> list[Triad] | None:
    """Published parameters; None where the publication prints none."""
    if recording.name.startswith("imu-tk"):
        return [xsens()]
    if recording.name.startswith("mpu9150"):
        last = recording.name.rsplit("-", 1)[1]
        return [mpu9150(k) for k in range(5)] if last == "five" else [mpu9150(int(last) - 1)]
    return None


def milli(values: Array | None) -> str:
    """Root mean square over triads, mm/s²."""
    return "not published" if values is None else f"{1000 * np.sqrt(np.mean(values**2)):.2f}"


def residuals(formats: Sequence[str] = ("imu-tk", "mpu9150-five", "ctu-mat", "kth-mimu")) -> str:
    """Held-out residual of every recording that has positions to spare."""
    body = []
    for recording in (r for name in formats for r in recordings(name)):
        start, known = start_of(recording), known_triads(recording)
        count = len(recording.triads)
        body.append(
            [
                recording.name,
                str(3 * count),
                str(len(recording.session.readings)),
                milli(rms([start] * count, recording.session, recording.g)),
                milli(None if known is None else rms(known, recording.session, recording.g)),
                milli(rms(ours(recording)(recording.session), recording.session, recording.g)),
                milli(held_out(recording.session, recording.g, literature(recording, start))),
                milli(held_out(recording.session, recording.g, ours(recording))),
                milli(held_out(recording.session, recording.g, ours(recording, True))),
                "with c" if calibrate(recording.session).sensors[0].observable["quadratic"] else "without",
            ]
        )
    head = [
        "recording",
        "sensors",
        "positions",
        "before",
        "published, as printed",
        "ours, all positions",
        "norm fit, held out",
        "ours, held out",
        "ours with c, held out",
        "left to itself",
    ]
    return table(head, body)


def uncertain(result: Calibration, sensors: Sequence[Sensor], quantity: Quantity) -> tuple[Array, Array]:
    """A quantity of a triad and its one sigma, by the calibration's covariance."""
    triad = triad_of(result, sensors)
    index = {name: k for k, name in enumerate(result.names)}
    steps, places = [], []
    for i, name in enumerate(s.name for s in sensors):
        sensor = result.sensor(name)
        K, b = sensor.scale.value, sensor.bias.value
        assert K is not None
        assert b is not None
        for element, size in (("scale", 1e-6 * K), ("bias", 1e-6), ("axis_1", 1e-6), ("axis_2", 1e-6)):
            matrix, offset = triad.matrix.copy(), triad.offset.copy()
            if element == "scale":
                matrix[i] *= 1 + size / K
                offset[i] += size * b
            elif element == "bias":
                offset[i] += K * size
            else:
                matrix[i] += size * K * sensor.axis_tangents[:, int(element[-1]) - 1]
            steps.append((quantity(Triad(matrix, offset, triad.quadratic)) - quantity(triad)) / size)
            places.append(index[f"{name}.{element}"])
    J = np.array(steps).T
    covariance = result.covariance[np.ix_(places, places)]
    return quantity(triad), np.sqrt(np.diagonal(J @ covariance @ J.T))


def angles(triad: Triad) -> Array:
    """Departures of axes xy, xz, yz from a right angle, degrees."""
    return np.degrees(triad.misalignment())


def beside(
    result: Calibration, sensors: Sequence[Sensor], known: Triad, rows: Sequence[tuple[str, Quantity, str]]
) -> str:
    """Ours ± sigma beside the published values."""
    body = []
    for label, quantity, form in rows:
        value, sigma = uncertain(result, sensors, quantity)
        for letter, v, s, p in zip(("1", "2", "3"), value, sigma, quantity(known), strict=True):
            body.append([f"{label} {letter}", f"{v:{form}} ± {s:{form}}", f"{p:{form}}", f"{v - p:+{form}}"])
    return table(["quantity", "ours", "published", "difference"], body)


def imu_tk() -> str:
    """Scale, offset and angles of the Xsens MTi."""
    (recording,) = recordings("imu-tk")
    result = calibrate(recording.session, quadratic=False)
    return beside(
        result,
        recording.triads[0],
        xsens(),
        [
            ("scale, counts per m/s²", lambda t: t.scale, ".3f"),
            ("offset, counts", lambda t: t.offset, ".2f"),
            ("departure from 90°, degrees (xy, xz, yz)", angles, ".3f"),
        ],
    )


def mpu9150_five() -> str:
    """The five triads in the publication's convention: measured = M·a + b, M upper triangular."""
    quantities: list[tuple[str, Quantity, str]] = [
        ("s, % (x, y, z)", lambda t: 100 * (np.diagonal(t.upper()) - 1), ".3f"),
        ("b, m/s² (x, y, z)", lambda t: t.offset, ".4f"),
        ("m, degrees (xy, xz, yz)", lambda t: np.degrees(t.upper()[[0, 0, 1], [1, 2, 2]]), ".3f"),
    ]
    single, block = recordings("mpu9150-five")[:5], recordings("mpu9150-five")[5]
    together = calibrate(block.session, quadratic=False)
    body = []
    for k, recording in enumerate(single):
        alone = calibrate(recording.session, quadratic=False)
        for label, quantity, form in quantities:
            value, sigma = uncertain(alone, recording.triads[0], quantity)
            joint, joint_sigma = uncertain(together, block.triads[k], quantity)
            body.append(
                [
                    f"imu{k}",
                    label,
                    ", ".join(f"{v:{form}} ± {s:{form}}" for v, s in zip(value, sigma, strict=True)),
                    ", ".join(f"{v:{form}} ± {s:{form}}" for v, s in zip(joint, joint_sigma, strict=True)),
                    ", ".join(f"{p:{form}}" for p in quantity(mpu9150(k))),
                ]
            )
    return table(["IMU", "quantity", "ours, one triad", "ours, block of fifteen", "published"], body)


def ctu() -> str:
    """The publication's cost minimised by its method, beside ours."""
    (recording,) = recordings("ctu-mat")
    result = calibrate(recording.session, quadratic=False)
    return beside(
        result,
        recording.triads[0],
        norm_fit(recording.session.readings, recording.g, start_of(recording)),
        [
            ("scale", lambda t: t.scale * recording.g, ".5f"),
            ("offset, mg", lambda t: 1000 * t.offset, ".3f"),
            ("departure from 90°, degrees (xy, xz, yz)", angles, ".4f"),
        ],
    ).replace("published", "norm fit")


def ferraris_table() -> str:
    """The labelled six positions."""
    (recording,) = recordings("ferraris-csv")
    result = calibrate(recording.session, quadratic=False)
    return beside(
        result,
        recording.triads[0],
        ferraris(),
        [
            ("scale, counts per m/s²", lambda t: t.scale, ".3f"),
            ("offset, counts", lambda t: t.offset, ".2f"),
            ("departure from 90°, degrees (xy, xz, yz)", angles, ".2f"),
        ],
    )


def ferraris_residuals() -> str:
    """|a| − g of the six positions themselves, mm/s²: none can be held out."""
    (recording,) = recordings("ferraris-csv")
    result = calibrate(recording.session, quadratic=False)
    methods = {
        "before": start_of(recording),
        "published": ferraris(),
        "ours": triad_of(result, recording.triads[0]),
    }
    body = [
        [name, *(f"{1000 * m:.2f}" for m in misses([triad], recording.session.readings, recording.g)[:, 0])]
        for name, triad in methods.items()
    ]
    return table(["parameters", *(f"position {k}" for k in range(1, 7))], body)


def history() -> str:
    """KTH: how the parameters of 24 accelerometers moved from session to session."""
    results = [(r.name, calibrate(r.session, quadratic=False), r) for r in recordings("kth-mimu")]
    body = []
    for (name, earlier, recording), (other, later, _) in pairwise(results):
        before = [triad_of(earlier, sensors) for sensors in recording.triads]
        after = [triad_of(later, sensors) for sensors in recording.triads]
        scale = np.array([b.scale / a.scale - 1 for a, b in zip(before, after, strict=True)])
        bias = np.array([b.offset / b.scale - a.offset / a.scale for a, b in zip(before, after, strict=True)])
        turn = np.array([np.cross(a.axes, b.axes) for a, b in zip(before, after, strict=True)])
        sigma = [np.median(relative_sigma(result)) for result in (earlier, later)]
        body.append(
            [
                f"{name} → {other}",
                f"{1e6 * scale.mean():+.0f}",
                f"{1e6 * scale.std():.0f}",
                f"{1e6 * np.hypot(*sigma):.0f}",
                f"{1000 * np.sqrt(np.mean(bias**2)) / recording.g:.2f}",
                f"{np.degrees(np.sqrt(np.mean((turn**2).sum(axis=-1)))):.4f}",
            ]
        )
    head = [
        "sessions",
        "scale, common, ppm",
        "scale, rest, ppm rms",
        "its stated sigma, ppm",
        "bias, mg rms",
        "axis, degrees rms",
    ]
    return table(head, body)


def relative_sigma(result: Calibration) -> Array:
    """(m,) one sigma of each accelerometer's scale over the scale."""
    pairs = [(s.scale.sigma, s.scale.value) for s in result.sensors if s.observable["scale"]]
    sigma, value = np.array(pairs, dtype=float).T
    return np.asarray(sigma / value)


def kth_triads() -> str:
    """KTH: |a| − g of held-out positions per IMU and session, mg."""
    body = []
    for recording in recordings("kth-mimu"):
        found = 1000 * held_out(recording.session, recording.g, ours(recording)) / recording.g
        body.append([recording.name, *(f"{x:.2f}" for x in found)])
    return table(["session", *(f"IMU {k}" for k in range(1, 9))], body)
