# %% [markdown]
# # What friction does to a compression test
#
# A block of 40 mm × 20 mm between flat platens, in plane strain, is compressed by 2 % of its height, which is well
# beyond yielding. Without friction it would flow everywhere under the same stress; with friction the platens hold its
# ends back, and the force is larger than that of the material. How much? A quarter of it is computed.

# %%
from concurrent.futures import ThreadPoolExecutor

import numpy as np

import moreau_fem as mc

HALF_WIDTH, HALF_HEIGHT, YIELD = 20.0, 10.0, 300.0  # mm, mm, MPa

deck = mc.Deck(
    units="mm-N-MPa",
    analysis="plane-strain",
    mesh=mc.block("block", "quad8", x=[0, HALF_WIDTH], y=[0, HALF_HEIGHT], cells=[12, 6]),
    material=[dict(on="block", young=210e3, poisson=0.3, yield_stress=YIELD)],
    tool=[dict(name="platen", plane=dict(point=[0, HALF_HEIGHT], normal=[0, -1]))],
    contact=[dict(surface="block.top", against="platen", friction=0.0)],
    step=[dict(name="compress", increments=20,
               fix=[dict(on="block.left", u=["x"]), dict(on="block.bottom", u=["y"])],
               tools=[dict(name="platen", move=[0, -0.02 * HALF_HEIGHT])])],
)

# %% [markdown]
# Runs are independent of each other, and the interpreter is free while one is solved: threads are enough.


# %%
def compressed(mu: float) -> mc.Result:
    return mc.run(deck.with_({"contact.0.friction": mu}), quiet=True)


def mean_pressure(result: mc.Result) -> float:
    return -result.history["force.platen.y"].iloc[-1] / HALF_WIDTH


coefficients = [0.0, 0.05, 0.1, 0.2, 0.4, 5.0]
with ThreadPoolExecutor() as pool:
    runs = list(pool.map(compressed, coefficients))

table = mc.table(
    runs,
    mu=lambda r: r.deck["contact.0.friction"],
    pressure=mean_pressure,
    slipping=lambda r: r.contacts["status"].eq("slip").mean(),
    rubbed=lambda r: r.history["friction_dissipation"].iloc[-1],
)
table

# %% [markdown]
# ## What must hold
#
# With half width a, half height h and k = σ_y/√3:
#
# - **μ = 0.** The stress is uniform, and von Mises' material flows in plane strain at 2k = 2/√3 σ_y. One stress at all
#   points is within any mesh; what is left, below 10⁻⁹, is the out-of-plane stress on its way to its limit.
# - **An upper bound for every μ.** The virtual work of homogeneous compression, which is within any mesh, with the
#   shear forces t found at the platen, bounds the force: P ≤ 2k a + Σ |t| x / h, with no error but rounding.
# - **Small μ.** The slab method, dp/dx = −μ p/h, gives p = 2k (exp m − 1)/m with m = μ a/h. It leaves the shear out of
#   the yield condition, which is of the second order in μ: 1 % is granted up to μ = 0.1.
# - **Rough platens.** The shear at the platen cannot exceed k, and Hill's slip lines give p = 2k (3/4 + a/4h). Finite
#   elements come from above, by less than 2 % with 12 × 6 cells.
# - **Threads do not matter.** A run has the bits that it has alone.

# %%
a, h, k = HALF_WIDTH, HALF_HEIGHT, YIELD / np.sqrt(3)
ratio = dict(zip(coefficients, table["pressure"] / (2 * k)))

assert abs(ratio[0.0] - 1) < 1e-9
for run in runs:
    bound = 2 * k * a + (run.contacts["t_1"].abs() * run.contacts["x"]).sum() / h
    assert mean_pressure(run) * a <= bound * (1 + 1e-9)
for mu in (0.05, 0.1):
    m = mu * a / h
    assert abs(ratio[mu] / (np.expm1(m) / m) - 1) < 1e-2
assert (np.diff(table["pressure"]) > 0).all()
assert 0 < ratio[5.0] / (3 / 4 + a / (4 * h)) - 1 < 2e-2

alone = compressed(0.2)
assert alone.history.equals(runs[coefficients.index(0.2)].history)
