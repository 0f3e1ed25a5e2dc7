"""A sensor whose parameters changed since the history as no drift does: its quadratic term alone, or all at once."""

from collections.abc import Iterator

import numpy as np

from estimator.causes.contract import Setting, Shape, Signature
from estimator.diagnosis.posterior import priors
from estimator.diagnosis.posterior.blocks import ColumnBlocks, TermColumns
from estimator.diagnosis.posterior.layout import InputLayout
from estimator.diagnosis.posterior.priors import SIZES
from estimator.diagnosis.posterior.term import MOVED, CauseEffect, Since
from estimator.diagnosis.residuals.whitened import WhitenedResiduals
from estimator.forward import jacobian


class OwnChange(Signature):
    """A change of one sensor's parameters since the history: with the quadratic term or without, or of that alone."""

    identifier = "own-change"
    scope = "unexplained"
    needs = frozenset({"history"})
    between = True
    equation = ""
    units = ()
    sentence = "the sensor's parameters, changed since the earlier sessions"
    advice = ""

    moves = ([0, 1, 3, 4], [2], [0, 1, 2, 3, 4])
    """Scale, bias and axis; the quadratic term alone; everything. Of the first three one alone is no cheaper than a
    cause beside a change that is left open."""

    def shapes(self, setting: Setting) -> Iterator[Shape]:
        changes = jacobian(setting.parameters, setting.n, setting.norm)
        for i in range(len(setting.kinds)):
            for number, moved in enumerate(self.moves):
                columns = np.zeros((setting.rows, len(setting.kinds), 5))
                columns[:, i, moved] = changes[:, i, moved]
                yield Shape((i,), columns, (float(number),))


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
