# %% [markdown]
# # Friction and strength from a ring test
# A ring is squeezed between platens. With little friction its bore opens, with much it closes; the load tells how
# strong it is. Both curves together give μ and the yield stress, which no closed formula does.

# %%
import numpy as np

import moreau_fem as mc


def ring(friction, yield_stress):
    return mc.Deck(
        units="mm-N-MPa",
        analysis="axisymmetric",
        strain="finite",
        mesh=[
            mc.block("ring", "quad8", x=[4.5, 9], y=[0, 3], cells=[6, 4]),
            dict(group=[dict(name="bore", on="ring.left", nearest=[4.5, 0])]),
        ],
        material=[
            dict(on="ring", young=70e3, poisson=0.33, yield_stress=float(yield_stress), hardening=dict(linear=200.0))
        ],
        tool=[dict(name="platen", plane=dict(point=[0, 3], normal=[0, -1]))],
        contact=[
            dict(surface=["ring.top", "ring.left", "ring.right"], against="platen", friction=float(friction))
        ],
        step=[
            dict(
                name="squeeze",
                increments=15,
                fix=[dict(on="ring.bottom", u=["y"])],
                tools=[dict(name="platen", move=[0, -0.9])],
            )
        ],
        output=dict(probes=["bore"]),
    )


def curves(friction, yield_stress):
    history = mc.run(ring(friction, yield_stress), quiet=True).history
    load, bore = -np.asarray(history["force.platen.y"]) / 1000, 2 * np.asarray(history["u.bore.x"])
    return load[2:], bore[2:]


# %% [markdown]
# The measurement is made up: a run with μ = 0.12 and 100 MPa, read off to 0.1 kN and 0.01 mm.

# %%
truth = np.array([0.12, 100.0])
load, bore = curves(*truth)
load, bore = np.round(load, 1), np.round(bore, 2)
print("load [kN]", load, "\nbore [mm]", bore, sep="\n")


# %% [markdown]
# Least squares by Gauss and Newton, each curve in parts of what can be read off.

# %%
def misfit(x):
    of_load, of_bore = curves(*x)
    return np.concatenate([(of_load - load) / 0.1, (of_bore - bore) / 0.01])


x = np.array([0.2, 80.0])
for _ in range(5):
    r = misfit(x)
    steps = np.diag(1e-3 * x)
    jacobian = np.column_stack([(misfit(x + h) - r) / h.sum() for h in steps])
    x = np.maximum(x - np.linalg.lstsq(jacobian, r, rcond=None)[0], [0.01, 10.0])
    print(f"friction {x[0]:.4f}, yield stress {x[1]:.2f} MPa, misfit {np.linalg.norm(r):.2f}")

# %% [markdown]
# **Known.** What the measurement was made with comes back, to within what reading off has lost.

# %%
assert abs(x[0] - truth[0]) < 0.005 and abs(x[1] - truth[1]) < 1.0
