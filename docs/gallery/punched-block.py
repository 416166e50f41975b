# %% [markdown]
# # The punched block of the paper
# Half of a steel block, 100 mm × 20 mm, lies on a rigid foundation with friction, and half of its top is pressed down
# by 0.2 mm: section 8.2 of Fihri Fassi, Bousshine, de Saxcé, El Harif and Kouam. What does the punch need, and where
# does the block slide?

# %%
import numpy as np

import moreau_fem as mc

# %% [markdown]
# The model: a grid of cells, a material, a tool, a contact, a step.

# %%
deck = mc.Deck(
    units="mm-N-MPa",
    analysis="plane-strain",
    mesh=[
        mc.block("block", "quad8", x=[0, 50], y=[0, 20], cells=[10, 2]),
        dict(group=[dict(name="punch", on="block.top", x=[0, 25])]),
    ],
    material=[dict(on="block", young=210e3, poisson=0.3, yield_stress=300.0)],
    tool=[dict(name="foundation", plane=dict(point=[0, 0], normal=[0, 1]))],
    contact=[dict(surface="block.bottom", against="foundation", friction=0.1)],
    step=[
        dict(
            name="press",
            increments=20,
            fix=[dict(on="block.left", u=["x"])],
            move=[dict(on="punch", u=dict(y=-0.2))],
        )
    ],
)

# %% [markdown]
# The run, and its certificate: the sum of b(−u, t) + t·u over all contacts, zero where Coulomb's law holds exactly.

# %%
result = mc.run(deck, quiet=True)
print(result)

# %% [markdown]
# Load and yielding while the punch goes down.

# %%
load = -np.asarray(result.history["force.punch.y"])
yielding = np.asarray(result.history["plastic_fraction"])
for k in range(3, len(load), 4):
    print(f"{0.01 * (k + 1):.2f} mm  {load[k]:9.1f} N/mm  yields in {100 * yielding[k]:3.0f} % of the volume")

# %% [markdown]
# The contact: pressure, and what has become of each point.

# %%
for x, t_n, status in sorted(zip(*(result.contacts[name] for name in ["x", "t_n", "status"]))):
    print(f"x = {x:4.1f} mm  {t_n:8.2f} N  {status}")

# %%
result.plot("equivalent_plastic_strain", magnification=20)

# %% [markdown]
# **Known.** An independent code finds 10519.53783 N per mm of thickness. What presses on the block the foundation
# carries, no force is outside of the cone of friction, and another method for the contact problem gives the same.

# %%
assert abs(load[-1] - 10519.53783) < 1e-4
assert abs(np.asarray(result.history["force.foundation.y"])[-1] / load[-1] - 1) < 1e-10
t_n, t_1 = (np.asarray(result.contacts[name]) for name in ["t_n", "t_1"])
assert (np.abs(t_1) <= 0.1 * t_n + 1e-8 * load[-1]).all()
other = mc.run(deck.with_({"solver": {"contact": "gauss-seidel"}}), quiet=True)
assert abs(np.asarray(other.history["force.punch.y"])[-1] + load[-1]) < 1e-4
