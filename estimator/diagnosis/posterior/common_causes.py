"""Causes of the catalogue that move the applied vector, hence act on all sensors."""

from collections.abc import Iterator, Sequence

import numpy as np

from estimator.causes.contract import CommonCause, Signature
from estimator.diagnosis.posterior.blocks import ColumnBlocks, TermColumns
from estimator.diagnosis.posterior.layout import InputLayout
from estimator.diagnosis.posterior.priors import EACH_CAUSE, SIZES
from estimator.diagnosis.posterior.term import CauseEffect, Since
from estimator.diagnosis.residuals.whitened import WhitenedResiduals


class CommonCauses(ColumnBlocks):
    """All causes of stand, fixture and record that a session can show."""

    def __init__(self, residuals: WhitenedResiduals, catalogue: Sequence[Signature]) -> None:
        setting, layout = residuals.baseline.setting, InputLayout.of(residuals)
        causes = [c for c in catalogue if isinstance(c, CommonCause) and c.available(setting)]
        known = [c for c in causes if layout.P or not c.between]
        super().__init__([block for c in known for block in of_cause(residuals, layout, c)], SIZES)


def of_cause(residuals: WhitenedResiduals, layout: InputLayout, cause: CommonCause) -> Iterator[TermColumns]:
    """The columns of a cause that is new and, where there is a history, of one that acted there as it does here."""
    columns = residuals.baseline.setting.through(cause.change(residuals.baseline.setting))
    largest = np.abs(columns / layout.unit[None, :, None]).max(axis=(0, 1))
    if not (largest > 0).all():
        return
    unit = columns / largest
    whole = {Since.NOW: layout.whole(unit)}
    if layout.P and not cause.between:
        whole[Since.BEFORE] = layout.whole(unit, residuals.response @ residuals.whitened(unit))
    prior = float(np.log(EACH_CAUSE / len(whole)))
    for since, W in whole.items():
        yield TermColumns((cause.identifier, ()), W, prior, CauseEffect(cause, (), since, 1 / largest))
