# %% [markdown]
# # A loading loop that reacts
# A cylinder is pressed on an elastic block, until the contact is 2 mm wide: which force is that? What is needed is not
# known before, so the loop looks at the contact after each increment, and lifts the cylinder when it is wide enough.

# %%
import numpy as np

import moreau_fem as mc

R, E, NU, WANTED = 100.0, 210e3, 0.3, 1.0

# %%
grown = np.cumsum(0.1 * 1.4 ** np.arange(1, 15))
x = np.concatenate([np.linspace(0, 1.6, 17), 1.6 + grown])
y = np.concatenate([-1.0 - grown[::-1], np.linspace(-1.0, 0.0, 11)])
hold = [dict(on="block.left", u=["x"]), dict(on="block.bottom", u=["x", "y"])]
deck = mc.Deck(
    units="mm-N-MPa",
    analysis="plane-strain",
    mesh=[
        mc.block("block", "quad8", x=dict(lines=x.tolist()), y=dict(lines=y.tolist()), cells=[0, 0]),
        dict(group=[dict(name="near", on="block.top", x=[0, 1.61])]),
    ],
    material=[dict(on="block", young=E, poisson=NU)],
    tool=[dict(name="cylinder", cylinder=dict(center=[0, R], radius=R))],
    contact=[dict(surface="near", against="cylinder", friction=0.0)],
    step=[dict(name="press", increments=60, fix=hold, tools=[dict(name="cylinder", move=[0, -0.06])])],
)


# %% [markdown]
# Half width of what touches: the point farthest from the axis that is not open.

# %%
def half_width(contacts):
    touches = np.asarray(contacts["status"]) != "open"
    return np.asarray(contacts["x"])[touches].max(initial=0.0)


sim = mc.Simulation(deck)
turned = None
for inc in sim:
    width = half_width(sim.contacts())
    if inc.step == 1 and width >= WANTED:
        turned = inc.increment
        force = -2 * np.asarray(sim.history["force.cylinder.y"])[-1]
        print(f"increment {inc.increment}: half width {width:.2f} mm at {force:.0f} N/mm")
        sim.step = dict(name="lift", increments=3, fix=hold, tools=[dict(name="cylinder", move=[0, 0.01])])
print(sim.summary)

# %% [markdown]
# **Known.** Hertz: P = π E* a²/(4 R), with E* = E/(1 − ν²). An increment and half a cell are what the loop can see.
# Lifted off, the elastic block is as it was.

# %%
known = np.pi * E / (1 - NU**2) * WANTED**2 / (4 * R)
print(f"force {force:.0f} N/mm, Hertz {known:.0f} N/mm")
assert turned is not None and turned < 60
assert abs(force / known - 1) < 0.05
assert half_width(sim.contacts()) == 0.0
assert np.abs(sim.displacement).max() < 1e-9
