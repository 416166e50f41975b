# %% [markdown]
# # Hertz, then Cattaneo and Mindlin
#
# A rigid cylinder of radius R = 1000 mm is pressed on an elastic half-space, in plane strain, and then dragged along it
# with less than the force of full slip. Hertz gave the pressure in 1882; Cattaneo (1938) and Mindlin (1949) the zone
# that sticks in the middle while the edges of the contact slip already.
#
# Their solution needs that pressure alone makes no slip, and drag no pressure. Against a rigid body that is so for
# ν = 1/2. Here ν = 0.49, and Dundurs' coupling β = (1 − 2ν)/(2 − 2ν) = 0.02 is a twenty-fifth of the friction. The
# cells are quad9, whose tractions oscillate less than those of quad8 in so nearly incompressible a body.

# %%
import numpy as np

import moreau_fem as mc

RADIUS, E, NU, MU = 1000.0, 210e3, 0.49, 0.5
STIFFNESS = E / (1 - NU**2)  # E* of a rigid and an elastic body [MPa]
HALF_WIDTH = 1.0  # of the contact, aimed at [mm]
FORCE = np.pi * HALF_WIDTH**2 * STIFFNESS / (4 * RADIUS)  # N/mm
DRAG = 0.5 * MU * FORCE


def graded(fine: float, cells: int, size: float) -> list[float]:
    """Lines from 0 to `size`: so many cells up to `fine`, beyond it each 1.4 times as long as the one before."""
    lines = list(np.linspace(0, fine, cells + 1))
    while (step := 1.4 * (lines[-1] - lines[-2])) < 0.6 * (size - lines[-1]):
        lines.append(lines[-1] + step)
    return [*lines, size]


right, depth = graded(1.2, 24, 40.0), graded(0.5, 8, 40.0)
held = [dict(on="block.bottom", u=["x", "y"])]
deck = mc.Deck(
    units="mm-N-MPa",
    analysis="plane-strain",
    mesh=dict(
        block=[dict(name="block", element="quad9", cells=[0, 0],
                    x=dict(lines=[-x for x in right[:0:-1]] + right), y=dict(lines=[-y for y in reversed(depth)]))],
        group=[dict(name="zone", on="block.top", x=[-1.2, 1.2])],
    ),
    material=[dict(on="block", young=E, poisson=NU)],
    tool=[dict(name="cylinder", cylinder=dict(center=[0, RADIUS], radius=RADIUS))],
    contact=[dict(surface="zone", against="cylinder", friction=MU)],
    step=[
        dict(name="press", increments=1, fix=held, tools=[dict(name="cylinder", force=[0, -FORCE])]),
        dict(name="drag", increments=10, fix=held, tools=[dict(name="cylinder", force=[DRAG, -FORCE])]),
    ],
)
result = mc.run(deck)
zone = result.contacts.query("kind == 'midside'").sort_values("x")
touching, stuck = zone[zone["status"] != "open"], zone[zone["status"] == "stick"]
zone[["x", "status", "p_n", "p_1"]]

# %% [markdown]
# ## What must hold
#
# With E* = E/(1 − ν²), the half width is a = √(4PR/πE*), the pressure p₀ √(1 − x²/a²) with p₀ = 2P/πa. Under a drag Q
# the middle sticks over c = a √(1 − Q/μP), and the shear is that of full slip less an ellipse over c.
#
# Tolerances: widths are known to a cell, 0.05 mm, as the edge is somewhere between two midside points. Tractions are
# compared there, within 0.9 a and farther than 0.1 a from ±c: nearer, an ellipse's end with its infinite slope is
# within one cell. What is left is coupling and mesh: 2 % of the pressure, 4 % of the friction. The block is 40 a deep,
# so that its far sides are felt to the order of (1/40)² only.

# %%
a = np.sqrt(4 * FORCE * RADIUS / (np.pi * STIFFNESS))
p0 = 2 * FORCE / (np.pi * a)
c = a * np.sqrt(1 - DRAG / (MU * FORCE))
x = zone["x"].to_numpy()


def ellipse(half: float) -> np.ndarray:
    return np.sqrt(np.clip(1 - (x / half) ** 2, 0, None))


shear = MU * p0 * (ellipse(a) - c / a * ellipse(c))
inner = np.abs(x) < 0.9 * a
away = inner & (np.abs(np.abs(x) - c) > 0.1 * a)
print("contact", touching["x"].abs().max(), "of", a, "mm, stick", stuck["x"].abs().max(), "of", c, "mm")

assert abs(result.contacts["t_n"].sum() / FORCE - 1) < 1e-4  # normals turn by 10⁻³
assert abs(result.contacts["t_1"].abs().sum() / DRAG - 1) < 1e-4
assert abs(touching["x"].abs().max() - a) < 0.05 and abs(stuck["x"].abs().max() - c) < 0.05
assert abs(zone["p_n"] - p0 * ellipse(a))[inner].max() < 2e-2 * p0
assert abs(zone["p_1"].abs() - shear)[away].max() < 4e-2 * MU * p0
