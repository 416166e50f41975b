/* A discrete frictional contact problem by the solvers of Siconos.

       cc -O2 siconos.c -lsiconos_numerics -o siconos
       siconos local|global FILE LIMIT REPEAT

   needs the package libsiconos-numerics-dev. Prints a line of JSON for every solver that ends within
   LIMIT processor seconds: its name, iterations, processor seconds, and the forces that it found, to be
   judged by whoever asked. Short solutions are repeated for REPEAT seconds, each from a problem read
   afresh, because the library keeps what it has converted; the fastest counts. */
#include <siconos/numerics/FrictionContactProblem.h>
#include <siconos/numerics/Friction_cst.h>
#include <siconos/numerics/GlobalFrictionContactProblem.h>
#include <siconos/numerics/NonSmoothDrivers.h>
#include <siconos/numerics/NumericsMatrix.h>
#include <siconos/numerics/SolverOptions.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#define TOLERANCE 1e-8
#define SWEEPS 100000 /* iterations of what sweeps or projects */
#define STEPS 1000    /* iterations of what factorises */

/* Where a solver takes more than its default. */
enum variant { PLAIN, LOCAL_PROJECTION, HYBRID, INITIAL_NORM };

struct solver {
  const char *name;
  int id;
  int iterations;
  enum variant variant;
};

static const struct solver space[] = {
    {"NSGS", SICONOS_FRICTION_3D_NSGS, SWEEPS, PLAIN},
    {"NSGS_PLI", SICONOS_FRICTION_3D_NSGS, SWEEPS, LOCAL_PROJECTION},
    {"NSN_AC", SICONOS_FRICTION_3D_NSN_AC, STEPS, PLAIN},
    {"NSN_AC_HYB", SICONOS_FRICTION_3D_NSN_AC, STEPS, HYBRID},
    {"NSN_FB", SICONOS_FRICTION_3D_NSN_FB, STEPS, PLAIN},
    {"NSN_NM", SICONOS_FRICTION_3D_NSN_NM, STEPS, PLAIN},
    {"PROX_NSN_AC", SICONOS_FRICTION_3D_PROX, STEPS, PLAIN},
    {"ADMM", SICONOS_FRICTION_3D_ADMM, SWEEPS, PLAIN},
    {"ADMM_NI", SICONOS_FRICTION_3D_ADMM, SWEEPS, INITIAL_NORM},
    {"VI_EG", SICONOS_FRICTION_3D_VI_EG, SWEEPS, PLAIN},
    {"VI_FPP", SICONOS_FRICTION_3D_VI_FPP, SWEEPS, PLAIN},
    {"TFP", SICONOS_FRICTION_3D_TFP, STEPS, PLAIN},
    {"ACLMFP", SICONOS_FRICTION_3D_ACLMFP, STEPS, PLAIN},
    {NULL, 0, 0, PLAIN}};

static const struct solver plane[] = {
    {"NSGS", SICONOS_FRICTION_2D_NSGS, SWEEPS, PLAIN},
    {"CPG", SICONOS_FRICTION_2D_CPG, SWEEPS, PLAIN},
    {"LEMKE", SICONOS_FRICTION_2D_LEMKE, SWEEPS, PLAIN},
    {"ENUM", SICONOS_FRICTION_2D_ENUM, SWEEPS, PLAIN},
    {NULL, 0, 0, PLAIN}};

static const struct solver global_space[] = {
    {"NSGS_WR", SICONOS_GLOBAL_FRICTION_3D_NSGS_WR, SWEEPS, PLAIN},
    {"PROX_WR", SICONOS_GLOBAL_FRICTION_3D_PROX_WR, STEPS, PLAIN},
    {"NSN_AC_WR", SICONOS_GLOBAL_FRICTION_3D_NSN_AC_WR, STEPS, PLAIN},
    {"ADMM_WR", SICONOS_GLOBAL_FRICTION_3D_ADMM_WR, SWEEPS, PLAIN},
    {"NSGS", SICONOS_GLOBAL_FRICTION_3D_NSGS, SWEEPS, PLAIN},
    {"NSN_AC", SICONOS_GLOBAL_FRICTION_3D_NSN_AC, STEPS, PLAIN},
    {"ADMM", SICONOS_GLOBAL_FRICTION_3D_ADMM, SWEEPS, PLAIN},
    {"VI_EG", SICONOS_GLOBAL_FRICTION_3D_VI_EG, SWEEPS, PLAIN},
    {"IPM", SICONOS_GLOBAL_FRICTION_3D_IPM, STEPS, PLAIN},
    {NULL, 0, 0, PLAIN}};

/* Of the thread: that of the process is counted in ticks once its time is limited. */
static double now(void) {
  struct timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return t.tv_sec + 1e-9 * t.tv_nsec;
}

/* Seconds that two looks at the clock take by themselves. */
static double clock_cost(void) {
  double least = 1.0;
  for (int k = 0; k < 1000; k++) {
    double begin = now(), cost = now() - begin;
    if (cost < least)
      least = cost;
  }
  return least;
}

static SolverOptions *options_of(const struct solver *solver) {
  SolverOptions *options = solver_options_create(solver->id);
  if (!options)
    return NULL;
  options->dparam[SICONOS_DPARAM_TOL] = TOLERANCE;
  options->iparam[SICONOS_IPARAM_MAX_ITER] = solver->iterations;
  switch (solver->variant) {
  case LOCAL_PROJECTION:
    solver_options_update_internal(
        options, 0, SICONOS_FRICTION_3D_ONECONTACT_ProjectionOnConeWithLocalIteration);
    break;
  case HYBRID:
    options->iparam[SICONOS_FRICTION_3D_NSN_HYBRID_STRATEGY] =
        SICONOS_FRICTION_3D_NSN_HYBRID_STRATEGY_VI_EG_NSN;
    break;
  case INITIAL_NORM:
    options->iparam[SICONOS_FRICTION_3D_ADMM_IPARAM_INITIAL_RHO] =
        SICONOS_FRICTION_3D_ADMM_INITIAL_RHO_NORM_INF;
    break;
  case PLAIN:
    break;
  }
  return options;
}

/* One solution: its seconds, its iterations and its forces. */
static double solve(const struct solver *solver, int global, const char *file, double **force,
                    int *size, int *iterations) {
  SolverOptions *options = options_of(solver);
  if (!options)
    _exit(1);
  double seconds, *r, *u, *v = NULL;
  if (global) {
    GlobalFrictionContactProblem *p = globalFrictionContact_new_from_filename(file);
    *size = p->dimension * p->numberOfContacts;
    r = calloc(*size + 1, sizeof *r);
    u = calloc(*size + 1, sizeof *u);
    v = calloc(p->M->size0 + 1, sizeof *v);
    double begin = now();
    gfc3d_driver(p, r, u, v, options);
    seconds = now() - begin;
    globalFrictionContact_free(p);
  } else {
    FrictionContactProblem *p = frictionContact_new_from_filename(file);
    *size = p->dimension * p->numberOfContacts;
    r = calloc(*size + 1, sizeof *r);
    u = calloc(*size + 1, sizeof *u);
    double begin = now();
    (p->dimension == 2 ? fc2d_driver : fc3d_driver)(p, r, u, options);
    seconds = now() - begin;
    frictionContactProblem_free(p);
  }
  *iterations = options->iparam[SICONOS_IPARAM_ITER_DONE];
  solver_options_delete(options);
  free(u);
  free(v);
  *force = r;
  return seconds;
}

static void run(const struct solver *solver, int global, const char *file, double limit,
                double repeat) {
  struct rlimit cpu = {(rlim_t)ceil(limit), (rlim_t)ceil(limit) + 1};
  setrlimit(RLIMIT_CPU, &cpu);
  /* The library prints; only our line is wanted. */
  FILE *out = fdopen(dup(1), "w");
  if (!freopen("/dev/null", "w", stdout) || !freopen("/dev/null", "w", stderr))
    _exit(1);
  double cost = clock_cost(), begin = now(), best = INFINITY, *force = NULL;
  int size = 0, iterations = 0;
  do {
    free(force);
    double seconds = solve(solver, global, file, &force, &size, &iterations) - cost;
    if (seconds < best)
      best = seconds;
  } while (now() - begin < repeat);
  for (int k = 0; k < size; k++)
    if (!isfinite(force[k]))
      _exit(1);
  fprintf(out, "{\"solver\": \"%s\", \"iterations\": %d, \"seconds\": %.3e, \"force\": [", solver->name,
          iterations, best);
  for (int k = 0; k < size; k++)
    fprintf(out, "%s%.17g", k ? ", " : "", force[k]);
  fprintf(out, "]}\n");
  fflush(out);
  _exit(0);
}

int main(int count, char **words) {
  if (count != 5) {
    fprintf(stderr, "usage: siconos local|global FILE LIMIT REPEAT\n");
    return 2;
  }
  int global = strcmp(words[1], "global") == 0, dimension = 0;
  FILE *file = fopen(words[2], "r");
  if (!file || fscanf(file, "%d", &dimension) != 1) {
    fprintf(stderr, "%s: no problem\n", words[2]);
    return 1;
  }
  fclose(file);
  /* Siconos has no solvers for plane problems in global form. */
  static const struct solver none[] = {{NULL, 0, 0, PLAIN}};
  const struct solver *solver = dimension == 3 ? (global ? global_space : space) : (global ? none : plane);
  for (; solver->name; solver++) {
    /* A process each: some run for ever, some do not survive. */
    pid_t child = fork();
    if (child == 0)
      run(solver, global, words[2], atof(words[3]), atof(words[4]));
    if (child > 0)
      waitpid(child, NULL, 0);
  }
  return 0;
}
