"""Real recordings: ours beside the published calibration, by residual and parameter by parameter."""

import numpy as np
import pytest

from benchmarks.convert import FORMATS
from benchmarks.recordings.held_out import held_out, rms
from benchmarks.recordings.published import ferraris, mpu9150, xsens
from benchmarks.recordings.sets import logs, recordings
from benchmarks.recordings.tables import known_triads, literature, ours, start_of
from benchmarks.recordings.triad import triad_of
from estimator.calibration import calibrate
from tests.service.convert.made import needs_recordings

pytestmark = needs_recordings


@pytest.fixture(scope="module", autouse=True)
def recordings_let_go():
    """They fill a quarter of a GiB."""
    yield
    for read in (logs, recordings):
        read.cache_clear()


FILES = {"kth-mimu": 2}
"""Number of files that is enough, where all take long."""
LARGE = ("kth-mimu", "mpu9150-five")
"""They take seven to twelve seconds to read, and 200 MB."""


def each(*cases):
    """Parameters of a test: recordings of a format, and what is expected of them."""
    return [pytest.param(*case, marks=[pytest.mark.slow] * (case[0] in LARGE)) for case in cases]


def some(name):
    """Recordings of a format."""
    return recordings(name, FILES.get(name))


@pytest.mark.parametrize("name", each(*((converter.name,) for converter in FORMATS)))
def test_the_recordings_convert_and_calibrate(name):
    found = [calibrate(recording.session).fit for recording in some(name)]
    assert found
    assert all(fit.converged and fit.rank == fit.parameters for fit in found)


def triads(recording):
    """Our triads from all positions."""
    return ours(recording)(recording.session)


@pytest.mark.parametrize(("name", "which"), each(("imu-tk", 0), *(("mpu9150-five", k) for k in range(5))))
def test_published_parameters_leave_more_than_ours_on_the_same_positions(name, which):
    recording = some(name)[which]
    known = rms(known_triads(recording), recording.session, recording.g)
    assert np.all(rms(triads(recording), recording.session, recording.g) < known)


@pytest.mark.parametrize(("name", "count"), each(("imu-tk", 1), ("mpu9150-five", 6), ("ctu-mat", 1), ("kth-mimu", 2)))
def test_held_out_positions_are_met_as_well_as_by_the_usual_fit(name, count):
    found = some(name)
    assert len(found) == count
    for recording in found:
        usual = held_out(recording.session, recording.g, literature(recording, start_of(recording)))
        own = held_out(recording.session, recording.g, ours(recording))
        assert np.sqrt(np.mean(own**2)) < 1.1 * np.sqrt(np.mean(usual**2))


@pytest.mark.slow
@pytest.mark.parametrize("k", range(5))
def test_the_five_published_calibrations_are_reproduced(k):
    recording = some("mpu9150-five")[k]
    (own,), known = triads(recording), mpu9150(k)
    np.testing.assert_allclose(np.diagonal(own.upper()), np.diagonal(known.upper()), atol=4e-4)
    np.testing.assert_allclose(own.offset, known.offset, atol=3e-3)
    np.testing.assert_allclose(own.misalignment(), known.misalignment(), atol=np.radians(0.03))


def test_the_factory_calibration_of_the_xsens_is_met_to_a_quarter_of_a_per_cent():
    (own,), known = triads(some("imu-tk")[0]), xsens()
    np.testing.assert_allclose(own.scale / known.scale, 1, atol=2.5e-3)
    np.testing.assert_allclose(own.offset, known.offset, atol=5)


def test_six_labelled_positions_give_the_published_result_within_our_uncertainty():
    (recording,) = some("ferraris-csv")
    result = calibrate(recording.session)
    own, known = triad_of(result, recording.triads[0]), ferraris()
    sigma = np.array([s.scale.sigma for s in result.sensors[:3]])
    assert np.all(np.abs(own.scale - known.scale) < 2 * sigma)
    assert result.fit.p_value > 0.05


@pytest.mark.slow
def test_twenty_four_accelerometers_of_one_board_repeat_from_session_to_session():
    first, second = (triads(r) for r in some("kth-mimu")[:2])
    change = np.array([b.scale / a.scale - 1 for a, b in zip(first, second, strict=True)])
    assert change.std() < 4e-4


@pytest.mark.slow
def test_the_five_imus_agree_with_each_other_within_their_stated_noise():
    result = calibrate(some("mpu9150-five")[5].session)
    assert result.fit.p_value > 0.01
    assert result.fit.parameters == 4 * 15 - 3
