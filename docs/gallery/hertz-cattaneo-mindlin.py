# %% [markdown]
# # Line contact: Hertz, then Cattaneo and Mindlin
# A rigid cylinder of radius 100 mm is pressed on an elastic block by a force P, and then pulled sideways by
# Q < μ P. Nothing slides as a whole, but the edge of the contact does: micro-slip, where fretting begins.
# The block is nearly incompressible, for which pressure and shear do not influence each other at the surface.

# %%
import numpy as np

import moreau_fem as mc

R, E, NU, MU = 100.0, 2000.0, 0.49, 0.3
P, Q = 20.0, 4.5  # N per mm of thickness: Q/(μ P) = 3/4

# %% [markdown]
# Cells of 0.1 mm where contact is expected, growing away from it: the block is to be large beside the contact.

# %%
grown = np.cumsum(0.1 * 1.4 ** np.arange(1, 15))
fine = np.linspace(-1.4, 1.4, 29)
x = np.concatenate([-1.4 - grown[::-1], fine, 1.4 + grown])
y = np.concatenate([-1.0 - grown[::-1], np.linspace(-1.0, 0.0, 11)])
hold = [dict(on="block.bottom", u=["x", "y"])]
deck = mc.Deck(
    units="mm-N-MPa",
    analysis="plane-strain",
    mesh=[
        mc.block("block", "quad8", x=dict(lines=x.tolist()), y=dict(lines=y.tolist()), cells=[0, 0]),
        dict(group=[dict(name="near", on="block.top", x=[-1.41, 1.41])]),
    ],
    material=[dict(on="block", young=E, poisson=NU)],
    tool=[dict(name="cylinder", cylinder=dict(center=[0, R], radius=R))],
    contact=[dict(surface="near", against="cylinder", friction=MU)],
    step=[
        dict(name="press", increments=5, fix=hold, tools=[dict(name="cylinder", force=[0, -P])]),
        dict(name="pull", increments=10, fix=hold, tools=[dict(name="cylinder", force=[Q, -P])]),
    ],
)

# %%
sim = mc.Simulation(deck)
found = {}
for inc in sim:
    table = sim.contacts()
    found[inc.step] = {name: np.asarray(table[name]) for name in ["x", "p_n", "p_1", "status"]}
print(sim.summary)

# %% [markdown]
# Half widths: points are 0.05 mm apart. Tractions are compared where they are largest.

# %%
pressed, pulled = found[1], found[2]
half_width = np.abs(pressed["x"][pressed["status"] != "open"]).max()
stick = np.abs(pulled["x"][pulled["status"] == "stick"]).max()
middle = np.abs(pressed["x"]) < 0.21
peak, shear = pressed["p_n"][middle].mean(), np.abs(pulled["p_1"][middle]).mean()

# %% [markdown]
# **Known.** Hertz: a² = 4 P R/(π E*), p₀ = 2 P/(π a), E* = E/(1 − ν²). Cattaneo and Mindlin: what sticks has the half
# width c = a √(1 − Q/(μ P)), and the shear is μ p₀ (√(1 − x²/a²) − c/a √(1 − x²/c²)) there.

# %%
a = np.sqrt(4 * P * R * (1 - NU**2) / (np.pi * E))
p0, c = 2 * P / (np.pi * a), a * np.sqrt(1 - Q / (MU * P))
at = pressed["x"][middle]
hertz = p0 * np.sqrt(1 - (at / a) ** 2).mean()
mindlin = MU * p0 * (np.sqrt(1 - (at / a) ** 2) - c / a * np.sqrt(1 - (at / c) ** 2)).mean()
for name, is_, known in [("a [mm]", half_width, a), ("p [MPa]", peak, hertz), ("c [mm]", stick, c), ("q [MPa]", shear, mindlin)]:
    print(f"{name:8} {is_:.4f}, known {known:.4f}")
assert abs(half_width - a) < 0.05 and abs(stick - c) < 0.05
assert abs(peak / hertz - 1) < 0.02 and abs(shear / mindlin - 1) < 0.03
