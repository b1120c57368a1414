"""Compilers at work beside the rest: an interrupt at any moment ends both."""

import signal
import sys
import threading
import time
from itertools import count
from types import FrameType
from typing import Any

import pytest

from derive import interrupts
from derive.targets.compiler import compiling_meanwhile


class Interrupt:
    """Raises an interrupt at the given event of the interpreter, wherever that is; but not where it is held back."""

    def __init__(self, moment: int) -> None:
        self.left = moment

    def __call__(self, frame: FrameType, _event: str, _value: Any) -> "Interrupt":
        frame.f_trace_lines = False  # signals arrive where functions begin and end
        if not interrupts._HELD_BACK.get():
            self.left -= 1
            if self.left == 0:
                raise KeyboardInterrupt
        return self


def interrupted_at(moment: int) -> bool:
    """Whether work of some milliseconds and waiting for it were over only after that many events."""
    before, interrupt = sys.gettrace(), Interrupt(moment)
    sys.settrace(interrupt)
    try:
        with compiling_meanwhile(time.sleep, 0.003) as slept:
            slept()
    except KeyboardInterrupt:
        return True
    finally:
        sys.settrace(before)
    return interrupt.left <= 0


@pytest.mark.skipif(sys.platform == "win32", reason="signals are held back on POSIX systems")
def test_an_interrupt_at_any_moment_lets_the_work_end() -> None:
    before, blocked = set(threading.enumerate()), signal.pthread_sigmask(signal.SIG_BLOCK, ())
    moments = next(moment for moment in count(1) if not interrupted_at(moment))
    assert moments > 20
    assert signal.pthread_sigmask(signal.SIG_BLOCK, ()) == blocked
    for thread in set(threading.enumerate()) - before:
        thread.join(10)
        assert not thread.is_alive()


def test_what_the_work_raises_is_raised_where_its_result_is_asked_for() -> None:
    with (
        pytest.raises(ZeroDivisionError),
        compiling_meanwhile(lambda: 1 // 0) as quotient,
    ):
        quotient()
