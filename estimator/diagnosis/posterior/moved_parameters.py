"""A sensor whose parameters changed since the history as no drift does: its quadratic term alone, or all at once."""

import numpy as np

from estimator.diagnosis.posterior import priors
from estimator.diagnosis.posterior.blocks import ColumnBlocks, TermColumns
from estimator.diagnosis.posterior.layout import InputLayout
from estimator.diagnosis.posterior.priors import SIZES
from estimator.diagnosis.posterior.term import MOVED, CauseEffect, Since
from estimator.diagnosis.residuals.whitened import WhitenedResiduals
from estimator.diagnosis.signatures.patterns import OwnChange
from estimator.forward import jacobian


class MovedParameters(ColumnBlocks):
    """Changes of single sensors that only the history shows."""

    named = False

    def __init__(self, residuals: WhitenedResiduals) -> None:
        setting, layout = residuals.baseline.setting, InputLayout.of(residuals)
        changes = jacobian(setting.parameters, setting.n, setting.norm)
        prior = float(np.log(priors.MOVED / layout.m / len(OwnChange.moves)))
        blocks = []
        for i in range(layout.m) if layout.P else ():
            for number, moved in enumerate(OwnChange.moves):
                columns = changes[:, i, moved]
                scale = layout.unit[i] / np.maximum(np.abs(columns).max(axis=0), 1e-300)
                effect = CauseEffect(OwnChange(), (float(number),), Since.NOW, scale)
                blocks.append(TermColumns((MOVED, (i,)), layout.on_sensor(i, columns * scale), prior, effect))
        super().__init__(blocks, SIZES)
