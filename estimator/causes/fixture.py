"""Causes in how the block sits in its fixture."""

from estimator.arrays import crossed
from estimator.causes.contract import CommonCause, Setting
from estimator.rotations import left_jacobian
from estimator.session import Array


def turned(n: Array) -> Array:
    """(R, m, 3, 3) change −k×n of applied vectors n (R, m, 3), m/s² (rad/s) per rad of each component of a turn k."""
    return -crossed(n)


class FlipMisalignment(CommonCause):
    identifier = "flip-misalignment"
    scope = "fixture"
    equation = "n → exp(−k×)·n in the flipped run"
    units = ("rad", "rad", "rad")
    amplitude_words = ("about x", "about y", "about z")
    needs = frozenset({"stand", "both runs"})
    turns_flipped_run = True
    sentence = "The block was seated differently after it was turned over in its fixture."
    advice = "Clean the mounting faces, seat the block against its stops and repeat the flipped run."

    def change(self, setting: Setting) -> Array:
        """(R, m, 3, 3) −dθ×n in the flipped run, m/s² (rad/s) per rad.

        About the turn k0 that n has already, exp(−(k0 + dk)×) = exp(−dθ×)·exp(−k0×) with dθ = J(−k0)·dk.
        """
        assert setting.flipped is not None
        acts = setting.flipped.astype(float)[:, None, None, None]
        return turned(setting.n) * acts @ left_jacobian(-setting.flip_turn)


class RemountRotation(CommonCause):
    identifier = "remount-rotation"
    scope = "fixture"
    equation = "all axes of the block turn together by the rotation vector k: e → exp(k×)·e since the history"
    units = ("rad", "rad", "rad")
    amplitude_words = ("about x", "about y", "about z")
    needs = frozenset({"stand or directions", "history"})
    between = True
    turns_block = True
    sentence = "The whole block is rotated in its fixture relative to earlier sessions."
    advice = "Remount the block and repeat, or enter the rotation in the mounting; no sensor needs repair."

    def change(self, setting: Setting) -> Array:
        """(R, m, 3, 3) −dθ×n, m/s² (rad/s) per rad, since e·(n − dθ×n) = (e + dθ×e)·n.

        About the turn k0 that the block has, exp((k0 + dk)×) = exp(dθ×)·exp(k0×) with dθ = J(k0)·dk.
        """
        return turned(setting.n) @ left_jacobian(setting.turn)
