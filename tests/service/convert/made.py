"""Small recordings in each public format, made from known truth, and where the real ones are."""

import os
from pathlib import Path

import numpy as np
import pytest
from scipy.io import savemat

G = 9.81
RATE = 100.0
RECORDINGS = Path(os.environ.get("IMU_HEALTH_RECORDINGS", Path(__file__).parents[4] / "shared" / "data"))

needs_recordings = pytest.mark.skipif(
    not RECORDINGS.is_dir(),
    reason=f"the measured recordings are not at {RECORDINGS}; set IMU_HEALTH_RECORDINGS to their folder",
)


def sphere(count, seed):
    d = np.random.default_rng(seed).standard_normal((count, 3))
    return d / np.linalg.norm(d, axis=1, keepdims=True)


def motion(poses=14, rest=300, turn=200, seed=0):
    """(R, 3) specific force in g: rest, turn by hand, rest …"""
    rng, d = np.random.default_rng(seed), sphere(poses, seed)
    pieces = []
    for k in range(poses):
        blend = np.linspace(0, 1, turn)[:, None]
        way = (1 - blend) * d[k] + blend * d[(k + 1) % poses] + 0.3 * rng.standard_normal((turn, 3))
        pieces += [np.tile(d[k], (rest, 1)), way]
    return np.vstack(pieces)


def imu_tk(folder):
    force, rng = motion(), np.random.default_rng(1)
    time = np.arange(len(force)) / RATE
    counts = np.round(32768 + 415 * G * force + 3 * rng.standard_normal(force.shape))
    turns = np.round(32768 + 10 * rng.standard_normal(force.shape))
    paths = [folder / "xsens_acc.mat", folder / "xsens_gyro.mat"]
    for path, values in zip(paths, (counts, turns), strict=True):
        np.savetxt(path, np.column_stack([time, values]), fmt="%.7e")
    return paths


TURNS = [np.eye(3), np.diag([-1.0, -1, 1]), np.array([[0.0, 1, 0], [0, 0, 1], [1, 0, 0]])]


def mpu9150_five(folder):
    force, paths = motion(), []
    for k in range(5):
        rng = np.random.default_rng(k)
        own = np.roll(force, 3 * k, axis=0) @ TURNS[k % 3].T
        values = np.hstack([G * own + 0.05 * rng.standard_normal(own.shape), 0.01 * rng.standard_normal(own.shape)])
        paths.append(folder / f"imu{k}.log")
        np.savetxt(paths[-1], values[: len(values) - 5 * k], fmt="%.5f")
    return paths


def packets(force, first=100):
    """The bytes of KTH packets that see ``force`` (R, 3) in g."""
    rng, stream = np.random.default_rng(2), bytearray(b"\xa0\x28\x00\xc8")
    for j, f in enumerate(force):
        values = np.zeros((8, 6))
        values[0::2, :3], values[1::2, :3] = f, -f[[1, 0, 2]]
        values[:, :3] = 2048 * values[:, :3] + 3 * rng.standard_normal((8, 3))
        clock = (2**32 - 64_000_000 + j * 1_024_000) % 2**32
        body = np.array(clock, ">u4").tobytes() + np.round(values).astype(">i2").tobytes()
        packet = b"\xaa" + np.array((first + j) % 65536, ">u2").tobytes() + b"\x64" + body
        stream += packet + np.array(sum(packet) % 65536, ">u2").tobytes()
    return bytes(stream)


def kth_mimu(folder):
    path = folder / "exp_1.data.bin"
    path.write_bytes(packets(motion(rest=190, turn=60)) + b"\xaa\x01")
    return [path]


def ctu_mat(folder):
    path = folder / "orientations.mat"
    savemat(path, {"ACC_meas": (1.002 * sphere(30, 3) + 1e-4 * sphere(30, 4)).T})
    return [path]


def ferraris_csv(folder):
    rng, lines, at = np.random.default_rng(5), ["part,samples,acc_x,acc_y,acc_z,gyr_x,gyr_y,gyr_z"], 0
    for part in ("x_a", "x_p", "x_rot", "y_a", "y_p", "z_a", "z_p"):
        sign = -1 if part.endswith("a") else 1
        for _ in range(300):
            counts = 2048 * sign * np.eye(3)["xyz".index(part[0])] + 4 * rng.standard_normal(3)
            numbers = [*counts, *(3 * rng.standard_normal(3))]
            lines.append(",".join([part, str(at), *(f"{x:.1f}" for x in numbers)]))
            at += 1
    path = folder / "annotated_session.csv"
    path.write_text("\n".join(lines) + "\n")
    return [path]


MADE = {
    "imu-tk": imu_tk,
    "mpu9150-five": mpu9150_five,
    "kth-mimu": kth_mimu,
    "ctu-mat": ctu_mat,
    "ferraris-csv": ferraris_csv,
}
