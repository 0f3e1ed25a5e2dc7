"""The numerical library is held to one thread, unless an operator says otherwise."""

import os
import subprocess
import sys

SCRIPT = "import sys, os, service; print(os.environ['OPENBLAS_NUM_THREADS'], 'numpy' in sys.modules)"


def said(**setting: str) -> str:
    """Number of threads that a fresh process asks for, and whether numpy is loaded."""
    environment = {k: v for k, v in os.environ.items() if k != "OPENBLAS_NUM_THREADS"} | setting
    done = subprocess.run([sys.executable, "-c", SCRIPT], env=environment, capture_output=True, text=True, check=True)
    return done.stdout.strip()


def test_one_thread_is_asked_for_before_numpy_is_loaded() -> None:
    assert said() == "1 False"


def test_an_operator_s_own_setting_wins() -> None:
    assert said(OPENBLAS_NUM_THREADS="4") == "4 False"
