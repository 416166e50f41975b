# %% [markdown]
# # A study over friction, in threads
# A strip, four times as wide as high, is compressed between platens. How much does friction add to the load? One run
# for each coefficient; the interpreter is free while increments are solved, so threads are enough.

# %%
from concurrent.futures import ThreadPoolExecutor

import numpy as np

import moreau_fem as mc

HALF_WIDTH, HEIGHT, YIELD = 40.0, 20.0, 300.0

# %%
deck = mc.Deck(
    units="mm-N-MPa",
    analysis="plane-strain",
    mesh=mc.block("strip", "quad8", x=[0, HALF_WIDTH], y=[0, HEIGHT / 2], cells=[24, 6]),
    material=[dict(on="strip", young=210e3, poisson=0.3, yield_stress=YIELD)],
    tool=[dict(name="platen", plane=dict(point=[0, HEIGHT / 2], normal=[0, -1]))],
    contact=[dict(surface="strip.top", against="platen", friction=0.1)],
    step=[
        dict(
            name="compress",
            increments=20,
            fix=[dict(on="strip.left", u=["x"]), dict(on="strip.bottom", u=["y"])],
            tools=[dict(name="platen", move=[0, -0.2])],
        )
    ],
)

# %%
friction = [0.01, 0.02, 0.05, 0.1, 0.2, 5.0]
with ThreadPoolExecutor() as pool:
    runs = list(pool.map(lambda mu: mc.run(deck.with_({"contact.0.friction": mu}), quiet=True), friction))

# %% [markdown]
# The mean pressure in parts of 2k = 2 σ_y/√3, which is what the strip carries without friction.

# %%
plain = 2 * YIELD / np.sqrt(3) * HALF_WIDTH
pressure = lambda run: -np.asarray(run.history["force.platen.y"])[-1] / plain
sliding = lambda run: float(np.mean(np.asarray(run.contacts["status"]) == "slip"))
table = mc.table(runs, friction=lambda run: run.deck["contact.0.friction"], pressure=pressure, sliding=sliding)
table

# %% [markdown]
# **Known.** With little friction the slab method: p/2k = (e^m − 1)/m with m = μ w/h, w the width. With perfectly rough
# platens Hill, The Mathematical Theory of Plasticity, chapter VIII: p/2k = 3/4 + w/(4h). Cells come from above.

# %%
found = np.asarray(table["pressure"])
m = np.array(friction[:3]) * 2 * HALF_WIDTH / HEIGHT
slab = (np.exp(m) - 1) / m
hill = 3 / 4 + 2 * HALF_WIDTH / (4 * HEIGHT)
print(found[:3], slab, found[-1], hill, sep="\n")
assert (np.diff(found) > -1e-9).all()
assert (np.abs(found[:3] / slab - 1) < 0.02).all()
assert 0 < found[-1] / hill - 1 < 0.03
