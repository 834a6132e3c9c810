/*
 * The rig under SUNDIALS CVODE: a peer for the benchmark, built and started by `benchmarks bench`.
 *
 * Every contact (disc D1, disc D2, motor bearing) is stuck or slips one way; each mode is a smooth
 * ordinary differential equation with an analytic Jacobian, CVODE's root finding locates the mode
 * changes, and the integration starts again after each. Outputs every 10 ms.
 *
 * Usage: rig_cvode key=value ...
 *   plant:   J1 k1 c1 N1 J2 k2 c2 N2 eta Jm R L KT KE Tfm Cm radius u (J1=0: reduced rig)
 *   law:     mu_c mu_s omega_s | a1 b1 c1g a2 b2 c2g Vc V A (two-Gaussian when A > 0)
 *   run:     end output_step repeat
 *   sweep:   run=METHOD:WEIGHTS:RTOL:ATOL  (any number)
 *            METHOD bdf | adams, WEIGHTS plain (rtol |y| + atol) | absolute (angles: atol alone)
 * One CSV line per sweep entry on standard output.
 *
 * Set-ups tried and left out because they were never the faster: functional iteration with Adams
 * (two to three times slower), stepping with CV_ONE_STEP and CVodeGetDky instead of CV_NORMAL.
 */
#include <cvode/cvode.h>
#include <math.h>
#include <nvector/nvector_serial.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>
#include <time.h>

enum { TH2, W2, TH3, W3, CUR, TH1, W1 };
#define MAX_ROOTS 6
#define MAX_RUNS 256
#define PI 3.14159265358979323846

typedef struct {
  double J1, k1, c1, N1, J2, k2, c2, N2, eta, Jm, R, L, KT, KE, Tfm, Cm, radius, u;
  double mu_c, mu_s, omega_s;
  double a1, b1, c1g, a2, b2, c2g, Vc, V, A;
  double end, output_step;
  int repeat;
} Model;

/* Region of the two-Gaussian law: below V_c the angle has two branches that meet at a = 0. */
typedef enum { ABOVE, DECELERATING, ACCELERATING } Region;

typedef struct {
  Model p;
  int n, full, gaussian;
  int slip1, slip2, slip3; /* -1 backward, 0 stuck, +1 forward */
  Region region;
  double guess; /* acceleration of the last solve of the algebraic loop */
  double rtol, atol;
  long switches;
} Rig;

/* ---- friction ------------------------------------------------------------------------------ */

static inline double stribeck(const Model *p, double speed, double *slope) {
  const double e = (p->mu_s - p->mu_c) * exp(-speed / p->omega_s);
  *slope = -e / p->omega_s;
  return p->mu_c + e;
}

/* Two-Gaussian coefficient at the angle alpha, and its slope. */
static inline double two_gaussian(const Model *p, double alpha, double *slope) {
  const double x1 = (alpha - p->b1) / p->c1g, x2 = (alpha - p->b2) / p->c2g;
  const double e1 = p->a1 * exp(-x1 * x1), e2 = p->a2 * exp(-x2 * x2);
  *slope = -2.0 * (x1 / p->c1g * e1 + x2 / p->c2g * e2);
  return e1 + e2;
}

static double two_gaussian_breakaway(const Model *p) {
  double unused;
  const double low = two_gaussian(p, -PI, &unused), high = two_gaussian(p, PI, &unused);
  return p->radius * p->N2 * (low > high ? low : high);
}

/*
 * Algebraic loop in the slip direction: J2 a + r N2 mu(alpha(a, w)) = drive, by Newton on the branch
 * of the present region (continued smoothly past a = 0, so that the root function sees a sign change).
 */
static double loop_acceleration(Rig *g, double w, double drive, double *da_ddrive, double *da_dw) {
  const Model *p = &g->p;
  const double load = p->radius * p->N2, x = (w - p->Vc) / p->V;
  double a = g->guess, T_a = 0.0, T_w = 0.0;
  for (int k = 0; k < 50; k++) {
    const double y = a / p->A;
    double alpha = atan2(y, x), slope;
    if (g->region == DECELERATING && alpha > 0.5 * PI) alpha -= 2.0 * PI;
    if (g->region == ACCELERATING && alpha < -0.5 * PI) alpha += 2.0 * PI;
    const double mu = two_gaussian(p, alpha, &slope), rr = x * x + y * y;
    T_a = load * slope * x / (rr * p->A);
    T_w = -load * slope * y / (rr * p->V);
    const double da = (drive - p->J2 * a - load * mu) / (p->J2 + T_a);
    a += da;
    if (fabs(da) <= 1e-14 * (fabs(a) + 1.0)) break;
  }
  g->guess = a;
  *da_ddrive = 1.0 / (p->J2 + T_a);
  *da_dw = -T_w / (p->J2 + T_a);
  return a;
}

/* ---- torques on each contact, without its friction ------------------------------------------- */

static inline double drive1(const Rig *g, const double *y) {
  return g->p.c1 * (y[W2] - y[W1]) + g->p.k1 * (y[TH2] - y[TH1]);
}
static inline double drive2(const Rig *g, const double *y) {
  const double shaft2 = g->p.c2 * (y[W3] - y[W2]) + g->p.k2 * (y[TH3] - y[TH2]);
  return g->full ? shaft2 - drive1(g, y) : shaft2;
}
static inline double drive3(const Rig *g, const double *y) {
  const Model *p = &g->p;
  return p->eta * (p->KT * y[CUR] - p->Cm * p->eta * y[W3]) + p->c2 * (y[W2] - y[W3]) +
         p->k2 * (y[TH2] - y[TH3]);
}

/* ---- right-hand side and Jacobian ------------------------------------------------------------ */

static int right_hand_side(realtype t, N_Vector yv, N_Vector dv, void *data) {
  (void)t;
  Rig *g = data;
  const Model *p = &g->p;
  const double *y = NV_DATA_S(yv);
  double *d = NV_DATA_S(dv), unused, unused2;
  d[TH2] = d[W2] = 0.0;
  if (g->slip2) {
    const double s = g->slip2;
    d[TH2] = y[W2];
    if (g->gaussian)
      d[W2] = s * loop_acceleration(g, s * y[W2], s * drive2(g, y), &unused, &unused2);
    else
      d[W2] = (drive2(g, y) - s * p->radius * p->N2 * stribeck(p, s * y[W2], &unused)) / p->J2;
  }
  d[TH3] = d[W3] = 0.0;
  if (g->slip3) {
    d[TH3] = y[W3];
    d[W3] = (drive3(g, y) - p->eta * p->Tfm * g->slip3) / (p->eta * p->eta * p->Jm);
  }
  d[CUR] = (p->u - p->R * y[CUR] - p->KE * p->eta * y[W3]) / p->L;
  if (g->full) {
    d[TH1] = d[W1] = 0.0;
    if (g->slip1) {
      const double s = g->slip1;
      d[TH1] = y[W1];
      d[W1] = (drive1(g, y) - s * p->radius * p->N1 * stribeck(p, s * y[W1], &unused)) / p->J1;
    }
  }
  return 0;
}

#define J(r, c) SM_ELEMENT_D(jac, r, c)
static int jacobian(realtype t, N_Vector yv, N_Vector fy, SUNMatrix jac, void *data, N_Vector t1,
                    N_Vector t2, N_Vector t3) {
  (void)t, (void)fy, (void)t1, (void)t2, (void)t3;
  Rig *g = data;
  const Model *p = &g->p;
  const double *y = NV_DATA_S(yv);
  SUNMatZero(jac);
  if (g->slip2) {
    const double s = g->slip2;
    double per_drive = 1.0 / p->J2, per_w, slope;
    if (g->gaussian) {
      loop_acceleration(g, s * y[W2], s * drive2(g, y), &per_drive, &per_w);
    } else {
      stribeck(p, s * y[W2], &slope);
      per_w = -p->radius * p->N2 * slope / p->J2;
    }
    J(TH2, W2) = 1.0;
    J(W2, TH2) = -per_drive * (p->k2 + (g->full ? p->k1 : 0.0));
    J(W2, W2) = -per_drive * (p->c2 + (g->full ? p->c1 : 0.0)) + per_w;
    J(W2, TH3) = per_drive * p->k2;
    J(W2, W3) = per_drive * p->c2;
    if (g->full) {
      J(W2, TH1) = per_drive * p->k1;
      J(W2, W1) = per_drive * p->c1;
    }
  }
  if (g->slip3) {
    const double inertia = p->eta * p->eta * p->Jm;
    J(TH3, W3) = 1.0;
    J(W3, TH2) = p->k2 / inertia;
    J(W3, W2) = p->c2 / inertia;
    J(W3, TH3) = -p->k2 / inertia;
    J(W3, W3) = -(p->c2 + p->eta * p->eta * p->Cm) / inertia;
    J(W3, CUR) = p->eta * p->KT / inertia;
  }
  J(CUR, W3) = -p->KE * p->eta / p->L;
  J(CUR, CUR) = -p->R / p->L;
  if (g->full && g->slip1) {
    double slope;
    stribeck(p, g->slip1 * y[W1], &slope);
    J(TH1, W1) = 1.0;
    J(W1, TH2) = p->k1 / p->J1;
    J(W1, W2) = p->c1 / p->J1;
    J(W1, TH1) = -p->k1 / p->J1;
    J(W1, W1) = -(p->c1 + p->radius * p->N1 * slope) / p->J1;
  }
  return 0;
}

/* ---- mode changes ---------------------------------------------------------------------------- */

/*
 * Roots 0, 1: disc D2: breakaway forward, backward when stuck; velocity zero (0) and the branch's end or
 * V_c (1) in slip. Roots 2, 3: the motor. Roots 4, 5: disc D1. Unused ones stay at 1.
 */
static inline double breakaway2(const Rig *g) {
  return g->gaussian ? two_gaussian_breakaway(&g->p) : g->p.radius * g->p.N2 * g->p.mu_s;
}

static int roots(realtype t, N_Vector yv, realtype *r, void *data) {
  (void)t;
  Rig *g = data;
  const Model *p = &g->p;
  const double *y = NV_DATA_S(yv);
  double unused;
  r[1] = r[3] = 1.0;
  if (g->slip2) {
    const double s = g->slip2;
    r[0] = s * y[W2];
    if (g->gaussian) {
      const double load = p->radius * p->N2;
      if (g->region == ABOVE)
        r[1] = s * y[W2] - p->Vc;
      else if (g->region == DECELERATING)
        r[1] = load * two_gaussian(p, -PI, &unused) - s * drive2(g, y);
      else
        /* ends at V_c (velocity above) or where the acceleration falls to zero */
        r[1] = fmin(p->Vc - s * y[W2], s * drive2(g, y) - load * two_gaussian(p, PI, &unused));
    }
  } else {
    const double b = breakaway2(g), e = drive2(g, y);
    r[0] = b - e;
    r[1] = b + e;
  }
  if (g->slip3) {
    r[2] = g->slip3 * y[W3];
  } else {
    const double b = p->eta * p->Tfm, e = drive3(g, y);
    r[2] = b - e;
    r[3] = b + e;
  }
  if (g->full) {
    r[5] = 1.0;
    if (g->slip1) {
      r[4] = g->slip1 * y[W1];
    } else {
      const double b = p->radius * p->N1 * p->mu_s, e = drive1(g, y);
      r[4] = b - e;
      r[5] = b + e;
    }
  }
  return 0;
}

/* Sets the acceleration guess for a fresh branch of the algebraic loop. */
static void enter_region(Rig *g, Region region, double w, double drive) {
  double unused, unused2;
  const double load = g->p.radius * g->p.N2;
  g->region = region;
  const double mu = two_gaussian(&g->p, region == ACCELERATING ? PI : -PI, &unused);
  g->guess = (drive - load * mu) / g->p.J2;
  loop_acceleration(g, w, drive, &unused, &unused2);
}

/* After a velocity reached zero: stick, or slip the way the torque pushes. Returns the new mode. */
static int arrest(double drive, double breakaway) {
  return fabs(drive) <= breakaway ? 0 : (drive > 0 ? 1 : -1);
}

/* Takes the roots found; returns 1 when the right-hand side changed its form (start again). */
static int switch_mode(Rig *g, double *y, const int *found) {
  const Model *p = &g->p;
  int restart = 0;
  if (found[0] || found[1]) {
    if (!g->slip2) {
      g->slip2 = found[0] ? 1 : -1;
      if (g->gaussian) enter_region(g, ACCELERATING, 0.0, g->slip2 * drive2(g, y));
      restart = 1;
    } else if (found[0]) {
      y[W2] = 0.0;
      g->slip2 = arrest(drive2(g, y), breakaway2(g));
      if (g->slip2 && g->gaussian) enter_region(g, ACCELERATING, 0.0, g->slip2 * drive2(g, y));
      restart = 1;
    } else {
      const double s = g->slip2, w = s * y[W2], drive = s * drive2(g, y);
      if (g->region == ABOVE) {
        g->region = g->guess < 0 ? DECELERATING : ACCELERATING;
      } else if (g->region == ACCELERATING && w >= p->Vc) {
        g->region = ABOVE;
      } else {
        enter_region(g, g->region == DECELERATING ? ACCELERATING : DECELERATING, w, drive);
        restart = 1;
      }
    }
  }
  if (found[2] || found[3]) {
    if (!g->slip3) {
      g->slip3 = found[2] ? 1 : -1;
    } else {
      y[W3] = 0.0;
      g->slip3 = arrest(drive3(g, y), p->eta * p->Tfm);
    }
    restart = 1;
  }
  if (g->full && (found[4] || found[5])) {
    if (!g->slip1) {
      g->slip1 = found[4] ? 1 : -1;
    } else {
      y[W1] = 0.0;
      g->slip1 = arrest(drive1(g, y), p->radius * p->N1 * p->mu_s);
    }
    restart = 1;
  }
  g->switches += restart;
  return restart;
}

/* ---- error weights --------------------------------------------------------------------------- */

/* Angles grow without bound and only their differences act: weigh them by atol alone. */
static int absolute_angle_weights(N_Vector yv, N_Vector wv, void *data) {
  const Rig *g = data;
  const double *y = NV_DATA_S(yv);
  double *w = NV_DATA_S(wv);
  for (int k = 0; k < g->n; k++) {
    const int angle = k == TH1 || k == TH2 || k == TH3;
    w[k] = 1.0 / (g->atol + (angle ? 0.0 : g->rtol * fabs(y[k])));
  }
  return 0;
}

/* ---- one run --------------------------------------------------------------------------------- */

typedef struct {
  double seconds, y[7];
  long steps, rhs, jac, rootevals, switches;
  int error; /* of CVODE, negative; 0 when the run reached its end */
} Result;

static void add_counts(void *cv, Result *r) {
  long a = 0, b = 0, c = 0, d = 0;
  CVodeGetNumSteps(cv, &a);
  CVodeGetNumRhsEvals(cv, &b);
  CVodeGetNumJacEvals(cv, &c);
  CVodeGetNumGEvals(cv, &d);
  r->steps += a, r->rhs += b, r->jac += c, r->rootevals += d;
}

static Result run(Rig *g, void *cv, N_Vector yv) {
  Result r = {0};
  double *y = NV_DATA_S(yv);
  struct timespec t0, t1;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t0);
  memset(y, 0, sizeof(double) * (size_t)g->n);
  g->slip1 = g->slip2 = g->slip3 = 0;
  g->region = ABOVE;
  g->guess = 0.0;
  g->switches = 0;
  CVodeReInit(cv, 0.0, yv);
  CVodeSetStopTime(cv, g->p.end);
  const long points = lround(g->p.end / g->p.output_step);
  double t = 0.0;
  for (long next = 1; next <= points;) {
    const double target = next == points ? g->p.end : (double)next * g->p.output_step;
    const int code = CVode(cv, target, yv, &t, CV_NORMAL);
    if (code < 0) {
      r.error = code;
      return r;
    }
    if (code != CV_ROOT_RETURN) {
      next++;
      continue;
    }
    int found[MAX_ROOTS];
    CVodeGetRootInfo(cv, found);
    if (switch_mode(g, y, found)) {
      add_counts(cv, &r);
      CVodeReInit(cv, t, yv);
      CVodeSetStopTime(cv, g->p.end);
    }
  }
  add_counts(cv, &r);
  memcpy(r.y, y, sizeof(double) * (size_t)g->n);
  r.switches = g->switches;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t1);
  r.seconds = (double)(t1.tv_sec - t0.tv_sec) + 1e-9 * (double)(t1.tv_nsec - t0.tv_nsec);
  return r;
}

/* ---- command line ---------------------------------------------------------------------------- */

static int set_parameter(Model *p, const char *key, double value) {
#define FIELD(name) \
  if (!strcmp(key, #name)) return p->name = value, 1;
  FIELD(J1) FIELD(k1) FIELD(c1) FIELD(N1) FIELD(J2) FIELD(k2) FIELD(c2) FIELD(N2) FIELD(eta)
  FIELD(Jm) FIELD(R) FIELD(L) FIELD(KT) FIELD(KE) FIELD(Tfm) FIELD(Cm) FIELD(radius) FIELD(u)
  FIELD(mu_c) FIELD(mu_s) FIELD(omega_s) FIELD(a1) FIELD(b1) FIELD(c1g) FIELD(a2) FIELD(b2)
  FIELD(c2g) FIELD(Vc) FIELD(V) FIELD(A) FIELD(end) FIELD(output_step)
  if (!strcmp(key, "repeat")) return p->repeat = (int)value, 1;
  return 0;
}

int main(int argc, char **argv) {
  Rig g = {0};
  g.p.end = 60.0, g.p.output_step = 0.01, g.p.repeat = 1;
  const char *sweep[MAX_RUNS];
  int runs = 0;
  for (int k = 1; k < argc; k++) {
    char *equals = strchr(argv[k], '=');
    if (!equals) return fprintf(stderr, "rig_cvode: `%s` is not key=value\n", argv[k]), 2;
    *equals = 0;
    if (!strcmp(argv[k], "run")) {
      if (runs == MAX_RUNS) return fprintf(stderr, "rig_cvode: too many runs\n"), 2;
      sweep[runs++] = equals + 1;
    } else if (!set_parameter(&g.p, argv[k], strtod(equals + 1, NULL))) {
      return fprintf(stderr, "rig_cvode: unknown key `%s`\n", argv[k]), 2;
    }
  }
  g.full = g.p.J1 > 0.0;
  g.gaussian = g.p.A > 0.0;
  g.n = g.full ? 7 : 5;

  SUNContext ctx;
  SUNContext_Create(NULL, &ctx);
  printf("method,weights,rtol,atol,seconds,theta2,omega2,theta3,omega3,i,theta1,omega1,"
         "switches,steps,rhs,jac,root_evals\n");
  for (int k = 0; k < runs; k++) {
    char method[16], weights[16];
    if (sscanf(sweep[k], "%15[^:]:%15[^:]:%lf:%lf", method, weights, &g.rtol, &g.atol) != 4)
      return fprintf(stderr, "rig_cvode: run `%s` is not method:weights:rtol:atol\n", sweep[k]), 2;
    N_Vector y = N_VNew_Serial(g.n, ctx);
    N_VConst(0.0, y);
    SUNMatrix matrix = SUNDenseMatrix(g.n, g.n, ctx);
    SUNLinearSolver solver = SUNLinSol_Dense(y, matrix, ctx);
    void *cv = CVodeCreate(strcmp(method, "adams") ? CV_BDF : CV_ADAMS, ctx);
    if (CVodeInit(cv, right_hand_side, 0.0, y) < 0) return fprintf(stderr, "rig_cvode: CVodeInit failed\n"), 1;
    CVodeSetUserData(cv, &g);
    if (strcmp(weights, "absolute"))
      CVodeSStolerances(cv, g.rtol, g.atol);
    else
      CVodeWFtolerances(cv, absolute_angle_weights);
    CVodeSetLinearSolver(cv, solver, matrix);
    CVodeSetJacFn(cv, jacobian);
    const int count = g.full ? 6 : 4;
    int falling[MAX_ROOTS] = {-1, -1, -1, -1, -1, -1};
    CVodeRootInit(cv, count, roots);
    CVodeSetRootDirection(cv, falling);
    CVodeSetNoInactiveRootWarn(cv);
    CVodeSetMaxNumSteps(cv, 100000000);
    Result best = run(&g, cv, y);
    for (int repetition = 1; repetition < g.p.repeat && !best.error; repetition++) {
      const Result again = run(&g, cv, y);
      if (again.seconds < best.seconds) best = again;
    }
    if (best.error)
      fprintf(stderr, "rig_cvode: %s gave up with code %d\n", sweep[k], best.error);
    else
      printf("%s,%s,%.3e,%.3e,%.9f,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%ld,%ld,%ld,%ld,%ld\n",
             method, weights, g.rtol, g.atol, best.seconds, best.y[TH2], best.y[W2], best.y[TH3],
             best.y[W3], best.y[CUR], best.y[TH1], best.y[W1], best.switches, best.steps, best.rhs,
             best.jac, best.rootevals);
    fflush(stdout);
    CVodeFree(&cv);
    SUNLinSolFree(solver);
    SUNMatDestroy(matrix);
    N_VDestroy(y);
  }
  SUNContext_Free(&ctx);
  return 0;
}
