# %% [markdown]
# # A limit load: Prandtl's punch
# A rigid, smooth, flat punch 20 mm wide is pressed into a block of perfectly plastic steel. Which load can the ground
# under it carry at most? Finite elements answer from above, and the answer falls as cells are halved.

# %%
from pathlib import Path

import numpy as np

import moreau_fem as mc

YIELD, WIDTH = 300.0, 20.0
X = [0, 2.5, 5, 7.5, 10, 14.1, 20.8, 31.9, 50]
Y = [-50, -35.4, -24.5, -16.4, -10.4, -5.9, -2.5, 0]


def halved(lines, times):
    for _ in range(times):
        lines = np.interp(np.arange(2 * len(lines) - 1) / 2, np.arange(len(lines)), lines)
    return dict(lines=np.asarray(lines, dtype=float).tolist())


def punch(times):
    return mc.Deck(
        units="mm-N-MPa",
        analysis="plane-strain",
        mesh=[
            mc.block("block", "quad8", x=halved(X, times), y=halved(Y, times), cells=[0, 0]),
            dict(group=[dict(name="loaded", on="block.top", x=[0, WIDTH / 2])]),
        ],
        material=[dict(on="block", young=210e3, poisson=0.3, yield_stress=YIELD)],
        tool=[dict(name="punch", plane=dict(point=[0, 0], normal=[0, -1]))],
        contact=[dict(surface="loaded", against="punch", friction=0.0)],
        step=[
            dict(
                name="indent",
                increments=20,
                fix=[dict(on=f"block.{side}", u=["x"]) for side in ["left", "right"]]
                + [dict(on="block.bottom", u=["x", "y"])],
                tools=[dict(name="punch", move=[0, -0.4])],
            )
        ],
    )


# %% [markdown]
# Prandtl and Hill: (2 + π) k on the punch, k = σ_y/√3. Half of the punch is in the model.

# %%
known = (2 + np.pi) * YIELD / np.sqrt(3) * WIDTH / 2
ratio = []
for times in range(3):
    result = mc.run(punch(times), quiet=True)
    ratio.append(-np.asarray(result.history["force.punch.y"])[-1] / known)
    print(f"{56 * 4**times:4} cells: {ratio[-1]:.4f} of Prandtl's load")

# %%
result.plot("equivalent_plastic_strain", magnification=5)

# %% [markdown]
# Loads that nothing carries any more end a step of their own kind: a thick cylinder, whose limit pressure is
# 2/√3 σ_y ln(b/a), is given twice as much.

# %%
cylinder = mc.run(Path("../examples/cylinder-to-collapse.toml"), quiet=True)
factor = np.asarray(cylinder.history["time"])[-1]
pressure = factor * cylinder.deck["step.0.load.0.pressure"]

# %% [markdown]
# **Known.** From above, to 2 % with the finest cells and to 1 % extrapolated; the cylinder to five digits.

# %%
assert ratio[0] > ratio[1] > ratio[2] > 1 and ratio[2] < 1.02
assert abs(2 * ratio[2] - ratio[1] - 1) < 0.01
assert abs(pressure / (2 / np.sqrt(3) * 240 * np.log(2)) - 1) < 1e-5
