"""Raw files: what is no reading is corrected or left out by name, and what is sound stays as it is."""

import json

import numpy as np
import pytest

from estimator.errors import FormatError
from estimator.programmes import calibrate
from estimator.reading import read_session

RATE, REST, G = 100.0, 300, 9.81
NAMES = ("AX", "AY", "AZ", "GX", "GY", "GZ")
STEPS = np.r_[np.full(3, 1600.0), np.full(3, 7500.0)]
"""Counts per m/s² and per rad/s."""
ZEROS = np.array([0.02, -0.007, 0.01])
"""rad/s."""


def samples(seed=0, noise=(0.02, 0.001), poses=10):
    """(R, 6) counts of a triad of both kinds, held still in orientations and turned between them; and the rests."""
    rng = np.random.default_rng(seed)
    up = rng.standard_normal((poses + 1, 3))
    up /= np.linalg.norm(up, axis=1, keepdims=True)
    share = np.r_[np.zeros(REST), (np.arange(100) + 0.5) / 100]
    force = np.concatenate([(1 - share[:, None]) * up[k] + share[:, None] * up[k + 1] for k in range(poses)])
    turning = np.tile(share > 0, poses)
    rate = ZEROS + turning[:, None] * (0.8 + 0.3 * rng.standard_normal((len(force), 3)))
    inputs = np.column_stack([G * force / np.linalg.norm(force, axis=1, keepdims=True), rate])
    inputs += np.r_[np.full(3, noise[0]), np.full(3, noise[1])] * rng.standard_normal(inputs.shape)
    return np.round(STEPS * inputs), np.where(turning, -1, np.repeat(np.arange(poses), REST + 100))


def session(counts, position=None, *, time=None, rate=RATE, **more):
    """The document of a raw log."""
    kinds = ["accelerometer"] * 3 + ["gyroscope"] * 3
    sensors = [
        {"name": n, "kind": k, "nominal_axis": np.eye(3)[i % 3].tolist(), "nominal_scale": s, "reading_unit": "count"}
        for i, (n, k, s) in enumerate(zip(NAMES, kinds, STEPS, strict=True))
    ]
    table = {
        n: [None if np.isnan(x) else x for x in column] for n, column in zip(NAMES, counts.T.tolist(), strict=True)
    }
    table |= {} if position is None else {"position": position.tolist()}
    table |= {} if time is None else {"time_s": time.tolist()}
    head = {"format": "imu-session/1", "unit": "R-1", "block": "accelerometer", "programme": "arbitrary-orientations"}
    rated = {} if rate is None else {"sample_rate_hz": rate}
    return json.loads(
        json.dumps({**head, "site": {"gravity_m_s2": G}, "sensors": sensors, "table": table, **rated, **more})
    )


def kinds_of(document):
    return [finding.kind for finding in read_session(document).screening]


def zeros_of(document):
    """(3,) biases of the gyros in their standard errors from the true ones."""
    found = calibrate(read_session(document)).sensors[3:]
    return [abs(s.bias.value - true) / s.bias.sigma for s, true in zip(found, ZEROS, strict=True)]


COUNTS, PLACE = samples()
CLOCK = np.arange(len(COUNTS)) / RATE


def marked(value, rows, channels):
    values = COUNTS.copy()
    values[rows, channels] = value
    return values


def between():
    """Rates in every other row, accelerations in the others."""
    values = COUNTS.copy()
    values[::2, :3], values[1::2, 3:] = 0, 0
    return values


FAULTS = {
    "no-data": marked(-32768, np.s_[::20], np.s_[3:]),
    "missing": marked(np.nan, np.s_[::7], 4),
    "sign-lost": np.where((COUNTS < 0) & (np.arange(6) > 2), COUNTS + 65536, COUNTS),
    "zero-vectors": between(),
    "frozen": marked(COUNTS[500, 3], np.s_[500:950], 3),
    "repeated": COUNTS[np.arange(len(COUNTS)) // 3 * 3],
}


@pytest.mark.parametrize("kind", FAULTS)
def test_what_is_no_reading_is_named_and_moves_no_result(kind):
    assert set(kinds_of(session(FAULTS[kind], PLACE))) == {kind}
    assert max(zeros_of(session(FAULTS[kind], PLACE))) < 5


@pytest.mark.parametrize("kind", ["no-data", "sign-lost", "zero-vectors"])
def test_what_is_declined_is_not_looked_for(kind):
    assert kinds_of(session(FAULTS[kind], PLACE, screening=[kind])) == []
    assert kinds_of(session(FAULTS[kind], PLACE, screening="off")) == []


def test_an_unknown_kind_cannot_be_declined():
    with pytest.raises(FormatError, match="no-data, sign-lost"):
        read_session(session(COUNTS, PLACE, screening=["spikes"]))


@pytest.mark.parametrize("noise", [(0.02, 0.001), (2e-4, 4e-5), (1e-4, 1e-7), (1e-4, 2e-4)])
@pytest.mark.parametrize("labelled", [True, False])
def test_a_sound_log_of_any_noise_is_left_as_it_is(noise, labelled):
    for seed in range(4):
        counts, place = samples(seed, noise)
        found = read_session(session(counts - [0, 0, 0, 150, -52, 75], place if labelled else None, time=CLOCK))
        assert found.screening == ()
        np.testing.assert_array_equal(np.isnan(found.readings), False)


def test_a_saturated_turn_is_no_marker():
    fast = np.clip(COUNTS, -5000, 5000)
    assert "no-data" not in kinds_of(session(np.column_stack([COUNTS[:, :3], fast[:, 3:]]), PLACE))


def test_a_few_wild_samples_do_not_move_a_mean():
    rng = np.random.default_rng(1)
    rows = rng.choice(len(COUNTS), 40, replace=False)
    wild = marked(rng.integers(-30000, 30000, 40), rows, 5)
    assert max(zeros_of(session(wild, PLACE))) < 5
    assert [f.kind for f in calibrate(read_session(session(wild, PLACE))).screening] == ["wild"]


def test_a_counter_that_rolls_over_is_carried_on():
    clock = np.round(np.mod(CLOCK + 2**32 * 1e-6 - 15, 2**32 * 1e-6), 6)
    found = read_session(session(COUNTS, PLACE, time=clock))
    np.testing.assert_allclose(np.diff(found.time), 0.01, atol=1e-6)
    assert [(f.kind, f.first_row) for f in found.screening] == [("clock", 1501)]
    with pytest.raises(FormatError, match=r"a counter that rolls over; add 4294\.967296 s"):
        read_session(session(COUNTS, PLACE, time=clock, screening=["clock"]))


def test_a_clock_that_restarts_is_two_recordings():
    clock = np.where(CLOCK < 20, CLOCK + 300, CLOCK - 19.5)
    with pytest.raises(FormatError, match="these are two recordings; split the file there") as refused:
        read_session(session(COUNTS, PLACE, time=clock))
    assert refused.value.problems[0].row == 2001


def test_milliseconds_under_seconds_are_divided():
    found = read_session(session(COUNTS, PLACE, time=1e3 * CLOCK))
    np.testing.assert_allclose(found.time, CLOCK, atol=1e-9)
    assert [f.kind for f in found.screening] == ["time-unit"]
    with pytest.raises(FormatError, match="50 Hz and not 1000"):
        read_session(session(COUNTS, PLACE, time=2 * CLOCK, rate=1000.0))


def test_times_say_the_rate_that_nobody_states():
    found = read_session(session(COUNTS, time=CLOCK + 1.7e9, rate=None))
    assert (found.sample_rate, [f.kind for f in found.screening]) == (100.0, ["rate"])
    with pytest.raises(FormatError, match="time_s never advances"):
        read_session(session(COUNTS, time=np.full(len(CLOCK), 1.7e9), rate=None))
    with pytest.raises(FormatError, match="for a raw log give sample_rate_hz"):
        read_session(session(COUNTS, rate=None))


def test_many_rows_under_each_label_are_samples():
    found = read_session(session(COUNTS, PLACE, time=CLOCK, rate=None))
    assert (found.sample_rate, [f.kind for f in found.screening]) == (100.0, ["rate"])
    with pytest.raises(FormatError, match="rows at each position, as samples are"):
        read_session(session(COUNTS, PLACE, rate=None))
    minutes = 60.0 * np.arange(len(CLOCK))
    assert read_session(session(COUNTS, PLACE, time=minutes, rate=None)).sample_rate is None


@pytest.mark.parametrize("channel", [1, 4], ids=["accelerometer", "gyro"])
def test_a_channel_that_never_changes_is_refused(channel):
    with pytest.raises(FormatError, match="reads 77 in every row"):
        read_session(session(marked(77, np.s_[:], channel), PLACE))


def test_a_coarse_gyro_may_read_one_value_all_through():
    counts = COUNTS.copy()
    counts[:, 3:] = np.round(counts[:, 3:] / 1000)
    still = np.where((PLACE >= 0)[:, None], counts, counts * np.r_[1, 1, 1, 0, 0, 0])
    assert kinds_of(session(still, PLACE)) == []


def test_a_channel_that_fails_in_service_is_left_to_parity():
    counts = np.hstack([COUNTS[:, :3], COUNTS[:, :3] + 3])
    counts[2000:, 4] = 32767
    counts[500, 1] = -32768
    document = session(COUNTS) | {"programme": "in-service"}
    document["sensors"] = [one | {"kind": "accelerometer"} for one in document["sensors"]]
    document["table"] = dict(zip(NAMES, counts.T.tolist(), strict=True))
    found = read_session(document)
    assert [(f.kind, f.sensors, f.rows) for f in found.screening] == [("no-data", (NAMES[1],), 1)]
    assert np.isfinite(found.readings[2000:]).all()
