"""Model exchange: rigs and controllers under solvers from outside, FMPy's CVODE and explicit Euler, and under CasADi's derivatives."""

import shutil
import tomllib

import fmpy
import numpy
import pytest
from conftest import ROOT, build
from rig import standard_inputs

casadi = pytest.importorskip("casadi", reason="casadi is pinned in requirements.txt")

NAMES = ["theta", "theta_dot", "theta3", "theta3_dot", "i", "T_f", "stuck"]
VERSIONS = ("fmi2", "fmi3")


def run(path, kind, stop, interval, **options):
    inputs = standard_inputs(path)
    if "Full" in str(path):
        inputs["N1"] = 20.0
    return fmpy.simulate_fmu(
        str(path), fmi_type=kind, stop_time=stop, output_interval=interval, start_values=inputs, output=NAMES, **options
    )


def at(times, result, name):
    """Values at the instants that both results have; at an event, those before it."""
    places = numpy.searchsorted(result["time"], times - 1e-9)
    return result[name][numpy.minimum(places, len(result) - 1)]


def switches(result):
    return int(numpy.abs(numpy.diff(result["stuck"].astype(int))).sum())


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("model", ["ReducedRig", "FullRig"])
def test_cvode_and_co_simulation_agree_over_a_minute(fmus, model, version):
    path = fmus[model, version]
    inside = run(path, "CoSimulation", 60.0, 0.01)
    outside = run(path, "ModelExchange", 60.0, 0.01, solver="CVode", relative_tolerance=1e-11)
    for name in ("theta", "theta3"):
        difference = numpy.abs(inside[name] - at(inside["time"], outside, name)).max()
        print(f"{model}.{version}, {name}: {difference:.1e} rad")
        assert difference < 1e-6
    assert switches(inside) == switches(outside)
    sticks = outside["stuck"].astype(bool)
    assert sticks.sum() > 10 and numpy.all(outside["theta_dot"][sticks] == 0.0)


@pytest.mark.parametrize("version", VERSIONS)
def test_the_difference_is_the_solver_s(fmus, version):
    """It falls with CVODE's tolerance as far as CVODE goes."""
    path = fmus["ReducedRig", version]
    inside = run(path, "CoSimulation", 20.0, 0.01)
    differences = []
    for tolerance in (1e-8, 1e-10, 1e-12):
        outside = run(path, "ModelExchange", 20.0, 0.01, solver="CVode", relative_tolerance=tolerance)
        differences.append(numpy.abs(inside["theta"] - at(inside["time"], outside, "theta")).max())
    assert differences[0] > 5 * differences[1] > 25 * differences[2], differences


@pytest.mark.parametrize("version", VERSIONS)
def test_explicit_euler_finds_the_same_switches(fmus, version):
    path = fmus["ReducedRig", version]
    inside = run(path, "CoSimulation", 5.0, 1e-4)
    outside = run(path, "ModelExchange", 5.0, 1e-4, solver="Euler", step_size=1e-4)
    assert switches(inside) == switches(outside) >= 5
    assert numpy.abs(inside["theta"] - at(inside["time"], outside, "theta")).max() < 0.02
    sticks = outside["stuck"].astype(bool)
    assert numpy.all(outside["theta_dot"][sticks] == 0.0)


LAWS = [
    case
    for case in tomllib.loads((ROOT / "tests/golden/references.toml").read_text())["case"]
    if case["name"] in ("coulomb", "coulomb-stiction", "stribeck", "karnopp", "switch", "wojewoda", "two-gaussian-mu",
                        "two-gaussian-torque", "full rig", "full rig, mixed laws")
]


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("case", LAWS, ids=lambda case: case["name"])
def test_every_law_has_the_same_switches(case, version, tmp_path):
    model = tmp_path / "model.toml"
    model.write_text(case["model"])
    assert build(model, tmp_path).returncode == 0
    (path,) = tmp_path.glob(f"*.{version}.fmu")
    inside = run(path, "CoSimulation", 60.0, 0.01)
    outside = run(path, "ModelExchange", 60.0, 0.01, solver="CVode", relative_tolerance=1e-10)
    difference = max(numpy.abs(inside[name] - at(inside["time"], outside, name)).max() for name in ("theta", "theta3"))
    print(f"{case['name']}, {version}: {difference:.1e} rad, {switches(inside)} switches")
    assert switches(inside) == switches(outside)
    assert difference < 1e-4


# The integral starts beyond a limit, runs back, and reaches the other one; the filtered torque lets go of a limit.
CONTROLLERS = {
    "SpeedController": {"omega_ref": 1.0, "theta3_dot": 2.0, "integral": 40.0},
    "SoftTorque": {"omega_ref": 1.0, "theta3_dot": 3.0, "i": 1.0, "integral": 40.0, "filtered_torque": 3.0},
}


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("model", CONTROLLERS)
@pytest.mark.parametrize("solver", ["CVode", "Euler"])
def test_controllers_agree(fmus, model, version, solver):
    names = ["u", "integral", "saturated"]
    step = 0.01 if solver == "CVode" else 1e-3
    stop = 60.0 if solver == "CVode" else 20.0
    common = {"stop_time": stop, "output_interval": step, "start_values": CONTROLLERS[model], "output": names}
    path = str(fmus[model, version])
    inside = fmpy.simulate_fmu(path, fmi_type="CoSimulation", **common)
    options = {"relative_tolerance": 1e-10} if solver == "CVode" else {"step_size": step}
    outside = fmpy.simulate_fmu(path, fmi_type="ModelExchange", solver=solver, **common, **options)
    limits = [int(numpy.abs(numpy.diff(result["saturated"].astype(int))).sum()) for result in (inside, outside)]
    assert limits[0] == limits[1] >= 2
    difference = numpy.abs(inside["u"] - at(inside["time"], outside, "u")).max()
    print(f"{model}.{version}, {solver}: {difference:.1e} V")
    # Euler finds a switch at the end of its step.
    assert difference < (1e-6 if solver == "CVode" else 2 * numpy.abs(numpy.diff(inside["u"])).max())


@pytest.fixture(params=VERSIONS)
def sliding(request, fmus, tmp_path):
    """The reduced rig as CasADi's function of states and inputs, sliding from the start."""
    folder = tmp_path / "fmu"
    fmpy.extract(str(fmus["ReducedRig", request.param]), unzipdir=str(folder))
    builder = casadi.DaeBuilder("rig", str(folder), {})
    names = builder.x(), builder.u()
    # Not "y": CasADi reads every output as a real, and `stuck` is a Boolean.
    yield builder.create("rates", ["x", "u"], ["ode"], {"enable_fd": False}), names
    shutil.rmtree(folder)


START = {"theta_dot": 5.0, "theta3_dot": 5.0, "i": 1.2, "u": 3.0, "N2": 20.0}


def start(names):
    return numpy.array([START.get(name, 0.0) for name in names[0]])


def test_casadi_s_derivatives_forward_and_adjoint(sliding):
    rates, names = sliding
    assert names == (["theta", "theta_dot", "theta3", "theta3_dot", "i"], ["u", "N2"])
    x, u = start(names), numpy.array([3.0, 20.0])
    jacobian = rates.factory("jacobian", ["x", "u"], ["jac:ode:x", "jac:ode:u"])
    by_state, by_input = (numpy.array(matrix) for matrix in jacobian(x, u))
    ode = lambda x, u: numpy.array(rates(x, u)).ravel()
    for matrix, move in ((by_state, lambda d, k: (d * numpy.eye(5)[k], 0)), (by_input, lambda d, k: (0, d * numpy.eye(2)[k]))):
        for column in range(matrix.shape[1]):
            (a, b), (c, d) = move(1e-5, column), move(-1e-5, column)
            difference = (ode(x + a, u + b) - ode(x + c, u + d)) / 2e-5
            assert numpy.abs(difference - matrix[:, column]).max() < 1e-5 * max(1.0, numpy.abs(difference).max())
    assert numpy.abs(by_input[1, 1]) > 0.1, "the normal force brakes"
    seed = numpy.array([0.3, 1.0, -0.5, 0.1, 2.0])
    adjoint = rates.factory("adjoint", ["x", "u", "adj:ode"], ["adj:x", "adj:u"])
    for found, matrix in zip(adjoint(x, u, seed), (by_state, by_input)):
        assert numpy.abs(numpy.array(found).ravel() - seed @ matrix).max() < 1e-9


def test_optimal_control_with_casadi(sliding, fmus):
    """Voltages that bring the sliding disc from 5 to 7 rad/s and leave the shaft at rest, by the FMU's own derivatives; the FMU
    for co-simulation confirms them."""
    rates, names = sliding
    intervals, substeps, size = 12, 20, 0.0025
    x, u = casadi.MX.sym("x", 5), casadi.MX.sym("u")
    ode = lambda x: rates(x, casadi.vertcat(u, 20.0))
    next_x = x
    for _ in range(substeps):
        a = ode(next_x)
        b = ode(next_x + size / 2 * a)
        c = ode(next_x + size / 2 * b)
        d = ode(next_x + size * c)
        next_x = next_x + size / 6 * (a + 2 * b + 2 * c + d)
    interval = casadi.Function("interval", [x, u], [next_x])
    voltages = casadi.MX.sym("voltages", intervals)
    state = casadi.MX(start(names))
    for place in range(intervals):
        state = interval(state, voltages[place])
    miss = (state[1] - 7.0) ** 2 + (state[3] - 7.0) ** 2
    cost = miss + 1e-4 * casadi.sumsqr(casadi.diff(voltages))
    options = {"ipopt": {"hessian_approximation": "limited-memory", "print_level": 0, "max_iter": 30, "tol": 1e-7}, "print_time": False}
    solver = casadi.nlpsol("solver", "ipopt", {"x": voltages, "f": cost}, options)
    solution = solver(x0=numpy.full(intervals, 3.0))
    found = numpy.array(solution["x"]).ravel()
    begin = casadi.Function("cost", [voltages], [miss])(numpy.full(intervals, 3.0))
    assert float(solution["f"]) < 1e-2 < float(begin)

    signal = numpy.array(
        [(place * substeps * size, value) for place, value in enumerate(found)]
        + [((place + 1) * substeps * size, value) for place, value in enumerate(found)],
        dtype=[("time", float), ("u", float)],
    )
    signal.sort(order="time", kind="stable")
    for place in range(1, len(signal) - 1, 2):  # steps: the old value and the new one at the same instant
        signal["u"][place], signal["u"][place + 1] = found[place // 2], found[place // 2 + 1]
    result = fmpy.simulate_fmu(
        str(fmus["ReducedRig", "fmi2"]),
        fmi_type="CoSimulation",
        stop_time=intervals * substeps * size,
        output_interval=size,
        start_values={name: value for name, value in START.items() if name != "u"},
        input=signal,
        output=["theta_dot", "theta3_dot"],
    )
    assert abs(result["theta_dot"][-1] - 7.0) < 0.1 and abs(result["theta3_dot"][-1] - 7.0) < 0.1
