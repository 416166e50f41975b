"""Decks as files, texts and keys; meshes as arrays and of other libraries; functions of hardening and friction."""

import math
import sys
import tomllib
import warnings
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import moreau_fem as mc
from conftest import EXAMPLES


def pulled(mesh, analysis="plane-strain", on="body", folder=None, **more):
    """A bar that is pulled, uniformly strained."""
    axes = ["x", "y", "z"][: 3 if analysis == "solid" else 2]
    fix = [dict(on=f"{side}", u=[axis]) for side, axis in zip(["left", "bottom", "back"], axes)]
    return mc.Deck(
        units="mm-N-MPa",
        analysis=analysis,
        mesh=mesh,
        material=[dict(on=on, young=1000.0, poisson=0.25, **more)],
        step=[dict(name="pull", increments=1, fix=fix, move=[dict(on="right", u=dict(x=0.01))])],
        folder=folder,
    )


def quad8(points):
    """One cell on corners counterclockwise."""
    x = np.array(points, dtype=float)
    return np.vstack([x, (x + np.roll(x, -1, axis=0)) / 2])


def square():
    points = quad8([[0, 0], [1, 0], [1, 1], [0, 1]])
    groups = {
        "body": {"quad8": [range(8)]},
        "left": {"line3": [[3, 0, 7]]},
        "bottom": {"line3": [[0, 1, 4]]},
        "right": {"vertex": [[1], [2], [5]]},
    }
    return mc.Mesh(points, {"quad8": [range(8)]}, groups)


def force(deck):
    return float(np.asarray(mc.run(deck).history["force.right.x"])[-1])


# Plane strain: E / (1 - ν²) times the strain on a face of 1 mm².
PULL = 1000.0 / (1 - 0.25**2) * 0.01


def test_keys_text_and_file_are_one_deck(tmp_path):
    path = EXAMPLES / "punched-block.toml"
    text = path.read_text()
    of_keys = mc.Deck(mc.Deck(text).keys)
    loads = [np.asarray(mc.run(deck).history["force.punch.y"])[-1] for deck in (path, str(path), text, of_keys)]
    assert len(set(loads)) == 1
    assert mc.Deck(mc.Deck(path))["mesh.block.0.cells"] == [10, 2]
    assert mc.Deck(path)["material.0.yield_stress"] == 300.0
    # The same message, with the same line.
    wrong = text.replace("friction = 0.1", "frixion = 0.1")
    (tmp_path / "wrong.toml").write_text(wrong)
    told = []
    for deck in (wrong, tmp_path / "wrong.toml"):
        with pytest.raises(mc.DeckError) as refused:
            mc.run(deck)
        (finding,) = (f for f in refused.value.findings if "frixion" in f.message)
        told.append(finding)
        assert f":{finding.line}:" in str(refused.value) and "frixion" in str(refused.value)
    assert told[0] == told[1] and told[0].line == 1 + wrong[: wrong.index("frixion")].count("\n")
    with pytest.raises(mc.DeckError):
        mc.Deck("units = \n").keys
    with pytest.raises(FileNotFoundError):
        mc.run("nowhere.toml")


def test_doubts_are_warnings():
    text = (EXAMPLES / "punched-block.toml").read_text().replace("friction = 0.1", "friction = 0")
    with pytest.warns(mc.DeckWarning, match="frictionless"):
        mc.Simulation(text)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        mc.Simulation(EXAMPLES / "punched-block.toml")


def test_arrays_of_numpy_and_any_text_are_keys():
    deck = mc.Deck(title='a "b"\n\u00fc\\', step=[dict(increments=np.int64(3), x=np.array([1.5, 2]), y=np.bool_(True))])
    assert deck.keys == {
        "title": 'a "b"\n\u00fc\\',
        "step": [{"increments": 3, "x": [1.5, 2.0], "y": True}],
    }
    with pytest.raises(TypeError, match="a deck cannot hold"):
        mc.Deck(title=object())
    changed = deck.with_({"step.0.body_force": [0, 1], "expect": {"u_x.y": 1}})
    assert changed["step.0.body-force"] == [0, 1] and changed.keys["expect"] == {"u_x.y": 1}
    assert "body-force" not in deck.text


def test_a_mesh_of_arrays(tmp_path, monkeypatch):
    deck = pulled(square())
    # Wherever the process has gone meanwhile.
    monkeypatch.chdir(tmp_path)
    assert force(deck) == pytest.approx(PULL)
    # With the mesh beside it, it is a deck on disk.
    deck.to_toml(tmp_path / "bar.toml")
    assert force(tmp_path / "bar.toml") == force(deck)
    assert force(deck.with_({"material.0.young": 2000.0})) == pytest.approx(2 * PULL)
    simulation = mc.Simulation.restore(mc.Simulation(deck).save())
    assert next(simulation).increment == 1
    # The mesh is there for another step too, and in what is saved then.
    back = {**deck.keys["step"][0], "name": "back"}
    simulation.step = back | {"move": [dict(on="right", u=dict(x=0.0))]}
    simulation = mc.Simulation.restore(simulation.save())
    assert next(simulation).step == 2
    assert abs(np.asarray(simulation.history["force.right.x"])[-1]) < 1e-9
    for wrong in [dict(quad7=[range(8)]), dict(quad8=[range(7)]), dict(quad8=[range(1, 9)])]:
        with pytest.raises(ValueError):
            mc.Mesh(square().points, wrong)
    with pytest.raises(ValueError, match="quotes"):
        mc.Mesh(square().points, square().cells, {'a "b"': square().cells})


def test_decks_in_one_folder_have_their_own_meshes(tmp_path):
    def bar(length):
        mesh = square()
        return pulled(mc.Mesh(mesh.points * [length, 1.0], mesh.cells, mesh.groups))

    (tmp_path / "mesh.msh").write_text("somebody else's")
    decks = {tmp_path / f"w{length}.toml": bar(length) for length in (1, 2, 4)}
    for path, deck in decks.items():
        assert deck.to_toml(path) == path.read_text()
    for path, deck in decks.items():
        assert mc.Deck(path)["mesh.file"] == path.stem + ".msh" and force(path) == force(deck)
    assert len({force(path) for path in decks}) == 3
    assert (tmp_path / "mesh.msh").read_text() == "somebody else's"
    # The same again is no loss; another deck or another mesh under the name is, and nothing of it is written.
    path, other = tmp_path / "w1.toml", bar(8)
    decks[path].to_toml(path)
    before = {file: file.read_bytes() for file in tmp_path.iterdir()}
    with pytest.raises(FileExistsError, match="w1.toml is there already"):
        other.to_toml(path)
    path.unlink()
    with pytest.raises(FileExistsError, match="w1.msh is there already.*overwrite=True"):
        other.to_toml(path)
    assert not path.exists() and (tmp_path / "w1.msh").read_bytes() == before[tmp_path / "w1.msh"]
    other.to_toml(path, overwrite=True)
    assert force(path) == force(other)
    # A deck knows its mesh, and lets go of that where another is given.
    (tmp_path / "w1.msh").write_bytes(before[tmp_path / "w2.msh"])
    with pytest.raises(mc.DeckError, match="checksum"):
        mc.run(path)
    assert force(mc.Deck(path).with_({"mesh": square()})) == force(bar(1))
    # That of a simulation in another step too.
    simulation = mc.Simulation(bar(2).with_({"step.0.increments": 2}))
    next(simulation)
    simulation.step = bar(2)["step.0"] | {"name": "more"}
    assert '"pull" was given up at 0.5' in simulation.deck.to_toml(tmp_path / "more.toml")
    assert mc.Deck(tmp_path / "more.toml")["mesh.file"] == "more.msh" and mc.run(tmp_path / "more.toml")


def test_several_meshes_are_parts_of_one(tmp_path):
    def bar(name, at):
        mesh = square()
        groups = {name + group: own for group, own in mesh.groups.items()}
        return mc.Mesh(mesh.points + [at, 0.0], mesh.cells, groups)

    def both(mesh, one="", two="b.", **more):
        fix = [dict(on=f"{name}{side}", u=[axis]) for name in (one, two) for side, axis in [("left", "x"), ("bottom", "y")]]
        move = [dict(on=f"{name}right", u=dict(x=u)) for name, u in [(one, 0.01), (two, 0.02)]]
        material = [dict(on=[f"{one}body", f"{two}body"], young=1000.0, poisson=0.25)]
        step = [dict(name="pull", increments=1, fix=fix, move=move)]
        return mc.Deck(units="mm-N-MPa", analysis="plane-strain", mesh=mesh, material=material, step=step, **more)

    def forces(deck, one="", two="b."):
        history = mc.run(deck).history
        return [float(np.asarray(history[f"force.{name}right.x"])[-1]) for name in (one, two)]

    deck = both([bar("", 0.0), bar("b.", 5.0)])
    assert forces(deck) == pytest.approx([PULL, 2 * PULL])
    deck.to_toml(tmp_path / "two.toml")
    assert sorted(file.name for file in tmp_path.iterdir()) == ["two-2.msh", "two.msh", "two.toml"]
    assert forces(tmp_path / "two.toml") == forces(deck)
    # Beside a file of the name that it would have.
    (tmp_path / "mesh.msh").write_bytes((tmp_path / "two.msh").read_bytes())
    beside = both([bar("b.", 5.0), dict(file="mesh.msh")], folder=tmp_path)
    assert forces(beside) == forces(deck)
    # Written elsewhere it does not take another file of that name.
    (tmp_path / "away").mkdir()
    beside.to_toml(tmp_path / "away" / "two.toml")
    (tmp_path / "away" / "mesh.msh").write_bytes((tmp_path / "two-2.msh").read_bytes())
    with pytest.raises(mc.DeckError, match="checksum"):
        mc.run(tmp_path / "away" / "two.toml")
    (tmp_path / "away" / "mesh.msh").write_bytes((tmp_path / "two.msh").read_bytes())
    assert forces(tmp_path / "away" / "two.toml") == forces(deck)
    # With names of parts, a mesh in place of a file; without, groups of one name are refused.
    parts = [dict(file=square(), name="a"), dict(file=square(), name="b", position=[5, 0])]
    assert forces(both(dict(part=parts), "a.", "b."), "a.", "b.") == forces(deck)
    with pytest.raises(mc.DeckError, match='"body"'):
        mc.run(both([square(), square()]))
    with pytest.raises(TypeError, match="mesh.block is .* expected a list"):
        both([dict(block=dict(name="b"))])


def test_nodes_are_whole_numbers():
    points, nodes = square().points, np.array([range(8)])
    assert mc.Mesh(points, {"quad8": nodes.astype(float)}).cells["quad8"].tolist() == nodes.tolist()
    for wrong, words in [
        (nodes + 0.5, "quad8 has the node 0.5, expected whole numbers from 0"),
        (nodes + np.nan, "the node nan"),
        (nodes > 3, "values of the type bool"),
        (nodes.astype(str), "expected numbers of nodes"),
    ]:
        with pytest.raises(ValueError, match=words):
            mc.Mesh(points, {"quad8": wrong})
        with pytest.raises(ValueError, match=words):
            mc.Mesh(points, {"quad8": nodes}, {"body": {"quad8": wrong}})


def test_a_mesh_of_meshio_and_of_pyvista():
    mesh = square()
    block = lambda kind, data: SimpleNamespace(type=kind, data=np.array(data))
    of_meshio = SimpleNamespace(
        points=np.column_stack([mesh.points, np.zeros(8)]),
        cells=[block("quad8", [range(8)]), block("line3", [[3, 0, 7], [0, 1, 4]])],
        cell_sets={"body": [np.array([0]), None], "left": [np.array([]), np.array([0])],
                   "bottom": [None, np.array([1])]},
        point_sets={"right": np.array([1, 2, 5])},
        cell_data={},
        field_data={},
    )
    assert force(pulled(of_meshio)) == pytest.approx(PULL)
    of_gmsh = SimpleNamespace(**{**vars(of_meshio), "cell_sets": {}})
    of_gmsh.cell_data = {"gmsh:physical": [np.array([4]), np.array([1, 2])]}
    of_gmsh.field_data = {"body": [4, 2], "left": [1, 1], "bottom": [2, 1]}
    assert force(pulled(of_gmsh)) == pytest.approx(PULL)
    of_pyvista = SimpleNamespace(
        points=of_meshio.points,
        celltypes=np.array([23, 21, 21]),
        cells_dict={23: np.array([range(8)]), 21: np.array([[3, 0, 7], [0, 1, 4]])},
        cell_data={"body": np.array([1, 0, 0]), "left": np.array([0, 1, 0]), "bottom": np.array([0, 0, 1])},
        point_data={"right": np.array([0, 1, 1, 0, 0, 1, 0, 0]), "height": mesh.points[:, 1]},
    )
    assert force(pulled(of_pyvista)) == pytest.approx(PULL)
    pyvista = pytest.importorskip("pyvista")
    cells = np.concatenate([[8, *range(8)], [3, 3, 0, 7], [3, 0, 1, 4]])
    real = pyvista.UnstructuredGrid(cells, of_pyvista.celltypes, of_pyvista.points)
    real.cell_data.update(of_pyvista.cell_data)
    real.point_data["right"] = of_pyvista.point_data["right"]
    assert force(pulled(real)) == pytest.approx(PULL)
    with pytest.raises(TypeError, match="is no mesh"):
        mc.Deck(mesh=3.0)


@pytest.mark.parametrize("element", ["tet10", "hex20", "hex27"])
def test_nodes_go_over_in_the_order_of_vtk_and_come_back(element):
    """A grid of the core, in the order of VTK, is a mesh: its nodes are halfway between the same corners."""
    box = dict(x=[0, 1], y=[0, 1], z=[0, 1], cells=[2, 1, 1])
    group = [dict(name=n, on=f"b.{n}", x=[0, 1]) for n in ("left", "right", "bottom", "back")]
    given = pulled([mc.block("b", element, **box), dict(group=group)], "solid", on="b")
    first = mc.Simulation(given)
    next(first)
    arrays = first.arrays()
    count = {"tet10": 10, "hex20": 20, "hex27": 27}[element]
    nodes = arrays.cells.reshape(-1, count + 1)[:, 1:]
    sides = {name: np.flatnonzero(np.isclose(arrays.points[:, axis], at))[:, None]
             for name, axis, at in [("left", 0, 0), ("right", 0, 1), ("bottom", 1, 0), ("back", 2, 0)]}
    groups = {"body": {element: nodes}} | {name: {"vertex": own} for name, own in sides.items()}
    again = mc.Simulation(pulled(mc.Mesh(arrays.points, {element: nodes}, groups), "solid"))
    next(again)
    for grid in (arrays, again.arrays()):
        stress = grid.cell_data["stress"]
        assert stress[:, 0] == pytest.approx(10.0) and abs(stress[:, 1:]).max() < 1e-9
    assert np.array_equal(again.arrays().types, arrays.types)
    # Displacements at the same places, whatever the numbers of the nodes.
    for a, b in [(first, again), (again, first)]:
        table = {tuple(np.round(x, 9)): u for x, u in zip(a.nodes, a.displacement)}
        assert all(np.allclose(table[tuple(np.round(x, 9))], u, atol=1e-12) for x, u in zip(b.nodes, b.displacement))


def test_a_function_of_hardening_is_sampled():
    squares = mc.block("body", "quad8", x=[0, 1], y=[0, 1], cells=[1, 1])
    names = [dict(name=n, on=f"body.{n}", x=[0, 1]) for n in ("left", "right", "bottom")]
    given = [squares, dict(group=names)]
    linear = pulled(given, yield_stress=1.0, hardening=dict(linear=50.0))
    sampled = pulled(given, yield_stress=1.0, hardening=lambda p: 50.0 * p)
    assert force(sampled) == pytest.approx(force(linear), rel=1e-9)
    assert force(linear) < 0.9 * PULL
    for curve, words in [
        (lambda p: 50.0 * p - 60.0 * max(p - 0.1, 0.0), "softens at the equivalent plastic strain 0.1"),
        (lambda p: 5.0, "adds 5.0 at the strain 0"),
    ]:
        with pytest.raises(mc.DeckError, match=words) as refused:
            pulled(given, yield_stress=1.0, hardening=curve)
        assert refused.value.findings[0].severity == "error"


def test_a_function_of_friction_is_sampled():
    keys = tomllib.loads((EXAMPLES / "punched-block.toml").read_text())
    del keys["expect"]

    def load(friction):
        contact = [{**keys["contact"][0], "friction": friction}]
        return np.asarray(mc.run({**keys, "contact": contact}).history["force.punch.y"])[-1]

    assert load(lambda p: 0.1 * p) == pytest.approx(load(0.1), rel=1e-9)
    limited = load({"coulomb": 0.1, "tau-max": 20.0})
    assert load(lambda p: min(0.1 * p, 20.0)) == pytest.approx(limited, rel=1e-3)
    assert load(0.1) != pytest.approx(limited, rel=1e-3)
    # Whatever a modulus is written as, and in whatever unit.
    keys["parameters"] = {"modulus": keys["material"][0]["young"]}
    keys["material"][0]["young"] = "= modulus"
    assert load(lambda p: 0.1 * p) == pytest.approx(load(0.1), rel=1e-9)
    assert len(mc.Deck({**keys, "contact": [{**keys["contact"][0], "friction": lambda p: 0.1 * p}]}).text) < 3000
    # A cohesion, and what rounding makes of the slopes beside it.
    assert load(lambda p: 20.0 + 0.1 * p) != pytest.approx(load(0.1), rel=1e-3)
    assert load(lambda p: 20.0 * (1.0 - np.exp(-p / 200.0))) == pytest.approx(
        load(lambda p: min(0.1 * p, 20.0 * (1.0 - np.exp(-p / 200.0)))), rel=1e-6
    )
    for curve, words in [
        (lambda p: 0.1 * p if p < 100.0 else 5.0, "falls at the pressure"),
        (lambda p: 0.1 * p + 1e-5 * p * p, "expected a concave function"),
        (lambda p: 0.1 * p if p < 100.0 else 0.2 * p - 10.0, "rises faster from the pressure (9|10)[0-9]"),
        (lambda p: 0.1 * p - 1.0, "at no pressure"),
    ]:
        with pytest.raises(mc.DeckError, match=words):
            load(curve)


def test_without_pandas_tables_are_arrays(monkeypatch):
    monkeypatch.setitem(sys.modules, "pandas", None)
    result = mc.run(EXAMPLES / "punched-block.toml")
    assert isinstance(result.history, dict) and len(result.history["time"]) == 20
    assert result.contacts["status"][0] in {"open", "stick", "slip"}
    assert mc.table([result], last=lambda r: r.history["time"][-1])["last"].tolist() == [1.0]


def test_arrays_are_copies_that_may_be_written():
    simulation = mc.Simulation(EXAMPLES / "punched-block.toml")
    next(simulation)
    kept = simulation.displacement
    before = kept.copy()
    next(simulation)
    assert np.array_equal(kept, before) and not np.array_equal(simulation.displacement, before)
    kept[:] = 7.0
    assert simulation.displacement.max() < 1.0
    assert simulation.arrays().units["stress"] == "MPa"


def test_the_wheel_is_typed():
    assert (Path(mc.__file__).parent / "py.typed").exists()


class Bounded:
    """Coulomb's friction up to a shear."""

    def __init__(self, mu, most):
        self.mu, self.most, self.calls = mu, most, 0

    def __call__(self, pressure):
        self.calls += 1
        return np.minimum(self.mu * pressure, self.most)


def test_functions_are_called_for_all_points_at_once_where_they_take_arrays():
    keys = tomllib.loads((EXAMPLES / "punched-block.toml").read_text())

    def text(friction, hardening):
        contact = [{**keys["contact"][0], "friction": friction}]
        material = [{**keys["material"][0], "yield-stress": 300.0, "hardening": hardening}]
        return mc.Deck({**keys, "contact": contact, "material": material}).text

    law = Bounded(0.1, 50.0)
    together = text(law, lambda p: 250.0 * p)
    assert law.calls == 1
    # What has an `if` or a function of math in it takes no arrays.
    one_by_one = text(lambda p: 0.1 * p if 0.1 * p < 50.0 else 50.0, lambda p: 250.0 * math.fabs(p))
    assert tomllib.loads(together) == tomllib.loads(one_by_one)

    def in_place(pressure):
        pressure *= 0.1
        return np.minimum(pressure, 50.0)

    # The points are the same the next time.
    assert tomllib.loads(text(in_place, lambda p: 250.0 * p)) == tomllib.loads(together)
    assert tomllib.loads(text(law, lambda p: 250.0 * p)) == tomllib.loads(together)


def test_keys_of_another_shape_are_refused(block):
    keys = tomllib.loads(block.read_text())
    for name in ("material", "contact", "tool", "step"):
        (table,) = keys.get(name) or [dict(name="die")]
        with pytest.raises(mc.DeckError, match=f"{name} is one table, expected a list"):
            mc.Simulation({**keys, name: table})
    with pytest.raises(mc.DeckError, match="material is one table"):
        mc.Simulation({**keys, "material": {**keys["material"][0], "hardening": lambda p: 250.0 * p}})
    for wrong in (3.0, "block", ["block"], [3.0]):
        with pytest.raises(mc.DeckError, match="material is"):
            mc.Simulation({**keys, "material": wrong})
    # Whatever goes through it once is a list.
    assert mc.Deck({**keys, "material": iter(keys["material"])}).keys == keys
    for wrong in ({1: 2}, {"output": {1: 2}}, {"step": [{1: 2}]}, {"material": [{1: 2}]}):
        with pytest.raises(TypeError, match="a deck has the key 1, expected a text"):
            mc.Deck(wrong)
    with pytest.raises(TypeError, match="'yield-stress' twice"):
        mc.Deck(material=[{"yield_stress": 1.0, "yield-stress": 2.0}])


def test_what_is_wrong_with_a_mesh_of_arrays_is_said_of_arrays(tmp_path):
    points, cells, groups = square().points, square().cells, square().groups
    for given, words in [
        (groups | {"top": np.arange(3)}, "the group 'top' is given as ndarray, expected nodes by kind of cell"),
        (groups | {"top": [[2, 3, 6]]}, "the group 'top' is given as list"),
    ]:
        with pytest.raises(TypeError, match=words):
            mc.Mesh(points, cells, given)
    with pytest.raises(TypeError, match="cells is given as ndarray"):
        mc.Mesh(points, cells["quad8"])
    for value in (np.nan, np.inf):
        wrong = points.copy()
        wrong[3, 1] = value
        with pytest.raises(ValueError, match=rf"points\[3\] is \[0.0, {value}\], expected finite coordinates"):
            mc.Mesh(wrong, cells, groups)
    beside = mc.Mesh(points, cells, groups | {"left": {"line3": [[3, 1, 7]]}})
    deck = pulled(beside, folder=tmp_path)
    with pytest.raises(mc.DeckError) as refused:
        mc.run(deck)
    told = r"the mesh mesh.msh (arrays; its nodes and elements count from 1): "
    assert told in str(refused.value) and told in refused.value.findings[0].message
    assert str(tmp_path) not in str(refused.value) and "[4, 2, 8]" in str(refused.value)
    # Of a file on disk as ever.
    deck.to_toml(tmp_path / "bar.toml")
    with pytest.raises(mc.DeckError) as refused:
        mc.run(tmp_path / "bar.toml")
    assert f"the mesh {tmp_path / 'bar.msh'}: " in str(refused.value)
