"""Memory of large files, given back to the system when they are done with."""

import ctypes
import sys

M_MMAP_THRESHOLD = -3
"""Option of glibc's `mallopt` (malloc.h)."""
LARGE = 1024 * 1024
"""Bytes. Blocks from here on are given back at once. Left alone, glibc raises this to the size of the largest one that
was freed, up to 32 MiB, and then keeps all smaller ones."""


def give_back_large_blocks() -> bool:
    """Whether the C library of this process could be told to."""
    if sys.platform != "linux":
        return False
    library = ctypes.CDLL(None)
    return hasattr(library, "mallopt") and library.mallopt(M_MMAP_THRESHOLD, LARGE) == 1
