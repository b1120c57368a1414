"""Interrupts wait where they would leave something behind, and arrive afterwards; temporary folders go whole."""

import os
import shutil
import signal
import threading
from collections.abc import Iterator
from functools import partial
from pathlib import Path

import pytest

from derive.interrupts import TemporaryFolder, interruptible, uninterrupted

posix = pytest.mark.skipif(not hasattr(signal, "pthread_kill"), reason="interrupts are tested on POSIX systems")


@pytest.fixture(autouse=True)
def interrupts_are_heeded() -> Iterator[None]:
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


class Elsewhere:
    """Another thread, which receives the signals that the main thread has blocked."""

    def __init__(self) -> None:
        self._wanted, self._sent = threading.Event(), threading.Event()
        threading.Thread(target=self._send, daemon=True).start()

    def _send(self) -> None:
        self._wanted.wait()
        signal.pthread_kill(threading.get_ident(), signal.SIGINT)
        self._sent.set()

    def interrupt(self) -> None:
        self._wanted.set()
        self._sent.wait()


def test_a_folder_goes_with_its_block_or_with_its_last_holder() -> None:
    with TemporaryFolder() as folder:
        (folder.path / "file").write_text("")
    assert not folder.path.exists()
    held = TemporaryFolder()
    path = held.path
    assert path.is_dir()
    del held
    assert not path.exists()


def test_a_folder_that_a_message_names_is_kept() -> None:
    with TemporaryFolder() as folder:
        folder.keep()
    assert folder.path.is_dir()
    folder.path.rmdir()


@posix
@pytest.mark.parametrize("through", ["the main thread", "another thread"])
def test_an_interrupt_waits_until_a_folder_is_gone(through: str, monkeypatch: pytest.MonkeyPatch) -> None:
    here = partial(os.kill, os.getpid(), signal.SIGINT)  # as a terminal does, where there is but one thread
    interrupt = here if through == "the main thread" else Elsewhere().interrupt
    remove = shutil.rmtree

    def slowly(path: Path, ignore_errors: bool) -> None:
        interrupt()
        for _ in range(1000):  # Python raises interrupts between two of its steps
            pass
        remove(path, ignore_errors)

    monkeypatch.setattr(shutil, "rmtree", slowly)
    with pytest.raises(KeyboardInterrupt), interruptible(), TemporaryFolder() as folder:
        (folder.path / "file").write_text("")
    assert not folder.path.exists()


@posix
def test_an_interrupt_that_had_to_wait_ends_the_body_all_the_same() -> None:
    elsewhere = Elsewhere()
    done = []

    def body() -> None:
        with uninterrupted():
            elsewhere.interrupt()
            done.append("all of it")
        threading.Event().wait(60)
        done.append("too long")

    with pytest.raises(KeyboardInterrupt), interruptible():
        body()
    assert done == ["all of it"]
