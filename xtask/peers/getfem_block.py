"""The punched block by GetFEM: eight-node quadrilaterals with 2x2 points, contact node by node with
an augmented Lagrangian solved by Newton's method.

    python3 getfem_block.py NX NY INCREMENTS FRICTION

needs the package python3-getfem. Prints one line of JSON: the load of the punch [N], Newton
iterations, cuts of an increment that did not converge, processor seconds from the mesh to the end.
"""
import json
import os
import sys
import time

os.environ["OMP_NUM_THREADS"] = "1"
os.environ["OPENBLAS_NUM_THREADS"] = "1"
import getfem
import numpy

nx, ny, increments = (int(word) for word in sys.argv[1:4])
friction = float(sys.argv[4])
YOUNG, POISSON, YIELD, TRAVEL = 210000.0, 0.3, 300.0, 0.2

start = time.process_time()
getfem.util_trace_level(0)
mesh = getfem.Mesh("cartesian", numpy.linspace(0.0, 50.0, nx + 1), numpy.linspace(0.0, 20.0, ny + 1))
mfu = getfem.MeshFem(mesh, 2)
mfu.set_fem(getfem.Fem("FEM_Q2_INCOMPLETE(2)"))
mim = getfem.MeshIm(mesh, getfem.Integ("IM_GAUSS_PARALLELEPIPED(2,3)"))
points = mfu.basic_dof_nodes()
even = numpy.arange(0, mfu.nbdof(), 2)
x, y = points[0, even], points[1, even]
tiny = 1e-9


def rows(dofs, sign=1.0):
    matrix = getfem.Spmat("empty", len(dofs), mfu.nbdof())
    for row, dof in enumerate(dofs):
        matrix.add(row, int(dof), sign)
    return matrix


bottom = even[y < tiny]
# The node on the axis cannot slide: it has no friction.
corner, bottom = bottom[points[0, bottom] < tiny], bottom[points[0, bottom] > tiny]
punch = even[(y > 20.0 - tiny) & (x < 25.0 + tiny)] + 1
axis = even[x < tiny]

model = getfem.Model("real")
model.add_fem_variable("u", mfu)
model.add_fem_data("Previous_u", mfu)
data = getfem.MeshImData(mim, -1, [2, 2])
scalar = getfem.MeshImData(mim, -1)
model.add_im_data("Previous_Ep", data)
model.add_im_data("xi", scalar)
model.add_im_data("Previous_xi", scalar)
model.add_initialized_data("lambda", YOUNG * POISSON / (1 + POISSON) / (1 - 2 * POISSON))
model.add_initialized_data("mu", YOUNG / 2 / (1 + POISSON))
model.add_initialized_data("sigma_y", YIELD)
model.set_time_step(1.0)
law = (mim, "plane strain Prandtl Reuss", "DISPLACEMENT_ONLY", "u", "xi", "Previous_Ep", "lambda", "mu", "sigma_y", "1", "timestep")
model.add_small_strain_elastoplasticity_brick(*law)

# Prescribed displacements: multipliers whose values are the reactions.
model.add_variable("reaction_axis", len(axis))
model.add_constraint_with_multipliers("u", "reaction_axis", rows(axis), numpy.zeros(len(axis)))
model.add_variable("reaction_punch", len(punch))
descent = model.add_constraint_with_multipliers("u", "reaction_punch", rows(punch), numpy.zeros(len(punch)))

model.add_variable("normal", len(bottom))
model.add_variable("tangent", len(bottom))
model.add_initialized_data("r", [0.1 * YOUNG])
model.add_initialized_data("friction", [friction])
model.add_variable("normal_axis", 1)
model.add_initialized_data("gap", numpy.zeros(len(bottom)))
model.add_initialized_data("alpha", numpy.ones(len(bottom)))
model.add_initialized_data("gap_axis", [0.0])
model.add_initialized_data("alpha_axis", [1.0])
model.add_initialized_data("gamma", [1.0])
model.add_initialized_data("wt", numpy.zeros(mfu.nbdof()))
model.add_basic_contact_brick(
    "u", "normal", "tangent", "r", rows(bottom + 1, -1.0), rows(bottom), "friction", "gap", "alpha", 1, "gamma", "wt"
)
model.add_basic_contact_brick("u", "normal_axis", "r", rows(corner + 1, -1.0), "gap_axis", "alpha_axis", 1)

iterations, cuts, load = 0, 0, 0.0
targets = [TRAVEL * increment / increments for increment in range(increments, 0, -1)]
done = 0.0
while targets:
    before = model.from_variables()
    model.set_private_rhs(descent, numpy.full(len(punch), -targets[-1]))
    # The slip of this increment: tangential displacement plus this datum.
    model.set_variable("wt", -model.variable("u"))
    # Of the settings of its line search tried, the one that solved every size in the fewest iterations.
    count, converged = model.solve("max_res", 1e-8, "max_iter", 100, "lsearch", "simplest", "alpha max ratio", 10.0)
    iterations += count
    if not converged:
        cuts += 1
        if cuts > 10:
            sys.exit(f"no convergence after {done} mm")
        # Whether it converges hangs on rounding: half of the increment first, as other systems do.
        model.to_variables(before)
        targets.append(0.5 * (done + targets[-1]))
        continue
    done = targets.pop()
    model.small_strain_elastoplasticity_next_iter(*law)
    load = float(abs(model.variable("reaction_punch").sum()))
print(json.dumps({
    "system": "GetFEM",
    "unknowns": mfu.nbdof(), "load": load, "iterations": iterations, "cuts": cuts,
    "seconds": time.process_time() - start,
}))
