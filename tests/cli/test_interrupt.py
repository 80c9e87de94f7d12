"""A signal ends the work once, in order, wherever it comes; and what was ignored stays ignored."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
import time

import pytest

from tyrefrf.cli.interrupt import Interrupted, heeding_signals

SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


@pytest.fixture(autouse=True)
def heeded():
    """These tests may be told to ignore signals themselves, as what runs in the background is."""
    before = {number: signal.getsignal(number) for number in SIGNALS}
    for number in SIGNALS:
        signal.signal(number, signal.SIG_DFL)
    yield
    for number, handler in before.items():
        signal.signal(number, handler)


def send(number):
    os.kill(os.getpid(), number)
    time.sleep(1.0)  # until it has come


@pytest.mark.parametrize("number", SIGNALS)
def test_a_signal_is_raised_with_its_exit_status(number):
    words = f"interrupted by {number.name}"
    with pytest.raises(Interrupted, match=words) as raised, heeding_signals():
        send(number)
    assert raised.value.status == 128 + number


def test_afterwards_signals_do_what_they_did():
    before = {number: signal.getsignal(number) for number in SIGNALS}
    hook = sys.unraisablehook
    with pytest.raises(Interrupted), heeding_signals():
        send(signal.SIGTERM)
    assert {number: signal.getsignal(number) for number in before} == before
    assert sys.unraisablehook is hook


def test_an_ignored_signal_stays_ignored():
    signal.signal(signal.SIGHUP, signal.SIG_IGN)
    with heeding_signals():
        send(signal.SIGHUP)


class Destroyed:
    """An object in whose destruction a signal comes, and Python lets no exception through."""

    def __del__(self):
        send(signal.SIGTERM)


def test_a_signal_in_an_object_s_destruction_is_not_lost():
    def destroyed():
        del [Destroyed()][0]
        time.sleep(5.0)
        pytest.fail("the signal was lost")

    with pytest.raises(Interrupted, match="SIGTERM"), heeding_signals():
        destroyed()


def test_a_second_signal_ends_the_process_at_once():
    program = """
import os, signal, time
from tyrefrf.cli.interrupt import Interrupted, heeding_signals
with heeding_signals():
    try:
        os.kill(os.getpid(), signal.SIGTERM)
        time.sleep(5.0)
    except Interrupted:
        os.kill(os.getpid(), signal.SIGINT)
        time.sleep(5.0)
"""
    done = subprocess.run([sys.executable, "-c", program], check=False)
    assert done.returncode == -signal.SIGINT


def test_in_another_thread_nothing_is_asked_for():
    before = signal.getsignal(signal.SIGTERM)
    seen = []

    def work():
        with heeding_signals():
            seen.append(signal.getsignal(signal.SIGTERM))

    thread = threading.Thread(target=work)
    thread.start()
    thread.join()
    assert seen == [before]


def test_ctrl_c_before_the_program_has_begun_ends_it_without_a_word():
    """Python itself is beginning until then; main.py takes some tenths of a second more."""
    program = """
import os, signal, sys, types
main = types.ModuleType("tyrefrf.cli.main")
main.__getattr__ = lambda name: os.kill(os.getpid(), signal.SIGINT)
sys.modules["tyrefrf.cli.main"] = main
from tyrefrf.cli.start import command
command()
"""
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stderr) == (-signal.SIGINT, "")
