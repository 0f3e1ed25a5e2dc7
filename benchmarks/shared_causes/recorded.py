"""Public recordings: how many names a cold start gets, and a curve over temperature."""

from collections.abc import Iterator

from benchmarks.convert import convert
from benchmarks.diagnosed_recordings.still import mpu6050
from benchmarks.recordings.sets import FILES, folder
from benchmarks.shared_causes.unlike import Line
from estimator import diagnose, read_session
from estimator.calibration.calibrate import averaged
from estimator.diagnosis.results import Diagnosis

BOARD = "kth-mimu"
COLD = ("exp_1", "exp_6")
"""Sessions soon after switching on; exp_7, which the target names too, is not among the files."""
FURTHER = 2
CURVE = "bias-temperature-curve"


def recorded(_: int, __: int) -> Iterator[Line]:
    """The sensor array's cold starts, and the gyro whose bias follows a parabola."""
    for name in COLD:
        found = _diagnosed(name)
        yield f"kth {name}: one course with τ ± U, names beside it", f"≤ {FURTHER}", course_of(found)
        before, after = found.gain.before.chi2_per_dof, found.gain.after.chi2_per_dof
        target = "≤ 1.21" if name == "exp_6" else ""
        yield f"kth {name}: held-out χ²/dof", target, f"{after:.2f} (without causes {before:.2f})"
    names = {f.cause: f.sensors for f in diagnose(mpu6050()).findings}
    yield "mpu6050, Gy over temperature", f"`{CURVE}`", f"`{CURVE}`" if "Gy" in names.get(CURVE, ()) else "other"


def course_of(found: Diagnosis) -> str:
    """The shared course and the number of names beside it."""
    shared = [f for f in found.findings if f.shared is not None and f.shared.shape_sigma]
    if not shared:
        return f"no course; {len(found.findings)} names"
    shape = shared[0].shared
    assert shape is not None
    count = len(shared[0].sensors) + len(shape.more)
    tau = f"τ {shape.shape['s']:.0f} ± {2 * shape.shape_sigma['s']:.0f} s of {count} sensors"
    others = [f"`{f.cause}` ({', '.join(f.sensors)})" for f in found.findings if f is not shared[0]]
    return f"{len(others)} ({'; '.join([tau, *others])})"


def _diagnosed(name: str) -> Diagnosis:
    files = [path for path in sorted(folder().glob(FILES[BOARD])) if path.name.startswith(f"{name}.")]
    ((_, document),) = convert(BOARD, files)
    return diagnose(averaged(read_session(document)))
