"""The correction of a stored session, as the parameter files of other systems are written from."""

from datetime import datetime

from estimator.nominal_vector import nominal_vector
from service.errors import ConflictError
from service.judging.usable_reading import usable_unit
from service.judging.words import verdict_in_words
from service.papers.correction import corrected
from service.papers.onboard.given import ExportInput
from service.sessions.calibrations_store import SessionNoises
from service.sessions.words.conditions import condition_of
from service.settings import VERSION
from service.storage import Storage


def given_of(storage: Storage, id: str, now: datetime) -> ExportInput:
    """Of a session; NotFoundError where its programme gives no correction, ConflictError where a sensor has none: the
    vector that a driver makes holds it too."""
    source = corrected(storage, id)
    if source.found.left_out:
        why = "; ".join(f"{name}: {reason}" for name, reason in source.found.left_out)
        raise ConflictError(f"The driver's vector holds sensors that have no correction. {why}.")
    with storage.database.reading() as store:
        noise, use = SessionNoises(store).get(id), usable_unit(store, source.stored.unit, now)
    curves = source.calibration.thermal
    return ExportInput(
        unit=source.stored.unit,
        session=source.stored.id,
        measured_at=source.stored.started_at,
        state=source.stored.state,
        verdict=verdict_in_words(
            condition_of(source.stored.verdict, is_reference=source.stored.is_reference), source.stored.reservations
        ),
        use=use,
        simulated=source.stored.simulated,
        software=f"imu-health {VERSION}",
        vectors={block.kind: nominal_vector(source.session, block) for block in source.found.blocks},
        noise=noise,
        temperature=None if curves is None else curves.reference_temperature,
    )
