# %% [markdown]
# # Prandtl's punch: how good is a limit load?
#
# A rigid, flat, smooth punch 20 mm wide sinks into a block so large that the rest of it stays elastic. Without
# hardening the force cannot exceed Prandtl's limit, B σ_y/√3 (2 + π), which he found in 1920 from slip lines. A mesh
# that cannot follow these lines is stiffer than the material: its limit load comes from above. By how much, and what
# does refinement gain? Half of the block is computed, in plane strain.

# %%
import numpy as np

import moreau_fem as mc

HALF_PUNCH, YIELD = 10.0, 300.0  # mm, MPa
EXACT = HALF_PUNCH * YIELD / np.sqrt(3) * (2 + np.pi)  # N/mm, of the half


def graded(fine: float, cell: float, size: float) -> list[float]:
    """Lines from 0 to `size` with equal cells up to `fine`, beyond that each 1.5 times as long as the one before."""
    lines = list(np.linspace(0, fine, round(fine / cell) + 1))
    while (step := 1.5 * (lines[-1] - lines[-2])) < 0.6 * (size - lines[-1]):
        lines.append(lines[-1] + step)
    return [*lines, size]


def punched(cells: int) -> mc.Result:
    """The punch with so many cells of half its width."""
    cell = HALF_PUNCH / cells
    depth = graded(HALF_PUNCH / 2, cell, 50.0)
    return mc.run(quiet=True, deck=mc.Deck(
        units="mm-N-MPa",
        analysis="plane-strain",
        mesh=dict(
            block=[dict(name="block", element="quad8", cells=[0, 0],
                        x=dict(lines=graded(1.5 * HALF_PUNCH, cell, 50.0)),
                        y=dict(lines=[-y for y in reversed(depth)]))],
            group=[dict(name="loaded", on="block.top", x=[0, HALF_PUNCH])],
        ),
        material=[dict(on="block", young=210e3, poisson=0.3, yield_stress=YIELD)],
        tool=[dict(name="punch", plane=dict(point=[0, 0], normal=[0, -1]))],
        contact=[dict(surface="loaded", against="punch", friction=0.0)],
        step=[dict(name="indent", increments=20,
                   fix=[dict(on="block.left", u=["x"]), dict(on="block.right", u=["x"]),
                        dict(on="block.bottom", u=["x", "y"])],
                   tools=[dict(name="punch", move=[0, -0.4])])],
    ))


cells = [2, 4, 8]
runs = [punched(n) for n in cells]
excess = np.array([-r.history["force.punch.y"].iloc[-1] / EXACT - 1 for r in runs])
mc.table(runs, cells=lambda r: r.contacts["status"].size // 2, load=lambda r: r.history["force.punch.y"].iloc[-1],
         newton=lambda r: r.history["newton_iterations"].sum())

# %% [markdown]
# The last increments add next to nothing: the load has been reached.

# %%
runs[-1].history[["u.punch.y", "force.punch.y", "plastic_fraction"]].tail()

# %%
runs[-1].plot("equivalent_plastic_strain")

# %% [markdown]
# ## What must hold
#
# - **From above.** Equilibrium holds against the mesh's own velocities only, so its limit load is an upper bound as far
#   as the flow rule holds between the quadrature points too.
# - **Convergence of the first order.** The corner of the punch is a point where velocities jump; no degree of the
#   elements helps there, and the excess shrinks with the cell.
# - **Extrapolated**, 2 f(h/2) − f(h) has lost the term of first order: within 0.5 % of Prandtl's limit.

# %%
print(excess)
assert (excess > 0).all()
assert 0.3 < excess[1] / excess[0] < 0.7 and 0.3 < excess[2] / excess[1] < 0.7
assert abs(2 * excess[2] - excess[1]) < 5e-3
late = runs[-1].history["force.punch.y"].iloc[-3:]
assert abs(late.iloc[-1] / late.iloc[0] - 1) < 1e-3
