# %% [markdown]
# # A law of one's own
#
# Copper that is cold worked hardens as a power of the strain, σₑ = K εₑⁿ, over the whole of a forming step. As long as
# no point unloads it need not be told from a material that is elastic without being linear: the stress follows from the
# strain that is there. The program has no such law. It is a class with one method, called for many points at once.

# %%
import numpy as np

import moreau_fem as mc

D = np.array([1.0, 1.0, 1.0, 0.0, 0.0, 0.0])  # the unit tensor: xx, yy, zz, √2·yz, √2·xz, √2·xy
DEVIATOR = np.eye(6) - np.outer(D, D) / 3


class PowerLaw:
    """σₑ = K εₑⁿ with n < 1; up to a small strain, where its slope would have no end, linear."""

    state = {"total_strain": 6}

    def __init__(self, strength: float, exponent: float, bulk: float, linear: float) -> None:
        self.strength, self.exponent, self.bulk, self.linear = strength, exponent, bulk, linear

    def respond(self, strain, state):
        strain = state + strain  # the law is given the increments of a step
        e = strain @ DEVIATOR
        size = np.sqrt(2 / 3 * np.einsum("ni,ni->n", e, e))
        secant = 2 / 3 * self.strength * np.maximum(size, self.linear) ** (self.exponent - 1)
        stress = self.bulk * (strain @ D)[:, None] * D + secant[:, None] * e
        beyond = size > self.linear
        bend = np.zeros_like(size)
        bend[beyond] = 2 / 3 * (self.exponent - 1) * secant[beyond] / size[beyond] ** 2
        tangent = (self.bulk * np.outer(D, D) + secant[:, None, None] * DEVIATOR
                   + bend[:, None, None] * (e[:, :, None] * e[:, None, :]))
        return stress, tangent, strain


K, N = 450.0, 0.3  # MPa, -
copper = PowerLaw(K, N, bulk=1e8, linear=1e-5)

# %% [markdown]
# A tangent that is wrong makes no wrong stress, only more iterations, which nobody sees. It is compared with
# differences, along random paths:

# %%
checked = mc.check_law(copper, strain=5e-3)
checked

# %% [markdown]
# A tube of 20 mm and 40 mm diameter, held along its axis, under a pressure within. The deck has a material, whose law
# gives way to the one given; what it says of elasticity is not used.

# %%
A, B, PRESSURE = 10.0, 20.0, 45.0  # mm, mm, MPa
deck = mc.Deck(
    units="mm-N-MPa",
    analysis="axisymmetric",
    mesh=mc.block("tube", "quad8", x=[A, B], y=[0, 1], cells=[20, 1]),
    material=[dict(on="tube", young=120e3, poisson=0.3)],
    step=[dict(name="blow", increments=10,
               fix=[dict(on="tube.bottom", u=["y"]), dict(on="tube.top", u=["y"])],
               load=[dict(on="tube.left", pressure=PRESSURE)])],
    output=dict(probes=["tube.left"]),
)
tube = mc.run(deck, laws={"tube": copper})
tube

# %% [markdown]
# ## What must hold
#
# - **The check** has seen the law where it bends, and its tangents are the derivatives of its stresses.
# - **The hole.** Volume is kept, so that the hoop strain is c/r², the equivalent one 2c/√3 r², and balance across the
#   wall, p = ∫ 2σₑ/√3 dr/r, gives p = K/(√3 n) (2c/√3)ⁿ (a⁻²ⁿ − b⁻²ⁿ). The hole widens by c/a: as a power 1/n of the
#   pressure. 10⁻⁴ is granted, for the volume that is not quite kept, and ten times that from half of the pressure
#   on: where strains are small the law begins linear.
# - **The stress** falls through the wall as r⁻²ⁿ: von Mises' at every point to 10⁻⁴.

# %%
c = np.sqrt(3) / 2 * (PRESSURE * np.sqrt(3) * N / K / (A ** (-2 * N) - B ** (-2 * N))) ** (1 / N)
widened = np.asarray(tube.history["u.tube.left.x"])
load = np.asarray(tube.history["time"])
points = tube.simulation.arrays("points")
equivalent = K * (2 * c / np.sqrt(3) / points.points[:, 0] ** 2) ** N

assert checked.inelastic > 0.9 * checked.points and checked.tangent < 1e-5
assert abs(widened[-1] / (c / A) - 1) < 1e-4
assert np.abs(widened / (c / A * load ** (1 / N)) - 1)[4:].max() < 1e-3
assert np.abs(points.point_data["von_mises"] / equivalent - 1).max() < 1e-4
