"""Interrupts, which end everything or nothing, and temporary folders, which they do not leave behind.

Python raises an interrupt wherever the main thread happens to be, and drops it where that is a finaliser, a callback of
a foreign library or a hook of a fork; forking a large process takes long enough for that to happen now and then.
"""

from __future__ import annotations

import _thread
import shutil
import signal
import sys
import tempfile
import threading
import time
import weakref
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import Path
from types import FrameType
from typing import Self

_PATIENCE = 0.2  # seconds after which an interrupt that has not arrived is raised once more
# Whether the main thread must not be interrupted: a signal that it has blocked reaches it through other threads.
_HELD_BACK = ContextVar("_HELD_BACK", default=False)


@contextmanager
def uninterrupted() -> Iterator[None]:
    """Hold interrupts back until the body is done; processes that it starts never see one."""
    masked = hasattr(signal, "pthread_sigmask")  # not on Windows
    before = signal.pthread_sigmask(signal.SIG_BLOCK, ()) if masked else set()
    held = _HELD_BACK.set(True)
    try:
        if masked:
            signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
        yield
    finally:
        try:  # one that waited arrives here, while it is still held back: it would leave the mask as it is
            if masked:
                signal.pthread_sigmask(signal.SIG_SETMASK, before)
        finally:
            _HELD_BACK.reset(held)


@contextmanager
def interruptible(number: signal.Signals = signal.SIGINT) -> Iterator[None]:
    """Make sure that an interrupt ends the body: it is raised again until it is under way, and then no more.

    Who ignores interrupts goes on ignoring them; only the main thread can do otherwise.
    """
    main = threading.main_thread()
    if threading.current_thread() is not main or signal.getsignal(number) is signal.SIG_IGN:
        yield
        return
    noted: list[int] = []
    over = threading.Event()
    sending = _thread.allocate_lock()

    def _insist() -> None:
        while True:
            time.sleep(_PATIENCE)
            with sending:
                if over.is_set():
                    return
                signal.pthread_kill(main.ident or 0, number)

    def _interrupt(number: int, _frame: FrameType | None) -> None:
        error = sys.exception()
        while error is not None and not isinstance(error, KeyboardInterrupt):
            error = error.__context__
        if error is not None:  # it is an interrupt, or was raised while one was under way
            return
        if not noted:
            noted.append(number)
            _thread.start_new_thread(_insist, ())  # what threading starts would wait for locks that may be held here
        if not _HELD_BACK.get():
            raise KeyboardInterrupt

    def _unraisable(what: sys.UnraisableHookArgs) -> None:
        if not isinstance(what.exc_value, KeyboardInterrupt):
            hook(what)

    hook, before = sys.unraisablehook, signal.signal(number, _interrupt)
    sys.unraisablehook = _unraisable
    try:
        yield
        if noted:
            raise KeyboardInterrupt
    finally:
        with sending:
            over.set()
        signal.signal(number, before)
        sys.unraisablehook = hook


class TemporaryFolder:
    """A folder that goes with this object, whole: interrupts wait while it is made and while it is removed.

    Removed at the end of a ``with`` block, or when nobody holds the object any more, at the latest when Python ends.
    """

    def __init__(self) -> None:
        with uninterrupted():
            self.path = Path(tempfile.mkdtemp(prefix="derive-"))
            self._remove = weakref.finalize(self, _remove_folder, self.path)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: object) -> None:
        self.cleanup()

    def cleanup(self) -> None:
        """Remove it now."""
        with uninterrupted():
            self._remove()

    def keep(self) -> None:
        """Leave it to whom a message sends there."""
        self._remove.detach()


def _remove_folder(path: Path) -> None:
    """A file that a system does not let go of, as a loaded library on Windows, is no reason to fail."""
    with uninterrupted():
        shutil.rmtree(path, ignore_errors=True)
