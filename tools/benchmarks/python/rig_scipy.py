"""The rig under scipy's solve_ivp (LSODA, Radau): a peer for the benchmark, started by `benchmarks bench`.

Reads one JSON object from standard input: `parameters` (short names as in rig_cvode.c), `end`,
`output_step`, `repeat` and `runs`, a list of [method, weights, tolerance]. Writes one CSV line per run.

Right-hand side, Jacobian and root functions are compiled by numba. Every contact is stuck or slips one
way; terminal events end a mode, and integration starts again in the next one.
"""

import json
import math
import sys
import time
import warnings

import numba
import numpy as np
import scipy
from scipy.integrate import solve_ivp

TH2, W2, TH3, W3, CUR, TH1, W1 = range(7)
SLIP2, SLIP3, SLIP1, REGION = range(4)  # entries of the mode
ABOVE, DECELERATING, ACCELERATING = range(3)  # regions of the two-Gaussian law
NAMES = (
    "J2 k2 c2 N2 eta Jm R L KT KE Tfm Cm radius u mu_c mu_s omega_s "
    "a1 b1 c1g a2 b2 c2g Vc V A J1 k1 c1 N1"
).split()
(J2, K2, C2, N2, ETA, JM, R, L, KT, KE, TFM, CM, RADIUS, U, MU_C, MU_S, OMEGA_S,
 A1, B1, C1G, A2, B2, C2G, VC, V, A, J1, K1, C1, N1) = range(len(NAMES))


@numba.njit(cache=True)
def stribeck(p, speed):
    """Coefficient of friction and its slope over the speed."""
    fading = (p[MU_S] - p[MU_C]) * math.exp(-speed / p[OMEGA_S])
    return p[MU_C] + fading, -fading / p[OMEGA_S]


@numba.njit(cache=True)
def two_gaussian(p, alpha):
    """Coefficient of friction and its slope over the phase-plane angle."""
    x1, x2 = (alpha - p[B1]) / p[C1G], (alpha - p[B2]) / p[C2G]
    e1, e2 = p[A1] * math.exp(-x1 * x1), p[A2] * math.exp(-x2 * x2)
    return e1 + e2, -2.0 * (x1 / p[C1G] * e1 + x2 / p[C2G] * e2)


@numba.njit(cache=True)
def loop_acceleration(p, region, speed, drive):
    """Acceleration in the slip direction, with its slopes over drive and speed."""
    load, x = p[RADIUS] * p[N2], (speed - p[VC]) / p[V]
    start = 0.0 if region == ABOVE else (math.pi if region == ACCELERATING else -math.pi)
    a = (drive - load * two_gaussian(p, start)[0]) / p[J2]
    t_a = t_w = 0.0
    for _ in range(50):
        y = a / p[A]
        alpha = math.atan2(y, x)
        if region == DECELERATING and alpha > 0.5 * math.pi:
            alpha -= 2.0 * math.pi
        elif region == ACCELERATING and alpha < -0.5 * math.pi:
            alpha += 2.0 * math.pi
        mu, slope = two_gaussian(p, alpha)
        rr = x * x + y * y
        t_a, t_w = load * slope * x / (rr * p[A]), -load * slope * y / (rr * p[V])
        step = (drive - p[J2] * a - load * mu) / (p[J2] + t_a)
        a += step
        if abs(step) <= 1e-14 * (abs(a) + 1.0):
            break
    return a, 1.0 / (p[J2] + t_a), -t_w / (p[J2] + t_a)


@numba.njit(cache=True)
def drive1(p, y):
    return p[C1] * (y[W2] - y[W1]) + p[K1] * (y[TH2] - y[TH1])


@numba.njit(cache=True)
def drive2(p, y):
    shaft2 = p[C2] * (y[W3] - y[W2]) + p[K2] * (y[TH3] - y[TH2])
    return shaft2 - drive1(p, y) if p[J1] > 0.0 else shaft2


@numba.njit(cache=True)
def drive3(p, y):
    motor = p[ETA] * (p[KT] * y[CUR] - p[CM] * p[ETA] * y[W3])
    return motor + p[C2] * (y[W2] - y[W3]) + p[K2] * (y[TH2] - y[TH3])


@numba.njit(cache=True)
def breakaway2(p):
    if p[A] > 0.0:
        return p[RADIUS] * p[N2] * max(two_gaussian(p, -math.pi)[0], two_gaussian(p, math.pi)[0])
    return p[RADIUS] * p[N2] * p[MU_S]


@numba.njit(cache=True)
def right_hand_side(y, p, mode):
    d = np.zeros(y.size)
    if mode[SLIP2] != 0:
        s = float(mode[SLIP2])
        d[TH2] = y[W2]
        if p[A] > 0.0:
            d[W2] = s * loop_acceleration(p, mode[REGION], s * y[W2], s * drive2(p, y))[0]
        else:
            d[W2] = (drive2(p, y) - s * p[RADIUS] * p[N2] * stribeck(p, s * y[W2])[0]) / p[J2]
    if mode[SLIP3] != 0:
        d[TH3] = y[W3]
        d[W3] = (drive3(p, y) - p[ETA] * p[TFM] * mode[SLIP3]) / (p[ETA] * p[ETA] * p[JM])
    d[CUR] = (p[U] - p[R] * y[CUR] - p[KE] * p[ETA] * y[W3]) / p[L]
    if p[J1] > 0.0 and mode[SLIP1] != 0:
        s = float(mode[SLIP1])
        d[TH1] = y[W1]
        d[W1] = (drive1(p, y) - s * p[RADIUS] * p[N1] * stribeck(p, s * y[W1])[0]) / p[J1]
    return d


@numba.njit(cache=True)
def jacobian(y, p, mode):
    j = np.zeros((y.size, y.size))
    full = p[J1] > 0.0
    if mode[SLIP2] != 0:
        s = float(mode[SLIP2])
        if p[A] > 0.0:
            _, per_drive, per_w = loop_acceleration(p, mode[REGION], s * y[W2], s * drive2(p, y))
        else:
            per_drive, per_w = 1.0 / p[J2], -p[RADIUS] * p[N2] * stribeck(p, s * y[W2])[1] / p[J2]
        j[TH2, W2] = 1.0
        j[W2, TH2] = -per_drive * (p[K2] + p[K1])
        j[W2, W2] = -per_drive * (p[C2] + p[C1]) + per_w
        j[W2, TH3] = per_drive * p[K2]
        j[W2, W3] = per_drive * p[C2]
        if full:
            j[W2, TH1] = per_drive * p[K1]
            j[W2, W1] = per_drive * p[C1]
    if mode[SLIP3] != 0:
        inertia = p[ETA] * p[ETA] * p[JM]
        j[TH3, W3] = 1.0
        j[W3, TH2] = p[K2] / inertia
        j[W3, W2] = p[C2] / inertia
        j[W3, TH3] = -p[K2] / inertia
        j[W3, W3] = -(p[C2] + p[ETA] * p[ETA] * p[CM]) / inertia
        j[W3, CUR] = p[ETA] * p[KT] / inertia
    j[CUR, W3] = -p[KE] * p[ETA] / p[L]
    j[CUR, CUR] = -p[R] / p[L]
    if full and mode[SLIP1] != 0:
        slope = stribeck(p, mode[SLIP1] * y[W1])[1]
        j[TH1, W1] = 1.0
        j[W1, TH2] = p[K1] / p[J1]
        j[W1, W2] = p[C1] / p[J1]
        j[W1, TH1] = -p[K1] / p[J1]
        j[W1, W1] = -(p[C1] + p[RADIUS] * p[N1] * slope) / p[J1]
    return j


@numba.njit(cache=True)
def roots(y, p, mode):
    """Falling root functions: two for disc D2, two for the motor, two for disc D1."""
    r = np.ones(6)
    if mode[SLIP2] != 0:
        s = float(mode[SLIP2])
        speed, drive, load = s * y[W2], s * drive2(p, y), p[RADIUS] * p[N2]
        r[0] = speed
        if p[A] > 0.0:
            if mode[REGION] == ABOVE:
                r[1] = speed - p[VC]
            elif mode[REGION] == DECELERATING:
                r[1] = load * two_gaussian(p, -math.pi)[0] - drive
            else:
                r[1] = min(p[VC] - speed, drive - load * two_gaussian(p, math.pi)[0])
    else:
        breakaway, drive = breakaway2(p), drive2(p, y)
        r[0], r[1] = breakaway - drive, breakaway + drive
    if mode[SLIP3] != 0:
        r[2] = mode[SLIP3] * y[W3]
    else:
        breakaway, drive = p[ETA] * p[TFM], drive3(p, y)
        r[2], r[3] = breakaway - drive, breakaway + drive
    if p[J1] > 0.0:
        if mode[SLIP1] != 0:
            r[4] = mode[SLIP1] * y[W1]
        else:
            breakaway, drive = p[RADIUS] * p[N1] * p[MU_S], drive1(p, y)
            r[4], r[5] = breakaway - drive, breakaway + drive
    return r


def arrest(drive, breakaway):
    """Mode after a velocity reached zero: stuck, or slipping the way the torque pushes."""
    return 0 if abs(drive) <= breakaway else (1 if drive > 0 else -1)


def switch_mode(y, p, mode, found):
    """Applies the root `found` to mode and arrested velocity; tells whether the motion changed its form."""
    first = found % 2 == 0
    if found < 2:
        if mode[SLIP2] == 0:
            mode[SLIP2], mode[REGION] = (1 if first else -1), ACCELERATING
        elif first:
            y[W2] = 0.0
            mode[SLIP2], mode[REGION] = arrest(drive2(p, y), breakaway2(p)), ACCELERATING
        elif mode[REGION] == ABOVE:
            s = mode[SLIP2]
            a = loop_acceleration(p, ABOVE, s * y[W2], s * drive2(p, y))[0]
            mode[REGION] = DECELERATING if a < 0 else ACCELERATING
            return False
        elif mode[REGION] == ACCELERATING and mode[SLIP2] * y[W2] >= p[VC] * (1 - 1e-9):
            mode[REGION] = ABOVE
            return False
        else:
            mode[REGION] = ACCELERATING if mode[REGION] == DECELERATING else DECELERATING
    elif found < 4:
        if mode[SLIP3] == 0:
            mode[SLIP3] = 1 if first else -1
        else:
            y[W3] = 0.0
            mode[SLIP3] = arrest(drive3(p, y), p[ETA] * p[TFM])
    elif mode[SLIP1] == 0:
        mode[SLIP1] = 1 if first else -1
    else:
        y[W1] = 0.0
        mode[SLIP1] = arrest(drive1(p, y), p[RADIUS] * p[N1] * p[MU_S])
    return True


def simulate(p, end, output_step, method, weights, tolerance):
    """One run; returns the last state, the number of mode changes and of output points."""
    n = 7 if p[J1] > 0.0 else 5
    y, mode, t = np.zeros(n), np.zeros(4, dtype=np.int64), 0.0
    grid = np.linspace(0.0, end, round(end / output_step) + 1)
    rtol = np.full(n, tolerance)
    if weights == "absolute":
        rtol[[k for k in (TH2, TH3, TH1) if k < n]] = 0.0
    events = []
    for k in range(6 if n == 7 else 4):
        event = lambda t, y, k=k: roots(y, p, mode)[k]
        event.terminal, event.direction = True, -1
        events.append(event)
    switches = outputs = 0
    while True:
        result = solve_ivp(
            lambda t, y: right_hand_side(y, p, mode),
            (t, end),
            y,
            method=method,
            jac=lambda t, y: jacobian(y, p, mode),
            events=events,
            t_eval=grid[np.searchsorted(grid, t, side="right"):],
            rtol=rtol if weights == "absolute" else tolerance,
            atol=tolerance,
        )
        outputs += len(result.t)
        if result.status == 0:
            return result.y[:, -1], switches, outputs
        if result.status < 0:
            raise RuntimeError(result.message)
        found = next(k for k, times in enumerate(result.t_events) if times.size)
        t, y = result.t_events[found][-1], result.y_events[found][-1].copy()
        switches += switch_mode(y, p, mode, found)


def main():
    job = json.load(sys.stdin)
    p = np.array([job["parameters"].get(name, 0.0) for name in NAMES])
    warnings.filterwarnings("ignore", message="At least one element of `rtol` is too small")
    print(f"# scipy {scipy.__version__}, numba {numba.__version__}")
    simulate(p, 1.0, job["output_step"], "LSODA", "plain", 1e-4)  # compiles
    simulate(p, 1.0, job["output_step"], "Radau", "plain", 1e-4)
    for method, weights, tolerance in job["runs"]:
        best = math.inf
        for _ in range(job["repeat"]):
            start = time.process_time()
            try:
                y, switches, _ = simulate(p, job["end"], job["output_step"], method, weights, tolerance)
            except RuntimeError as error:
                print(f"{method} {weights} {tolerance:g}: {error}", file=sys.stderr)
                break
            best = min(best, time.process_time() - start)
        else:
            print(f"{method},{weights},{tolerance!r},{best!r},{float(y[TH2])!r},{switches}", flush=True)


main()
