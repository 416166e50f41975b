"""What the documentation promises, as a user writes it."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

import moreau_fem as mc
from conftest import LOAD

pd = pytest.importorskip("pandas")


def ring(friction: float = 0.1, cells: tuple[int, int] = (6, 4)) -> mc.Deck:
    return mc.Deck(
        units="mm-N-MPa",
        analysis="axisymmetric",
        mesh=mc.block("ring", "quad8", x=[3, 6], y=[0, 2], cells=list(cells)),
        material=[
            dict(on="ring", young=70e3, poisson=0.33, yield_stress=100.0, hardening=lambda p: 250 * p**0.2)
        ],
        tool=[dict(name="die", plane=dict(point=[0, 2], normal=[0, -1]))],
        contact=[dict(surface="ring.top", against="die", friction=friction)],
        step=[
            dict(
                name="press",
                increments=5,
                fix=[dict(on="ring.bottom", u=["y"])],
                tools=[dict(name="die", move=[0, -0.02])],
            )
        ],
        output=dict(probes=["ring.left"]),
    )


def test_a_deck_is_run(block):
    result = mc.run(block)
    assert "certificate" in str(result)
    assert result.history["force.punch.y"].iloc[-1] == pytest.approx(LOAD, rel=1e-9)
    units = result.history.attrs["units"]
    assert units["force.punch.y"] == "N" and "step" not in units
    assert result.history["increment"].dtype == np.int64
    assert len(result.contacts) == 21 and result.outcome["status"] == "done"


def test_a_model_in_code_is_checked_as_a_deck_is(tmp_path):
    deck = ring()
    assert (deck.check()["severity"] != "error").all()
    deck.to_toml(tmp_path / "ring.toml")
    again = mc.run(tmp_path / "ring.toml").history
    pd.testing.assert_frame_equal(again, mc.run(deck).history)
    wrong = ring().with_({"contact.0.surface": "ring.tpo"})
    assert list(wrong.check()["severity"]) == ["error"]
    with pytest.raises(mc.DeckError) as refused:
        mc.run(wrong)
    assert 'did you mean "ring.top"?' in str(refused.value) and "━━━" in str(refused.value)
    finding = refused.value.findings[0]
    line = wrong.text.splitlines()[finding.line - 1]
    assert line[finding.column - 1 :].startswith('"ring.tpo"')


def test_a_study_in_threads():
    deck, mu = ring(), np.linspace(0, 0.5, 5)
    with ThreadPoolExecutor() as pool:
        runs = list(pool.map(lambda m: mc.run(deck.with_({"contact.0.friction": m})), mu))
    table = mc.table(
        runs, mu=lambda r: r.deck["contact.0.friction"], load=lambda r: r.history["force.die.y"].iloc[-1]
    )
    assert list(table["mu"]) == list(mu)
    assert table["load"].is_monotonic_increasing or table["load"].is_monotonic_decreasing


def test_a_loop_that_reacts():
    sim = mc.Simulation(ring())
    for inc in sim:
        u, s = sim.displacement, sim.stress
        assert u.shape == (len(sim.nodes), 2) and s.shape[1] == 6
        if sim.contacts()["status"].eq("slip").mean() > 0.5 and inc.step == 1:
            sim.step = dict(name="unload", increments=2, tools=[dict(name="die", move=[0, 0])],
                            fix=[dict(on="ring.bottom", u=["y"])])
    assert inc.step == 2 and sim.done == 1.0
    # Lifted off: no force is left, and flow has left a shape.
    assert abs(sim.history["force.die.y"].iloc[-1]) < 1e-6
    assert sim.history["u.ring.left.x"].iloc[-1] != 0.0
    saved = sim.save()
    again = mc.Simulation.restore(saved)
    assert np.array_equal(again.displacement, sim.displacement)
    pd.testing.assert_frame_equal(again.history, sim.history)


def test_pictures(block):
    result = mc.run(block)
    assert result.plot("von_mises").svg.startswith("<svg")
    page = result._repr_html_()
    assert page.count("<svg") == 3 and "certificate" in page
    assert result.plot("stress.xx").svg.startswith("<svg")
    for field, magnification, words in [
        ("von_missis", None, "no field 'von_missis', expected one of displacement, .*; did you mean 'von_mises'"),
        ("stress", None, "'stress' is drawn by its components, expected one of stress.xx, .*, stress.xz"),
        ("stress.rr", None, "no field 'stress.rr'.*stress.xx"),
        ("von_mises", float("nan"), "magnification is nan, expected a finite number"),
    ]:
        with pytest.raises(ValueError, match=words):
            result.plot(field, magnification)
    with pytest.raises(ValueError, match="no increment has converged yet"):
        mc.Result(mc.Simulation(block)).plot()
    pyvista = pytest.importorskip("pyvista")
    grid = result.grid()
    assert isinstance(grid, pyvista.UnstructuredGrid)
    assert (grid.n_cells, grid.n_points) == (20, 85)
    warped = grid.warp_by_vector("displacement", factor=10)
    assert warped.n_points == 85 and grid.cell_data["stress"].shape == (20, 6)
    assert result.grid("points").n_points == 80


def test_friction_is_found_from_a_measured_ring():
    optimize = pytest.importorskip("scipy.optimize")
    measured = mc.run(ring(0.12)).history

    def misfit(x):
        h = mc.run(ring(x[0]), quiet=True).history
        return np.interp(-measured["u.die.y"], -h["u.die.y"], h["u.ring.left.x"]) - measured["u.ring.left.x"]

    fit = optimize.least_squares(misfit, [0.1], bounds=([0], [0.577]), x_scale=[0.1], diff_step=1e-4)
    assert fit.x[0] == pytest.approx(0.12, abs=1e-6)
