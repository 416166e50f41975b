# %% [markdown]
# # A loading loop that reacts
#
# A pad lies on a rough table. It is pressed down until a wanted force is reached, whatever depth that takes, then
# pushed sideways until all of it slips, and then lifted. None of these ends is known beforehand: the loop watches the
# contact and gives what is left of a step for another.

# %%
import moreau_fem as mc

MU, WANTED = 0.3, 15000.0  # -, N/mm

PRESS = dict(name="press", increments=80, fix=[dict(on="pad.top", u=["x"])],
             move=[dict(on="pad.top", u=dict(y=-0.2))])
deck = mc.Deck(
    units="mm-N-MPa",
    analysis="plane-strain",
    mesh=mc.block("pad", "quad8", x=[0, 40], y=[0, 20], cells=[12, 6]),
    material=[dict(on="pad", young=210e3, poisson=0.3, yield_stress=300.0, hardening=dict(linear=2000.0))],
    tool=[dict(name="table", plane=dict(point=[0, 0], normal=[0, 1]))],
    contact=[dict(surface="pad.bottom", against="table", friction=MU)],
    step=[PRESS],
)


def held_at(depth: float, name: str, increments: int, push: float) -> dict:
    """A step that holds the depth and moves the top sideways."""
    return dict(name=name, increments=increments, move=[dict(on="pad.top", u=dict(x=push, y=depth))])


# %%
sim = mc.Simulation(deck)
events, depth = [], 0.0
for inc in sim:
    now = sim.history.iloc[-1]
    pressed = now["force.table.y"]
    if inc.step == 1 and pressed >= WANTED:
        depth = now["u.pad.top.y"]
        events.append(("pressed", inc.increment, pressed))
        sim.step = held_at(depth, "push", 60, 0.3)
    elif inc.step == 2 and inc.stick == 0 and inc.slip > 0:
        events.append(("slipping", inc.increment, pressed))
        sliding = sim.save()  # bytes, to come back to this moment
        sim.step = held_at(0.0, "lift", 40, now["u.pad.top.x"])
events, sim.last

# %% [markdown]
# The step changes are in the history, where steps are counted from 1.

# %%
history = sim.history
history.groupby("step").last()[["increment", "u.pad.top.x", "u.pad.top.y", "force.table.x", "force.table.y", "open"]]

# %% [markdown]
# ## What must hold
#
# - **Reaction in time.** The force passes the wanted one within one increment, so by less than its growth in it.
# - **Coulomb.** When all that touches slips one way, the table's shear force is μ times its normal force.
# - **Equilibrium** of the pad in every increment: table and hand balance each other to rounding.
# - **Lifted**, the pad carries nothing, and plastic strain is left.
# - **Energy.** Work = elastic + plastic + friction. The work is summed by trapezoids and both dissipations with the
#   forces at the end of each increment: the difference is of the first order in the increment, 1 % for these.
# - **Coming back** to the saved moment and lifting again ends with the same bits.

# %%
first, second = (history[history["step"] == k].iloc[-1] for k in (1, 2))
growth = history["force.table.y"].diff()[first.name]
last = history.iloc[-1]

assert [name for name, *_ in events] == ["pressed", "slipping"] and last["step"] == 3
assert 0 <= first["force.table.y"] - WANTED < growth
assert abs(abs(second["force.table.x"]) / second["force.table.y"] / MU - 1) < 1e-9
assert (history["force.table.y"] + history["force.pad.top.y"]).abs().max() < 1e-6
assert (history["force.table.x"] + history["force.pad.top.x"]).abs().max() < 1e-6
assert abs(last["force.table.y"]) < 1e-6 and last["plastic_dissipation"] > 0
parts = last[["elastic_energy", "plastic_dissipation", "friction_dissipation"]].sum()
assert abs(parts / last["external_work"] - 1) < 1e-2

again = mc.Simulation.restore(sliding)
again.step = held_at(0.0, "lift", 40, second["u.pad.top.x"])
for _ in again:
    pass
assert again.history.equals(history)
