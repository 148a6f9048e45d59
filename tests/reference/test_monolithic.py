"""The reference agrees with physics, with SciPy and with the written semantics, without an import from the project."""

from itertools import pairwise

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from scipy.integrate import solve_ivp

from .arm import (
    acceleration,
    coriolis,
    external_force,
    inertia,
    jacobian,
    jacobian_rate,
    tip_position,
    tip_velocity,
    wall_gap,
)
from .monolithic import (
    Setup,
    SetupError,
    plant_of,
    sensor_noise,
    simulate_reference,
    virtual_trajectory,
)
from .segment import OK, Solver, advance, initial_mode

CRITICAL = (2.0 * np.sqrt(8000.0),) * 2
FIG2 = Setup(B=CRITICAL)
SOLVER = Solver()
WRONG = (2.0, 2.5, 0.0, 0.0, 0.0, 0.0)
ADAPTIVE = ("CraigAdaptiveImpedance", "SlotineLiAdaptiveImpedance", "SpongOrtegaAdaptiveImpedance")


@pytest.mark.parametrize("wall_offset", [10.0, 1.45], ids=["free", "bounce"])
def test_energy_is_conserved(wall_offset):
    setup = Setup(wall_offset=wall_offset, gravity=0.0 if wall_offset > 2 else 9.81)
    plant, y, energies, depths = plant_of(setup), np.array([1.9, 0.9, 2.0, -0.5]), [], []
    mode = initial_mode(y, plant)
    for _ in range(20000):
        q, dq = y[:2].copy(), y[2:].copy()
        height = plant.p[0] * np.sin(q[0]) + plant.p[1] * tip_position(plant.arm, q)[1]
        depths.append(max(wall_gap(plant, q), 0.0))
        elastic = 0.5 * plant.wall.K_f * depths[-1] ** 2
        energies.append(0.5 * dq @ inertia(plant.arm, plant.p, q) @ dq + setup.gravity * height + elastic)
        assert advance(y, mode, np.zeros(2), plant, 1e-4, SOLVER) == OK
    touched = np.array(depths) > 0.0
    assert touched.any() == (wall_offset < 2.0)
    # Each of 2e4 segments rounds an energy of about 50 J to 1e-14 J. This is 2e-10 J if all have one sign.
    assert_allclose(energies, energies[0], atol=2e-10)


def segment_by_solve_ivp(plant, y, tau, duration):
    """Solve the same problem by SciPy with terminal events; return the state at the end and the number of events."""
    wall, contact, pushing = plant.wall, *initial_mode(y, plant)

    def rate(y):
        return np.dot((wall.n1, wall.n2), tip_velocity(plant.arm, y[:2], y[2:]))

    def force(y):
        if not (contact and pushing):
            return 0.0, 0.0
        n, dx = np.array([wall.n1, wall.n2]), np.array(tip_velocity(plant.arm, y[:2], y[2:]))
        along = np.array([-wall.n2, wall.n1])
        F_n = wall.K_f * wall_gap(plant, y[:2]) * (1.0 + wall.D_f * rate(y))
        return tuple(F_n * n + wall.mu * F_n * np.tanh(along @ dx / wall.friction_velocity) * along)

    def right_side(_, y):
        return np.concatenate([y[2:], acceleration(plant, y[:2], y[2:], tau, force(y))])

    t, events = 0.0, 0
    while True:
        meets = lambda _, y: wall_gap(plant, y[:2])  # noqa: E731
        pulls = lambda _, y: 1.0 + wall.D_f * rate(y) if contact else 1.0  # noqa: B023, E731
        for event, up in ((meets, not contact), (pulls, not pushing)):
            setattr(event, "terminal", True)  # noqa: B010 - solve_ivp reads attributes of functions
            setattr(event, "direction", 1.0 if up else -1.0)  # noqa: B010
        # max_step is so small that SciPy cannot step over a contact.
        options = {"method": "DOP853", "rtol": 1e-13, "atol": 1e-15, "max_step": duration / 200}
        result = solve_ivp(right_side, (t, duration), y, events=[meets, pulls], **options)
        t, y = result.t[-1], result.y[:, -1]
        if result.status == 0:
            return y, events
        events += 1
        if result.t_events[0].size:
            contact, pushing = not contact, 1.0 + wall.D_f * rate(y) > 0.0
        else:
            pushing = not pushing


@pytest.mark.parametrize(("D_f", "pull", "count"), [(0.0, 0.0, 2), (0.5, 0.0, 2), (10.0, 300.0, 3)])
def test_bounce_agrees_with_solve_ivp(D_f, pull, count):
    # A bounce alone never makes the damped wall pull, because the wall is passive. 300 N outward make the wall pull.
    # Then there are three events: contact begins, the push ends, contact ends.
    plant = plant_of(Setup(D_f=D_f, mu=0.3, viscous=(0.5, 0.3), gravity=9.81, friction_velocity=0.1))
    q = np.array([1.9, 1.2])
    J = jacobian(plant.arm, q)
    plant = plant._replace(wall=plant.wall._replace(offset=1e-3 - tip_position(plant.arm, q)[0]))
    start, tau = np.concatenate([q, np.linalg.solve(J, [-1.0, 0.4])]), J.T @ np.array([pull, 0.0])
    expected, events = segment_by_solve_ivp(plant, start, tau, 0.03)
    assert events == count
    y, mode = start.copy(), initial_mode(start, plant)
    assert advance(y, mode, tau, plant, 0.03, SOLVER) == OK
    # Both programs have rtol = 1e-13 over some 1e2 steps of rates of 5 rad/s. A missed kink would cost 1e-6 and more.
    assert_allclose(y, expected, rtol=0.0, atol=1e-10)


def test_segments_of_the_loop_agree_with_solve_ivp():
    setup = Setup(B=CRITICAL, D_f=0.5, mu=0.3, stop_time=1.1)
    rows, plant = simulate_reference(setup), plant_of(setup)
    state = np.stack([rows[f"plant.{name}[{i}]"] for name in ("q", "dq") for i in (1, 2)], 1)
    tau = np.stack([rows[f"actuator.tau[{i}]"] for i in (1, 2)], 1)
    contact = rows["plant.gap"] > 0.0
    crossings = np.flatnonzero(contact[1:] != contact[:-1])
    assert len(crossings) >= 2
    for k in (0, 5000, *crossings, crossings[0] + 10):
        expected, events = segment_by_solve_ivp(plant, state[k], tau[k + 1], 1e-4)
        assert (events > 0) == (k in crossings)
        # rtol = 1e-13 of rates of 5 rad/s, and events located to 1e-15 s times jumps in jerk, are both below 1e-12.
        assert_allclose(state[k + 1], expected, rtol=0.0, atol=1e-12)


def test_contact_shorter_than_a_segment_is_seen():
    plant, q = plant_of(FIG2), np.array([1.9, 1.2])
    arm, p, J = plant.arm, plant.p, jacobian(plant.arm, q)
    dq = np.linalg.solve(J, [-0.01, 0.3])
    # gap = -1e-6 m + 0.01 m/s t - 33 m/s2 t^2 / 2: in contact for 0.34 ms of a segment of 1 ms.
    ddq = np.linalg.solve(J, np.array([33.0, 0.0]) - jacobian_rate(arm, q, dq) @ dq)
    tau = inertia(arm, p, q) @ ddq + coriolis(arm, p, q, dq) @ dq
    ends = []
    for K_f, substeps in ((1e5, 1), (1e5, 64), (0.0, 1)):
        plant = plant._replace(wall=plant.wall._replace(offset=1e-6 - tip_position(arm, q)[0], K_f=K_f))
        y = np.concatenate([q, dq])
        mode = initial_mode(y, plant)
        assert not mode[0]
        assert advance(y, mode, tau, plant, 1e-3, SOLVER._replace(substeps=substeps)) == OK
        assert not mode[0]
        ends.append(y)
    # 64 steps round values of O(1). The push of the wall, about 0.03 N for 0.3 ms, changes rates by 1e-5 rad/s.
    assert_allclose(ends[0], ends[1], rtol=0.0, atol=1e-13)
    assert np.abs(ends[0] - ends[2]).max() > 1e-7


def test_noise_is_the_philox_recipe():
    setup = Setup(noise_std=25.0, noise_bound=75.0, seed=42)
    noise = sensor_noise(setup, 200)
    for n in (0, 1, 2, 199):
        bits = np.random.Philox(key=np.array([42, 0], dtype=np.uint64), counter=(n - 1) % 2**256)
        w0, w1 = (int(w) for w in bits.random_raw(2))
        u0, u1 = ((w0 >> 11) + 0.5) / 2.0**53, ((w1 >> 11) + 0.5) / 2.0**53
        r = 25.0 * np.sqrt(-2.0 * np.log(1.0 - u0 * (1.0 - np.exp(-4.5))))
        # This allows a few roundings of functions with condition numbers below 10.
        assert_allclose(noise[n], [r * np.cos(2 * np.pi * u1), r * np.sin(2 * np.pi * u1)], rtol=1e-12)
    assert np.hypot(*noise.T).max() <= 75.0
    rows = simulate_reference(Setup(B=CRITICAL, noise_std=25.0, noise_bound=75.0, stop_time=1.0))
    error = rows["sensor.F_hat[1]"][1:] - rows["plant.F_ext[1]"][:-1]
    in_contact = rows["plant.gap"][:-1] > 0.0
    assert_array_equal(error != 0.0, in_contact)


def test_virtual_trajectory_is_clipped_in_the_wall():
    time = np.arange(20001) * 1e-4
    v = virtual_trajectory(FIG2, time)
    w = np.pi
    # One rounding of the phase (2 pi), times amplitudes and w^2, gives 15 x 1e-15.
    assert_allclose(v[:, 0, 1], np.sin(w * time), atol=1e-14)
    inside = 1.5 * np.cos(w * time) < -1.46
    assert_allclose(v[inside, 0, 0], -1.46, atol=1e-15)
    assert_array_equal(v[inside, 1:, 0], 0.0)
    assert_allclose(v[~inside, 1, 0], -1.5 * w * np.sin(w * time[~inside]), atol=1e-13)
    assert_allclose(v[:, 2, 1], -w * w * np.sin(w * time), atol=1e-13)


def test_rows_hold_sampled_values_and_left_limits():
    setup = Setup(B=CRITICAL, stop_time=1.0, tau_max=(200.0, 60.0), p_start=WRONG)
    r, plant = simulate_reference(setup), plant_of(setup)
    assert_array_equal(r["time"], np.arange(10001) * 1e-4)
    for name in r:
        assert r[name].shape == (10001,)
        if not name.startswith(("plant.", "time")):
            assert r[name][0] == r[name][1]
    assert_array_equal(r["sensor.F_hat[1]"][1:], r["plant.F_ext[1]"][:-1])
    for i, limit in ((1, 200.0), (2, 60.0)):
        command = r[f"controller.tau_cmd[{i}]"]
        assert_array_equal(r[f"actuator.tau[{i}]"], np.clip(command, -limit, limit))
        assert_array_equal(r[f"actuator.saturated[{i}]"], np.abs(command) > limit)
        assert_array_equal(r[f"controller.e[{i}]"][1:], (r[f"plant.x[{i}]"][:-1] - r[f"controller.x_t[{i}]"][1:]))
    assert r["actuator.saturated[2]"].any()
    for k in (0, 1, 9500):
        q, dq, tau, ddq = (
            np.array([r[f"{name}[{i}]"][k] for i in (1, 2)])
            for name in ("plant.q", "plant.dq", "actuator.tau", "plant.ddq")
        )
        assert_array_equal(ddq, acceleration(plant, q, dq, tau, external_force(plant, q, dq)))


def test_target_reference_of_the_loop_follows_its_equation():
    setup = Setup(M=(2.0, 3.0), B=(340.0, 150.0), mu=0.3, stop_time=1.1)
    r = simulate_reference(setup)
    for i, (M, B, K) in enumerate(zip(setup.M, setup.B, setup.K, strict=True), 1):
        x_t, dx_t, F = (r[f"{name}[{i}]"] for name in ("controller.x_t", "controller.dx_t", "sensor.F_hat"))
        x_v, dx_v, ddx_v = (r[f"trajectory.{name}[{i}]"] for name in ("x_v", "dx_v", "ddx_v"))
        assert (x_t[1], dx_t[1]) == (x_v[1], dx_v[1])
        for k in (1, 5000, np.argmax(np.abs(F)), np.argmax(np.abs(np.diff(ddx_v))) + 1):

            def deviation(_, d, k=k, F=F, coefficients=(M, B, K)):
                M, B, K = coefficients
                return [d[1], (-F[k] - B * d[1] - K * d[0]) / M]

            start = [x_t[k] - x_v[k], dx_t[k] - dx_v[k]]
            d, rate = solve_ivp(deviation, (0.0, 1e-4), start, method="DOP853", rtol=1e-13, atol=1e-18).y[:, -1]
            # This allows roundings of positions and rates of O(1).
            assert_allclose(x_t[k + 1], x_v[k] + 1e-4 * dx_v[k] + 0.5e-8 * ddx_v[k] + d, rtol=0.0, atol=1e-15)
            assert_allclose(dx_t[k + 1], dx_v[k] + 1e-4 * ddx_v[k] + rate, rtol=0.0, atol=1e-14)


def test_torque_reaches_the_plant_without_delay():
    r = simulate_reference(Setup(B=CRITICAL, stop_time=0.01))
    # (dq[k+1] - dq[k]) / Ts is the mean acceleration under the torque of tick k; it varies by about jerk x Ts / 2.
    mean = np.diff(r["plant.dq[1]"]) / 1e-4
    assert_allclose(mean, r["plant.ddq[1]"][1:], atol=0.02)


def test_conventional_control_in_the_paper_scenario():
    r = simulate_reference(FIG2)
    contact = r["time"][r["plant.penetration"] > 0.0]
    # An independent prototype found contact from 0.92 s to 1.08 s and 557 N, given to these digits.
    assert_allclose([contact[0], contact[-1]], [0.92, 1.08], atol=0.005)
    assert_allclose(np.hypot(r["plant.F_ext[1]"], r["plant.F_ext[2]"]).max(), 557.0, atol=1.0)
    error = np.hypot(r["controller.e[1]"], r["controller.e[2]"]).max()
    wrong = simulate_reference(Setup(B=CRITICAL, p_start=WRONG))
    assert error < 2e-4
    assert np.hypot(wrong["controller.e[1]"], wrong["controller.e[2]"]).max() > 20 * error


@pytest.mark.parametrize("controller", ["HoganImpedance", "SlotineLiAdaptiveImpedance"])
def test_halved_steps_change_nothing(controller):
    setup = Setup(
        controller=controller,
        p_start=WRONG,
        Gamma=(0.0, 4.0, 0.0, 0.0, 0.0, 0.0),
        noise_std=20,
        noise_bound=60,
    )
    coarse = simulate_reference(setup)
    fine = simulate_reference(setup, Solver(rtol=1e-13, atol=1e-15, substeps=2))
    for name, values in coarse.items():
        # Only rounding of positions (1e-16 m) is left. For |e| of 1e-3 m this is 1e-10 of the range at worst.
        assert np.abs(values - fine[name]).max() <= 1e-9 * max(np.ptp(values), 1e-6), name


@pytest.mark.parametrize("controller", ADAPTIVE)
def test_adaptation_finds_the_mass_in_free_motion(controller):
    setup = Setup(
        controller=controller,
        p_start=WRONG,
        Gamma=(0.0, 4.0, 0.0, 0.0, 0.0, 0.0),
        sample_time=2e-5,
        stop_time=0.9,
    )
    r = simulate_reference(setup)
    # The paper says that m2_hat "quickly approaches its true value 1 kg during the first free-motion duration". At most
    # a tenth of the initial error of 1.5 kg is left. Spong-Ortega is slowest, because its gain has the inverse of the
    # larger H0.
    assert abs(r["controller.p_hat[2]"][-1] - 1.0) < 0.15
    assert_array_equal(r["controller.p_hat[1]"], 2.0)
    changes = np.flatnonzero(np.diff(r["controller.p_hat[2]"]))
    assert changes[0] == 1  # p_hat[0] in rows 0 and 1, p_hat[1] in row 2


def test_update_divisor_projection_dead_zone_and_freeze():
    base = {
        "controller": "SlotineLiAdaptiveImpedance",
        "p_start": WRONG,
        "Gamma": (0.0, 4.0, 0, 0, 0, 0),
        "stop_time": 0.2,
    }
    m2 = lambda **options: simulate_reference(Setup(**base, **options))["controller.p_hat[2]"]  # noqa: E731
    assert all((k - 1) % 5 == 0 for k in np.flatnonzero(np.diff(m2(update_divisor=5))))
    assert m2(projection=True, p_min=(0, 1.7, 0, 0, 0, 0)).min() == 1.7
    assert_array_equal(m2(dead_zone=100.0), 2.5)
    assert_array_equal(m2(freeze_when_saturated=True, tau_max=(1e-3, 1e9)), 2.5)
    starts = [m2(update_divisor=n)[n + 1] - 2.5 for n in (1, 2)]
    assert starts[0] != 0.0
    # The rate at tick 0 is the same, and is multiplied by N Ts. The difference of two values of 2.5 kg is rounded to
    # 4e-16 kg.
    assert_allclose(starts[1], 2.0 * starts[0], rtol=0.0, atol=2e-15)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"controller": "PID"}, "'PID' is unknown; known: HoganImpedance"),
        ({"sample_time": 3e-4}, "give a whole number"),
        ({"wall_normal": (1.0, 1.0)}, "give a unit vector"),
        ({"noise_std": 1.0}, "noise_bound 0.0 N"),
    ],
)
def test_meaningless_numbers_are_refused(change, message):
    with pytest.raises(SetupError, match=message):
        Setup(**change)


def test_same_setup_same_bits():
    first, second = simulate_reference(FIG2), simulate_reference(FIG2)
    assert all(first[name].tobytes() == second[name].tobytes() for name in first)
    assert all(b > a for a, b in pairwise(first["time"]))
