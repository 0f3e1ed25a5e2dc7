"""The boundary of work beside the requests: whatever goes wrong ends there, told and counted."""

import io
import zlib

import pytest

from service.errors import NotFoundError
from service.kit.failure import AT_FAULT
from service.kit.guard import Failure, Guard, ending_here, unforeseen
from service.kit.metrics import Metrics
from tests.service.kit.test_log import lines


def test_a_fault_that_no_list_of_errors_holds_ends_there(written: io.StringIO) -> None:
    metrics = Metrics()
    guard = Guard(metrics)
    with guard.alone("stands", "ODG-1"):
        zlib.decompress(b"no stream")
    [line] = lines(written)
    assert (guard.failed, line["level"], line["doing"], line["place"]) == (1, "error", "stands", "ODG-1")
    assert 'imu_health_background_faults_total{fault="error",work="stands"} 1.0' in metrics.text().decode()


def test_what_is_foreseen_is_told_in_its_own_words_and_passes() -> None:
    with ending_here("group", "ODG-1") as met:
        raise NotFoundError("There is no such stand.")
    assert met.failure == Failure("NotFoundError", "There is no such stand.")


def test_a_fault_is_never_told_in_python_s_words() -> None:
    with ending_here("group", "ODG-1") as met:
        dict[str, str]()["document"]
    assert met.failure == Failure("KeyError", AT_FAULT, is_foreseen=False)


def test_whoever_waits_is_told_what_is_foreseen() -> None:
    with pytest.raises(NotFoundError), unforeseen("group", "ODG-1"):
        raise NotFoundError("There is no such stand.")


@pytest.mark.parametrize("end", [KeyboardInterrupt, SystemExit])
def test_what_ends_a_program_ends_it(end: type[BaseException]) -> None:
    with pytest.raises(end), Guard(Metrics()).alone("stands", "ODG-1"):
        raise end
