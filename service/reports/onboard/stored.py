"""The correction of a stored session, as the parameter files of other systems are written from."""

from estimator.nominal_vector import nominal_vector
from service.errors import ConflictError
from service.reports.onboard.given import Given
from service.settings import VERSION
from service.storage import Storage
from service.views.correction import corrected
from service.words.conditions import condition_of


def given_of(storage: Storage, id: str) -> Given:
    """Of a session; NotFoundError where its programme gives no correction, ConflictError where a sensor has none: the
    vector that a driver makes holds it too."""
    one = corrected(storage, id)
    if one.found.left_out:
        why = "; ".join(f"{name}: {reason}" for name, reason in one.found.left_out)
        raise ConflictError(f"The driver's vector holds sensors that have no correction. {why}.")
    with storage.database.reading() as store:
        noise = store.noises.get(id)
    return Given(
        unit=one.stored.unit,
        session=one.stored.id,
        measured_at=one.stored.started_at,
        verdict=condition_of(one.stored.verdict, is_reference=one.stored.is_reference).word,
        simulated=one.stored.simulated,
        software=f"imu-health {VERSION}",
        vectors={block.kind: nominal_vector(one.session, block) for block in one.found.blocks},
        noise=noise,
    )
