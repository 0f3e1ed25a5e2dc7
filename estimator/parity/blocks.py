"""Chooses the blocks of a recording that are used, and groups them.

Left out: blocks in which a channel ran into the end of its range, and blocks in motion where motion spoils parity
(sensors that do not sit in one point feel rotation differently, and none of the model's terms says so). Whether it does
is read from the recording: the parity of its moving blocks scatters more than that of its still ones.

Noise of any colour is allowed for by grouping: a group is a stretch of about a thirtieth of the recording. A stretch at
rest up to twice as long is one group, because whatever the model misses is the same all through it; what still agrees
between neighbouring groups is measured in `regression`.

A smooth flight is quiet, and so is a steady turn. At rest the specific force has gravity's size, keeps its direction,
and shakes no more than the sensors' noise makes it seem, or hardly.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from estimator.arrays import unit
from estimator.errors import Problem, ScheduleError
from estimator.message import joined, say
from estimator.parity.ledger import Blocks, Ledger
from estimator.parity.reference import ParityReference
from estimator.session import Array
from estimator.wording import counted, few

Mask = NDArray[np.bool_]
"""One bool a block."""

LEVEL = 0.01
"""Relative difference of the vector's size from gravity at which a block may be at rest: a bank of eight degrees."""
SLOW = 0.02
"""rad/s; turn of the specific force below which a block may be at rest: a degree in a second."""
CALM = 0.1
"""m/s²; shaking of the vector below which a block may be at rest: quieter than vehicles under way."""
NOISY = 3.0
"""Variance of the vector within a block, in what the sensors' noise makes of it, that still is no shaking."""


def resting(blocks: Blocks, quiet: Mask, reference: ParityReference, norm: float | None, rate: float | None) -> Mask:
    """(B,) bool: whether at rest.

    Parameters
    ----------
    quiet : (B,) bool, as quiet as the quietest.
    norm : g, m/s²; None for gyros, which rest where they are quiet.
    rate : of the samples, Hz; None for rows that are averages.
    """
    if norm is None:
        return quiet
    level = np.abs(np.linalg.norm(reference.vector(blocks.mean), axis=1) - norm) < LEVEL * norm
    shake = blocks.shake[:, :3].sum(axis=1)
    noise = NOISY * blocks.parity_variance * np.trace(np.linalg.inv(reference.axes.T @ reference.axes))
    calm = shake <= np.maximum(CALM**2, noise)
    return np.asarray(quiet & level & calm & (turning(blocks, reference, rate) < SLOW))


def turning(blocks: Blocks, reference: ParityReference, rate: float | None) -> Array:
    """(B,) rate at which the specific force turns from block to block, rad/s; 0 for rows that are averages."""
    turns = np.zeros(len(blocks) + 1)
    if rate is not None:
        steps = np.linalg.norm(np.diff(unit(reference.vector(blocks.mean)), axis=0), axis=1)
        middles = 0.5 * (blocks.samples[1:] + blocks.samples[:-1]) / rate
        turns[1:-1] = np.where(np.diff(blocks.first) == 1, steps / middles, 0.0)
    return np.maximum(turns[1:], turns[:-1])


AUTO, STILL, ANY = "auto", "still", "any"
MOTIONS = (AUTO, STILL, ANY)

FLOOR = 0.05
"""Part of the blocks that is taken to be the stillest; its upper end is the floor. A recording must rest so long."""

MOVING = 3.0
"""Variance within a block, in floors, from which it counts as moving; noise alone hardly reaches it."""

RESTLESS = 25.0
"""Variance within the quietest blocks, in that of neighbouring samples, from which even they are moving. White noise
gives 1, noise that is correlated over n samples about n."""

SPOILT = 3.0
"""Mean square of the parity of moving blocks, in that of still ones, from which moving blocks are left out: they then
say less than they disturb."""

ENOUGH_STILL = 12
"""Still blocks from which the moving ones can be done without: the fewest groups, and half as many again."""

GROUPS = 32
"""Groups that a long recording is cut into: sigma is known to an eighth from so many, and they are
long enough to be independent."""

FEWEST_GROUPS = 8
"""Groups below which the noise cannot be known from the recording: eight know sigma to a quarter."""


@dataclass(frozen=True, eq=False)
class BlockSelection:
    """The blocks that are used. B blocks, G groups."""

    blocks: Blocks
    group: NDArray[np.intp]
    """(B,) number of the group of each block."""
    still: Mask
    """(B,) bool; whether as quiet as the quietest."""
    rest: Mask
    """(B,) bool; whether at rest in truth."""
    saturated: tuple[str, ...]
    """Channels that ran into the end of their range somewhere."""
    left_out: dict[str, int]
    """Blocks not used, by reason: ``saturated``, ``moving``."""
    total: int
    """Blocks of the recording."""

    @property
    def groups(self) -> int:
        """G."""
        return int(self.group[-1]) + 1


def select(ledger: Ledger, motion: str, norm: float | None = None, rate: float | None = None) -> BlockSelection:
    """The usable blocks of a recording.

    Parameters
    ----------
    motion : ``still`` uses quiet blocks only, ``any`` all, ``auto`` leaves moving ones out where they spoil parity.
    norm, rate : see `rest.resting`.

    Raises
    ------
    ScheduleError : too short, no stretch at rest although asked for, or saturated most of the time.
    """
    blocks = ledger.blocks()
    total = len(blocks)
    if total < FEWEST_GROUPS:
        raise ScheduleError([Problem("table", too_short(total, ledger))])
    names = np.array(ledger.reference.names)
    cut = (blocks.highest >= ledger.ends[0].limit) | (blocks.lowest <= ledger.ends[1].limit)
    saturated = tuple(names[cut.any(axis=0)].tolist())
    clean: Mask = np.asarray(~cut.any(axis=1))
    if clean.sum() < max(FEWEST_GROUPS, total / 2):
        raise ScheduleError([Problem(saturated[0], too_saturated(saturated, total, int(clean.sum())))])
    still = at_rest(blocks, clean)
    rest = clean & resting(blocks, still, ledger.reference, norm, rate)
    used = clean & wanted(blocks, ledger, still if motion == STILL else rest, clean, motion)
    if used.sum() < FEWEST_GROUPS:
        raise ScheduleError([Problem("table", never_still(int(used.sum()), total))])
    left_out = {"saturated": int((~clean).sum()), "moving": int((clean & ~used).sum())}
    chosen = blocks.at(used)
    return BlockSelection(chosen, grouped(chosen, still[used]), still[used], rest[used], saturated, left_out, total)


def unclipped(ledger: Ledger, blocks: Blocks) -> Mask:
    """(B,) bool: no channel stood at its extreme, where that is the end of a range or rare enough to be one.

    Blocks are the ledger's, joined or not. A few clipped samples pass for none by the rule of `Rails`, and move a mean.
    A channel that runs into the end where the others say that nothing could take it there is itself at fault, and the
    blocks are kept to show it.
    """
    clean = np.ones(len(blocks), dtype=bool)
    others, peak = ledger.reference.others(blocks.mean), PEAK * np.sqrt(blocks.change)
    for sign, extreme, end in ((1.0, blocks.highest, ledger.ends[0]), (-1.0, blocks.lowest, ledger.ends[1])):
        touched = sign * extreme >= end.value[0]
        often = end.count[0] >= np.maximum(PILED * end.count[1], PILED)
        rare = touched.mean(axis=0) < RARE
        reached = sign * others + peak >= REACHED * sign * ledger.reference.felt(sign * end.value[0])
        own = (touched & ~reached).sum(axis=0) >= OFTEN
        touched &= reached | ~own
        clean &= ~(touched & (~np.isnan(end.limit) | (often & rare))).any(axis=1)
    return clean


PILED = 2
"""Times as often as at the reading next to it that a channel must stand at its extreme, where it is the end of a range;
of the tail of noise fewer stand there than next to it."""
PEAK = 8.0
"""Root mean square changes of what a sensor feels from sample to sample, beyond which vibration hardly takes it."""
REACHED = 0.8
"""Part of the way to the end of a range that vibration must drive a channel for it to be cut off there."""
OFTEN = 5
"""Blocks in which a channel at fault runs into the end."""
RARE = 0.05
"""Share of the blocks in which a channel may stand at its extreme for it to pass for the end of a range."""


def at_rest(blocks: Blocks, clean: Mask) -> Mask:
    """(B,) bool: as quiet as the quietest, if those are quiet: nothing but noise from one sample to the next."""
    motion = blocks.motion.mean(axis=1)
    floor = np.quantile(motion[clean], FLOOR)
    quietest = clean & (motion <= floor)
    if floor > RESTLESS * np.median(blocks.jitter[quietest].mean(axis=1)):
        return np.zeros(len(blocks), dtype=bool)
    return np.asarray(motion <= MOVING * floor)


def wanted(blocks: Blocks, ledger: Ledger, still: Mask, clean: Mask, motion: str) -> Mask:
    """(B,) bool: what the kind of motion asks for."""
    if motion == ANY or ledger.averaged:
        return np.ones_like(still)
    if motion == STILL:
        return still
    rest, moving = clean & still, clean & ~still
    if rest.sum() < ENOUGH_STILL or not moving.any():
        return np.ones_like(still)
    p = blocks.mean @ ledger.reference.parity
    p = ((p - p[rest].mean(axis=0)) ** 2).sum(axis=1)
    return still if p[moving].mean() > SPOILT * p[rest].mean() else np.ones_like(still)


def grouped(blocks: Blocks, still: Mask) -> NDArray[np.intp]:
    """(B,) number of the group of each block: stretches of one kind, long ones cut, short ones joined."""
    aim = max(len(blocks) / GROUPS, 1.0)
    breaks = (np.diff(blocks.first) > 1) | (np.diff(still.astype(np.int8)) != 0)
    edges = np.concatenate([[0], np.flatnonzero(breaks) + 1, [len(blocks)]])
    lengths: list[int] = []
    for length in np.diff(edges).tolist():
        pieces = 1 if length <= 2 * aim else round(length / aim)
        parts = np.diff(np.round(np.linspace(0, length, pieces + 1)).astype(int)).tolist()
        if lengths and (lengths[-1] < aim / 2 or (length < aim / 2 and lengths[-1] < aim)):
            lengths[-1] += parts.pop(0)
        lengths.extend(parts)
    return np.repeat(np.arange(len(lengths)), lengths)


def too_short(total: int, ledger: Ledger) -> str:
    """States the length that is missing, as a message."""
    if ledger.averaged:
        parts = {"total": few(total, "row"), "fewest_groups": FEWEST_GROUPS}
        return say("{total} to know their noise; give {fewest_groups} or more", **parts)
    held = counted(total, "block")
    return say(
        "the recording holds {groups} of one second; parity needs {fewest_groups} or more: record longer",
        groups=held,
        fewest_groups=FEWEST_GROUPS,
    )


def too_saturated(saturated: tuple[str, ...], total: int, clean: int) -> str:
    """Names the saturated channels, as a message."""
    listed = joined(", ", saturated)
    return say(
        "{listed} was at the end of the range in {total} of {total2} blocks; clipped readings cannot be judged: "
        "repair the channel, or record with less motion or a wider range",
        listed=listed,
        total=total - clean,
        total2=total,
    )


def never_still(used: int, total: int) -> str:
    """States that nothing in the recording is at rest, as a message."""
    return (
        say(
            "only {used} of {total} blocks is at rest, {fewest_groups} are needed; keep the block still for longer, "
            "or judge it in motion if its sensors are at one point",
            used=used,
            total=total,
            fewest_groups=FEWEST_GROUPS,
        )
        if used == 1
        else say(
            "only {used} of {total} blocks are at rest, {fewest_groups} are needed; keep the block still for longer, "
            "or judge it in motion if its sensors are at one point",
            used=used,
            total=total,
            fewest_groups=FEWEST_GROUPS,
        )
    )
