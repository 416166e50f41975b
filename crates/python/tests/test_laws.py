"""Laws in Python: the numbers of those of the core, what is wrong with them, and what they cost."""

import copy
import pickle
import time
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

import moreau_fem as mc
from conftest import LOAD

D = np.array([1.0, 1.0, 1.0, 0.0, 0.0, 0.0])
DEVIATOR = np.eye(6) - np.outer(D, D) / 3.0


class VonMises:
    """Isotropic elasticity and the criterion of von Mises, with linear isotropic hardening."""

    state = {"elastic_strain": 6, "p": 1}

    def __init__(self, young, poisson, yield_stress, modulus=0.0):
        self.bulk, self.shear = young / (3 - 6 * poisson), young / (2 + 2 * poisson)
        self.elastic = self.bulk * np.outer(D, D) + 2 * self.shear * DEVIATOR
        self.yield_stress, self.modulus = yield_stress, modulus

    def respond(self, strain, state):
        g, state = self.shear, state.copy()
        state[:, :6] += strain
        stress = state[:, :6] @ self.elastic
        tangent = np.tile(self.elastic, (len(strain), 1, 1))
        deviator = stress @ DEVIATOR
        trial = np.sqrt(1.5) * np.sqrt(np.einsum("ni,ni->n", deviator, deviator))
        excess = trial - self.yield_stress - self.modulus * state[:, 6]
        flows = np.flatnonzero(excess > 1e-12 * trial)
        if flows.size:
            slope = 3 * g + self.modulus
            trial = trial[flows]
            more = excess[flows] / slope
            n = np.sqrt(1.5) * deviator[flows] / trial[:, None]
            plastic = np.sqrt(1.5) * more[:, None] * n
            state[flows, :6] -= plastic
            state[flows, 6] += more
            stress[flows] -= 2 * g * plastic
            beta = 3 * g * more / trial
            tangent[flows] -= (2 * g * beta)[:, None, None] * DEVIATOR
            tangent[flows] += (2 * g * (beta - 3 * g / slope))[:, None, None] * (n[:, :, None] * n[:, None, :])
        return stress, tangent, state


def steel():
    """That of the block of the paper."""
    return VonMises(210e3, 0.3, 300.0)


def load(result):
    return np.asarray(result.history["force.punch.y"])[-1]


@pytest.fixture
def raising():
    """A law of steel that raises what it is given, at a call."""

    class Raising(VonMises):
        def __init__(self, error, at):
            super().__init__(210e3, 0.3, 300.0)
            self.error, self.at, self.calls = error, at, 0

        def respond(self, strain, state):
            self.calls += 1
            if self.calls == self.at:
                raise self.error
            return super().respond(strain, state)

    return Raising


def test_von_mises_in_numpy_has_the_load_of_the_paper(block):
    native = mc.run(block)
    assert load(native) == pytest.approx(LOAD, rel=1e-12)
    own = mc.run(block, laws={"block": steel()})
    assert load(own) == pytest.approx(load(native), rel=1e-9)
    history, other = own.history, native.history
    assert np.sum(history["newton_iterations"]) == np.sum(other["newton_iterations"])
    for column in ("elastic_energy", "plastic_dissipation", "plastic_fraction"):
        np.testing.assert_allclose(history[column], other[column], rtol=1e-7, atol=1e-9)
    points = own.simulation.arrays("points").point_data
    of_native = native.simulation.arrays("points").point_data
    p = points["equivalent_plastic_strain"]
    np.testing.assert_allclose(p, of_native["equivalent_plastic_strain"], atol=1e-12)
    np.testing.assert_allclose(points["stress"], of_native["stress"], atol=1e-6)
    # And its own numbers are fields.
    np.testing.assert_allclose(points["p"], p, atol=1e-12)
    assert points["elastic_strain"].shape == (len(p), 6)


@pytest.mark.parametrize("analysis", ["ring-squeezed", "punch-in-space"])
def test_around_an_axis_and_in_space_it_is_the_same_law(analysis):
    from conftest import EXAMPLES

    deck = mc.Deck(EXAMPLES / f"{analysis}.toml")
    (material,) = deck["material"]
    law = VonMises(material["young"], material["poisson"], material["yield-stress"])
    plain = {key: value for key, value in material.items() if key not in ("hardening", "kinematic")}
    keys = {**deck.keys, "material": [plain]}
    keys.pop("expect", None)
    keys.pop("strain", None)
    keys["step"][0]["increments"] = 4
    keys["step"] = keys["step"][:1]
    deck = mc.Deck(keys, folder=deck.folder)
    native, own = (mc.run(deck, laws=laws) for laws in (None, {material["on"]: law}))
    np.testing.assert_allclose(
        own.simulation.displacement, native.simulation.displacement, rtol=1e-7, atol=1e-10
    )


def test_a_state_goes_on_where_the_law_is_given_again(block):
    simulation = mc.Simulation(block, laws={"block": steel()})
    for _ in range(12):
        next(simulation)
    saved = simulation.save()
    again = mc.Simulation.restore(saved, laws={"block": steel()})
    for one in (simulation, again):
        for _ in one:
            pass
    assert np.array_equal(again.displacement, simulation.displacement)
    with pytest.raises(ValueError, match="another model"):
        mc.Simulation.restore(saved)
    assert np.array_equal(copy.copy(simulation).displacement, simulation.displacement)
    assert np.array_equal(pickle.loads(pickle.dumps(simulation)).stress, simulation.stress)
    # A step that follows has the law too.
    simulation.step = dict(name="release", increments=2, fix=[dict(on="block.left", u=["x"])])
    for _ in simulation:
        pass
    p = simulation.arrays("points").point_data["p"]
    assert p.max() > 0.0 and simulation.done == 1.0


@pytest.mark.parametrize("at", [1, 2, 30])
def test_an_exception_goes_through_as_it_is_and_the_simulation_goes_on(block, raising, at):
    class Mine(Exception):
        pass

    error = Mine("not at this strain")
    law = raising(error, at)
    if at == 1:
        # At rest, when the deck is opened.
        with pytest.raises(Mine) as caught:
            mc.Simulation(block, laws={"block": law})
        assert caught.value is error
        return
    simulation = mc.Simulation(block, laws={"block": law})
    with pytest.raises(Mine) as caught:
        for _ in simulation:
            pass
    assert caught.value is error and any(entry.name == "respond" for entry in caught.traceback)
    assert simulation.outcome["status"] == "interrupted"
    committed, state = simulation.increments, simulation.displacement
    assert committed < 20 and np.isfinite(state).all()
    for _ in simulation:
        pass
    undisturbed = mc.run(block, laws={"block": steel()}).simulation
    assert simulation.increments == 20
    assert np.array_equal(simulation.displacement, undisturbed.displacement)


def test_an_interrupt_in_a_law_is_one_of_the_simulation(block, raising):
    simulation = mc.Simulation(block, laws={"block": raising(KeyboardInterrupt(), 25)})
    with pytest.raises(KeyboardInterrupt):
        for _ in simulation:
            pass
    for _ in simulation:
        pass
    assert simulation.increments == 20


def test_runs_in_threads_have_the_bits_of_one_alone(block):
    def end(_):
        return mc.run(block, laws={"block": steel()}).simulation.displacement

    alone = end(0)
    with ThreadPoolExecutor(4) as pool:
        assert all(np.array_equal(one, alone) for one in pool.map(end, range(8)))


class Spoilt(VonMises):
    """An answer that is none from the second call on: the first is at rest."""

    def __init__(self, spoil):
        super().__init__(210e3, 0.3, 300.0)
        self.spoil, self.calls = spoil, 0

    def respond(self, strain, state):
        self.calls += 1
        answer = super().respond(strain, state)
        return answer if self.calls == 1 else self.spoil(*answer)


@pytest.mark.parametrize(
    ("spoil", "told"),
    [
        (lambda s, t, z: (s, t), "returns tuple, expected stress, tangent, state"),
        (lambda s, t, z: None, "returns NoneType"),
        (lambda s, t, z: (s[:-1], t, z), r"stress of Spoilt has the shape \(79, 6\), expected \(80, 6\)"),
        (lambda s, t, z: (s, t[0], z), r"tangent of Spoilt has the shape \(6, 6\), expected \(80, 6, 6\)"),
        (lambda s, t, z: (s, t, z[:, :6]), r"state of Spoilt has the shape \(80, 6\), expected \(80, 7\)"),
        (lambda s, t, z: (s, t, "nothing"), "state of Spoilt is no array of numbers"),
        (lambda s, t, z: (s.astype(np.float32), t, z), "stress of Spoilt is in float32, expected float64"),
        (lambda s, t, z: (s, t, z.astype(np.float16)), "state of Spoilt is in float16, expected float64"),
        (lambda s, t, z: (s, t + 0j, z), "tangent of Spoilt is in complex128, expected float64"),
    ],
)
def test_arrays_of_another_shape_are_refused(block, spoil, told):
    simulation = mc.Simulation(block, laws={"block": Spoilt(spoil)})
    with pytest.raises(mc.LawError, match=told):
        next(simulation)
    assert simulation.increments == 0 and not simulation.displacement.any()


def test_a_tangent_off_symmetry_tells_its_place_unless_the_law_says_so(block):
    def spoil(stress, tangent, state):
        tangent = tangent.copy()
        tangent[13, 0, 1] += 500.0
        return stress, tangent, state

    simulation = mc.Simulation(block, laws={"block": Spoilt(spoil)})
    with pytest.raises(mc.LawError, match="off symmetry by 5.000e2") as refused:
        next(simulation)
    error = refused.value
    assert (error.cell, error.point) == (3, 1)
    expected = simulation.arrays("points").points[13, :2]
    assert error.position == pytest.approx(tuple(expected))
    law = Spoilt(spoil)
    law.symmetric = False
    assert next(mc.Simulation(block, laws={"block": law})).increment == 1


def test_numbers_that_are_none_are_turned_back_from(block):
    def until(limit):
        class Short(VonMises):
            def respond(self, strain, state):
                stress, tangent, state = super().respond(strain, state)
                stress[np.abs(strain).max(axis=1) > limit] = np.nan
                return stress, tangent, state

        return Short(210e3, 0.3, 300.0)

    one = mc.Deck(block).with_({"step.0.increments": 1})
    keys = one.keys
    del keys["expect"]
    simulation = mc.run(keys, laws={"block": until(4e-3)}).simulation
    assert simulation.increments > 1
    with pytest.raises(mc.NotConverged, match=r"stress of the law of a material is no number at point \d of cell"):
        mc.run(keys, laws={"block": until(0.0)})


def test_a_law_is_on_a_material_and_for_small_strains(block):
    with pytest.raises(mc.DeckError, match='did you mean "block"'):
        mc.Simulation(block, laws={"blok": steel()})
    text = block.read_text().replace("analysis", 'strain = "finite"\nanalysis', 1)
    with pytest.raises(mc.DeckError, match="answers for small strains"):
        mc.Simulation(text, laws={"block": steel()})


def test_what_is_no_law_is_refused(block):
    class Nothing:
        pass

    class Counted(VonMises):
        state = -1

    class Named(VonMises):
        state = {"stress": 6, "p": 1}

    class Odd(VonMises):
        state = {"pair": 2, "rest": 5}

    class Started(VonMises):
        initial = np.zeros(3)

    for law, told in [
        (Nothing(), "has no method respond"),
        (VonMises, r"VonMises is a class, expected a law of it: VonMises\(\.\.\.\)"),
        (Counted(1.0, 0.3, 1.0), "Counted.state is -1"),
        (Named(1.0, 0.3, 1.0), "'stress' of 6 numbers"),
        (Odd(1.0, 0.3, 1.0), "'pair' of 2 numbers"),
        (Started(1.0, 0.3, 1.0), r"initial of Started has the shape \(3,\), expected \(7,\)"),
    ]:
        with pytest.raises(mc.LawError, match=told):
            mc.Simulation(block, laws={"block": law})
    with pytest.raises(TypeError, match="laws is VonMises, expected laws by the group"):
        mc.Simulation(block, laws=steel())
    weak = steel()
    weak.elastic = weak.elastic - 2 * weak.bulk * np.outer(D, D)
    with pytest.raises(mc.DeckError, match="not symmetric and positive definite"):
        mc.Simulation(block, laws={"block": weak})


def test_a_law_is_checked():
    for law in (steel(), VonMises(70e3, 0.33, 100.0, 2e3)):
        found = mc.check_law(law)
        assert found.points == 256 and found.inelastic > 50
        assert found.kinks < 10 and found.tangent < 1e-6


def test_a_check_notices_a_wrong_tangent():
    class Wrong(VonMises):
        """Without the part that turns with the direction of flow, as of a rate equation."""

        def respond(self, strain, state):
            stress, tangent, after = super().respond(strain, state)
            flows = after[:, 6] > state[:, 6]
            s = stress[flows] @ DEVIATOR
            n = s / np.linalg.norm(s, axis=1)[:, None]
            tangent[flows] = self.elastic - 2 * self.shear * n[:, :, None] * n[:, None, :]
            return stress, tangent, after

    with pytest.raises(mc.LawError, match=r"not the derivative of its stress: entry \[\d, \d\]"):
        mc.check_law(Wrong(210e3, 0.3, 300.0))


def test_a_check_notices_what_is_not_pure():
    class Remembers(VonMises):
        calls = 0

        def respond(self, strain, state):
            self.calls += 1
            stress, tangent, state = super().respond(strain, state)
            return stress * (1 + 1e-3 * (self.calls % 2)), tangent, state

    class Writes(VonMises):
        def respond(self, strain, state):
            answer = super().respond(strain, state)
            state[:, 6] = 1.0
            return answer

    class Mixes(VonMises):
        def respond(self, strain, state):
            stress, tangent, state = super().respond(strain, state)
            return stress + 1e-3 * stress.mean(axis=0), tangent, state

    class Creeps(VonMises):
        def respond(self, strain, state):
            stress, tangent, state = super().respond(strain, state)
            state[:, 6] += 1e-6
            return stress, tangent, state

    class Turns(VonMises):
        def respond(self, strain, state):
            stress, tangent, state = super().respond(strain, state)
            skew = np.zeros((6, 6))
            skew[0, 1], skew[1, 0] = 1.0, -1.0
            flows = state[:, 6] > 0
            tangent[flows] += skew
            return stress, tangent, state

    for law, told in [
        (Remembers, "a step without strain changes|twice and not the same"),
        (Writes, "writes to the strains or states"),
        (Mixes, "otherwise for a point alone|not the derivative"),
        (Creeps, "a step without strain changes"),
        (Turns, "off symmetry|not the derivative"),
    ]:
        with pytest.raises(mc.LawError, match=told):
            mc.check_law(law(210e3, 0.3, 300.0))


def test_what_a_law_in_python_costs(block, record_property):
    """No limit: the machine may be busy. Three times the native run is what it is made for."""
    deck = mc.Deck(block).with_({"mesh.block.0.cells": [20, 8]})
    keys = deck.keys
    del keys["expect"]

    def seconds(laws):
        simulation = mc.Simulation(keys, laws=laws)
        start = time.perf_counter()
        for _ in simulation:
            pass
        return time.perf_counter() - start, simulation

    times, ends = {}, {}
    for name, laws in (("native", None), ("python", {"block": steel()})) * 5:
        spent, ends[name] = seconds(laws)
        times[name] = min(spent, times.get(name, np.inf))
    ratio = times["python"] / times["native"]
    record_property("ratio", ratio)
    print(f"\n20 x 8 cells: native {1e3 * times['native']:.1f} ms, in Python {1e3 * times['python']:.1f} ms: {ratio:.2f}")
    np.testing.assert_allclose(ends["python"].displacement, ends["native"].displacement, rtol=1e-8, atol=1e-12)
