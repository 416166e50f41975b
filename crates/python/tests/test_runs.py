"""Runs: the same numbers as the command's, in threads, after interruptions; and what ends them."""

import copy
import csv
import multiprocessing
import os
import pickle
import signal
import subprocess
import sys
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

import moreau_fem as mc
from conftest import EXAMPLES, LOAD


def column(history, name):
    return np.asarray(history[name])


def bits(simulation):
    history = simulation.history
    return [simulation.displacement.tobytes(), simulation.stress.tobytes()] + [
        column(history, name).tobytes() for name in history
    ]


def test_the_command_of_the_wheel_has_the_same_numbers(block, tmp_path):
    moreau = Path(sys.executable).with_name("moreau")
    out = tmp_path / "results"
    done = subprocess.run([moreau, "run", block, "--out", out, "--verify", "--quiet"], capture_output=True)
    assert done.returncode == 0, done.stderr
    with open(out / "history.csv") as file:
        rows = list(csv.DictReader(file))
    history = mc.run(block).history
    written = [float(row["force.punch.y [N]"]) for row in rows]
    assert written == column(history, "force.punch.y").tolist()
    assert written[-1] == pytest.approx(LOAD, rel=1e-9)
    wrong = subprocess.run([moreau, "run", "nowhere.toml"], capture_output=True, text=True)
    assert wrong.returncode == 1 and "nowhere.toml" in wrong.stderr


@pytest.mark.skipif(os.name != "posix", reason="signals")
def test_the_command_of_the_wheel_has_its_own_answer_to_an_interrupt(block, tmp_path):
    deck, out = tmp_path / "deck.toml", tmp_path / "results"
    large = mc.Deck(block).with_({"mesh.block.0.cells": [60, 24], "step.0.increments": 400})
    large.to_toml(deck)
    moreau = Path(sys.executable).with_name("moreau")
    running = subprocess.Popen([moreau, "run", deck, "--out", out], stderr=subprocess.PIPE, text=True)
    while "increment 2 " not in running.stderr.readline():
        assert running.poll() is None
    running.send_signal(signal.SIGINT)
    _, told = running.communicate(timeout=60)
    assert running.returncode == 2 and "moreau resume" in told


def test_twenty_runs_in_threads_have_the_bits_of_one_alone(block):
    alone = bits(mc.run(block).simulation)
    with ThreadPoolExecutor(4) as pool:
        for simulation in pool.map(lambda _: mc.run(block).simulation, range(20)):
            assert bits(simulation) == alone


def test_the_interpreter_is_free_meanwhile(block):
    ticks, done = [0], threading.Event()

    def tick():
        while not done.is_set():
            ticks[0] += 1
            time.sleep(1e-3)

    deck = mc.Deck(block).with_({"mesh.block.0.cells": [60, 24], "step.0.increments": 40})
    simulation = mc.Simulation(deck)
    thread = threading.Thread(target=tick)
    thread.start()
    before, start = ticks[0], time.perf_counter()
    simulation._core.advance()
    seen, seconds = ticks[0] - before, time.perf_counter() - start
    done.set()
    thread.join()
    assert seen > 0.1 * seconds / 1e-3, f"{seen} ticks in {seconds} s"


@pytest.fixture
def interrupts():
    """Interrupts, while it is armed, that come so many seconds after it was."""
    if os.name != "posix":
        pytest.skip("signals are those of posix")
    armed = [False]

    def interrupt(*_):
        if armed[0]:
            raise KeyboardInterrupt

    def after(seconds):
        armed[0] = seconds is not None
        signal.setitimer(signal.ITIMER_REAL, seconds or 0.0)

    kept = signal.signal(signal.SIGALRM, interrupt)
    yield after
    after(None)
    signal.signal(signal.SIGALRM, kept)


def test_an_interrupt_within_an_increment_loses_nothing_and_the_end_is_the_same(block, interrupts):
    deck = mc.Deck(block).with_({"mesh.block.0.cells": [100, 40], "step.0.increments": 40})
    increments, start = 5, time.perf_counter()
    undisturbed = mc.Simulation(deck)
    for _ in range(increments):
        next(undisturbed)
    seconds = (time.perf_counter() - start) / increments
    simulation, inside = mc.Simulation(deck), 0
    while simulation.increments < increments:
        committed, state = simulation.increments, simulation.displacement
        try:
            interrupts(0.3 * seconds)
            next(simulation)
            interrupts(None)
        except KeyboardInterrupt:
            interrupts(None)
            if simulation.increments == committed:
                inside += 1
                assert np.array_equal(simulation.displacement, state)
                # Now as long as it takes.
                next(simulation)
    assert inside >= 3
    assert bits(simulation) == bits(undisturbed)


def test_loads_beyond_collapse_are_an_exception_with_the_load(collapsing):
    with pytest.raises(mc.Collapse) as collapse:
        mc.run(collapsing)
    error = collapse.value
    assert error.load_factor == pytest.approx(0.5, rel=1e-5)
    assert error.upper == pytest.approx(error.lower, rel=1e-5)
    assert error.result.simulation.increments > 0
    # Where a step is for that, it is an answer.
    result = mc.run(EXAMPLES / "cylinder-to-collapse.toml")
    assert result.outcome["collapse"]["load_factor"] > 0 and result.outcome["status"] == "done"


def test_a_step_that_stops_is_an_exception_with_its_reasons(block):
    # Pulled off its foundation: there is no equilibrium.
    deck = mc.Deck(block).with_({"step.0.load": [dict(on="punch", pressure=-10)]})
    keys = deck.keys
    del keys["expect"], keys["step"][0]["move"]
    with pytest.raises(mc.NotConverged) as stopped:
        mc.run(keys)
    error = stopped.value
    assert "press" in str(error) and error.suggestion and error.plastic_fraction == 0.0
    assert error.worst == [] or error.worst[0]["force"] > 0
    assert error.result.outcome["status"] == "not converged"
    simulation = error.result.simulation
    with pytest.raises(mc.NotConverged):
        next(simulation)
    # It goes on from there with something that it can do.
    simulation.step = dict(name="less", increments=1, fix=[dict(on="block.left", u=["x"])],
                           move=[dict(on="punch", u=dict(y=-0.001))])
    assert next(simulation).increment == simulation.increments


def test_a_simulation_is_of_one_thread_at_a_time(block):
    deck = mc.Deck(block).with_({"mesh.block.0.cells": [100, 40]})
    simulation = mc.Simulation(deck)
    thread = threading.Thread(target=simulation._core.advance)
    thread.start()
    with pytest.raises(RuntimeError, match="another thread"):
        while thread.is_alive():
            simulation.displacement
    thread.join()
    assert simulation.increments == 1


def test_a_state_that_is_none_is_refused(block):
    simulation = mc.Simulation(block)
    next(simulation)
    saved = simulation.save()
    for state in [b"", b"a picture", saved[:-8], saved.replace(b"0.3", b"0.4", 1)]:
        with pytest.raises(ValueError):
            mc.Simulation.restore(state)
    assert bits(mc.Simulation.restore(saved)) == bits(simulation)


def end_of(deck):
    return column(mc.run(deck).history, "force.punch.y")[-1]


def test_errors_come_back_from_other_processes(block, collapsing):
    good = mc.Deck(block)
    wrong = good.with_({"contact.0.friction": -0.1})
    with multiprocessing.get_context("spawn").Pool(2) as pool:
        answers = [pool.apply_async(end_of, [deck]) for deck in (good, wrong, collapsing)]
        assert answers[0].get(60) == end_of(good)
        with pytest.raises(mc.DeckError, match="friction") as refused:
            answers[1].get(60)
        with pytest.raises(mc.Collapse) as collapse:
            answers[2].get(60)
    assert any(finding.label for finding in refused.value.findings)
    assert collapse.value.load_factor == pytest.approx(0.5, rel=1e-5) and collapse.value.result is None


def test_every_error_is_pickled_with_what_it_says(block, collapsing):
    pulled = mc.Deck(block).with_({"step.0.load": [dict(on="punch", pressure=-10)]}).keys
    del pulled["expect"], pulled["step"][0]["move"]
    law = mc.LawError("at a point", 3, 1, (0.5, 0.25))
    for deck, kind in [("a = 1\n", mc.DeckError), (pulled, mc.NotConverged), (collapsing, mc.Collapse), (law, mc.LawError)]:
        with pytest.raises(kind) as caught:
            if deck is law:
                raise law
            mc.run(deck)
        error = caught.value
        again = pickle.loads(pickle.dumps(error))
        assert type(again) is kind and str(again) == str(error)
        told = {"findings", "cell", "point", "position", "worst", "suggestion", "plastic_fraction", "load_factor", "upper"}
        told &= set(dir(error))
        assert told and all(getattr(again, name) == getattr(error, name) for name in told)


def test_copies_and_pickled_simulations_go_on_by_themselves(block):
    simulation = mc.Simulation(block)
    for _ in range(3):
        next(simulation)
    before = bits(simulation)
    others = [copy.copy(simulation), copy.deepcopy(simulation), pickle.loads(pickle.dumps(simulation))]
    for other in others:
        assert bits(other) == before
        next(other)
        assert bits(simulation) == before != bits(other)
    next(simulation)
    assert all(bits(other) == bits(simulation) for other in others)
    result = mc.run(block)
    again = pickle.loads(pickle.dumps(result))
    assert str(again) == str(result) and bits(again.simulation) == bits(result.simulation)


def test_the_deck_says_where_a_step_was_given_up(block):
    simulation = mc.Simulation(block)
    back = dict(increments=2, fix=[dict(on="block.left", u=["x"])])
    move = lambda y: dict(move=[dict(on="punch", u=dict(y=y))])
    for _ in range(5):
        next(simulation)
    simulation.step = dict(name="less", **back, **move(-0.001))
    given_up = '# Step "press" was given up at 0.25 of it: run anew, it is done whole.\n'
    assert given_up in simulation.deck.text
    # One that was done whole is not given up; what was said stays, in what is saved and written too.
    for _ in simulation:
        pass
    simulation.step = dict(name="more", **back, **move(-0.002))
    assert simulation.deck.comments.count("given up") == 1
    next(simulation)
    again = mc.Simulation.restore(simulation.save())
    again.step = dict(name="none", **back, **move(0.0))
    assert given_up in again.deck.to_toml() and '"more" was given up at 0.5 of it' in again.deck.to_toml()
    assert [step["name"] for step in again.deck["step"]] == ["press", "less", "more", "none"]


def test_what_is_no_step_is_refused(block):
    simulation = mc.Simulation(block)
    with pytest.raises(IndexError, match="no increment has converged yet"):
        simulation.last
    next(simulation)
    for wrong in (3, [dict(name="more", increments=2)], None):
        with pytest.raises(TypeError, match=r"step is .*, expected the keys of one, as dict\(name="):
            simulation.step = wrong
    assert simulation.last == mc.Simulation.restore(simulation.save()).last
