"""Long work as generators: driven to the end, as a part of other work, and ended on the way."""

import sys
import threading
import time

import pytest

from spectral_skylight.addon.bar import Bar
from spectral_skylight.addon.commands.progress_bar import run_with_bar
from spectral_skylight.addon.progress import Progress, a_while, aside, mapped, on_main, run, timed


class Work:
    """Three steps, and whether they were ended in order."""

    def __init__(self):
        self.ended = False

    def steps(self):
        try:
            for number in range(3):
                yield Progress(number / 3, f"number {number}")
            return "made"
        finally:
            self.ended = True


def half(progress):
    return Progress(progress.done / 2, f"half {progress.line}")


def test_work_is_done_and_returns_what_it_made():
    told = []
    assert run(Work().steps(), told.append) == "made" == run(Work().steps())
    assert [step.done for step in told] == [0.0, 1 / 3, 2 / 3]


def test_work_as_a_part_of_other_work():
    def whole():
        made = yield from mapped(Work().steps(), half)
        yield Progress(1.0, made)
        return made

    told = []
    assert run(whole(), told.append) == "made"
    assert [(step.done, step.line) for step in told] == [
        (0.0, "half number 0"),
        (1 / 6, "half number 1"),
        (1 / 3, "half number 2"),
        (1.0, "made"),
    ]


def test_whoever_closes_the_whole_closes_the_part():
    work = Work()
    part = work.steps()
    whole = mapped(part, half)
    next(whole)
    assert not work.ended
    whole.close()
    assert work.ended


def test_time_is_that_of_the_work_alone():
    def work():
        until = time.process_time() + 0.05
        while time.process_time() < until:
            pass
        yield Progress(0.5, "half")
        return "made"

    steps = timed(work())
    next(steps)
    until = time.process_time() + 0.2  # what others do meanwhile
    while time.process_time() < until:
        pass
    done, seconds = run(steps)
    assert done == "made" and 0.05 <= seconds < 0.15


def test_what_goes_wrong_in_the_part_reaches_the_whole():
    def broken():
        yield Progress(0.0, "")
        raise ValueError("broken")

    with pytest.raises(ValueError, match="broken"):
        run(mapped(broken(), half))


def slow():
    for step in Work().steps():
        time.sleep(0.15)  # a bar is drawn ten times a second at most
        yield step
    return "made"


def test_a_bar_shows_it_and_goes(capsys, monkeypatch):
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    assert run_with_bar(slow(), "paint") == "made"
    assert "paint number 2" in capsys.readouterr().err


def test_a_file_gets_no_bar_but_a_line_that_stays(capsys):
    assert run_with_bar(slow(), "paint") == "made"
    bar = Bar()
    bar.show("batch", 0.5, "1/2")
    bar.show("batch", 1.0, "2/2")
    bar.close(leave=True)
    assert capsys.readouterr().err == f"batch {'#' * 20} 2/2\n"


AT = Progress(0.5, "aside")


def to_its_end(work):
    """Work between events; what it returned, and its steps."""
    steps = []
    while True:
        try:
            steps.append(a_while(work, 0.0))
        except StopIteration as end:
            return end.value, steps


def test_without_a_window_nothing_goes_aside():
    assert run(aside(AT, threading.get_ident)) == threading.get_ident()


def test_between_events_what_takes_long_goes_aside():
    """A window has its time meanwhile: what waits for an event goes on only if there is any."""
    happened = threading.Event()

    def work(name):
        assert happened.wait(10)
        return name, threading.get_ident()

    going = aside(AT, work, "made")
    first = a_while(going, 0.0)
    assert (first.done, first.line, first.waits) == (0.5, "aside", True)
    happened.set()
    (name, thread), _ = to_its_end(going)
    assert name == "made" and thread != threading.get_ident()


def test_what_belongs_to_the_main_thread_is_asked_of_it():
    def work():
        return threading.get_ident(), on_main(threading.get_ident)

    (own, main), _ = to_its_end(aside(AT, work))
    assert main == threading.get_ident() != own
    assert on_main(threading.get_ident) == main

    def fails():
        try:
            on_main(lambda: 1 / 0)
        except ZeroDivisionError:
            return "heard"

    assert to_its_end(aside(AT, fails))[0] == "heard"
    with pytest.raises(ZeroDivisionError):
        to_its_end(aside(AT, lambda: 1 / 0))


def test_closed_it_leaves_the_work_to_end_by_itself():
    """At once, also where that asks something; the next has its turn then."""
    closed, ended = threading.Event(), threading.Event()

    def work():
        try:
            assert closed.wait(10)
            on_main(lambda: pytest.fail("nobody is there to answer"))
        finally:
            ended.set()

    going = aside(AT, work)
    a_while(going, 0.0)
    going.close()
    closed.set()
    assert to_its_end(aside(AT, lambda: "next"))[0] == "next"
    assert ended.wait(10)
