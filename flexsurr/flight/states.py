"""The states of a flexible aircraft: their names and units, and where each stands in x."""

EARTH = ("north_m", "east_m", "altitude_m")
ATTITUDE = ("phi", "theta", "psi")
VELOCITY = ("u", "v", "w")
RATES = ("p", "q", "r")
RIGID_BODY = EARTH + ATTITUDE + VELOCITY + RATES
RIGID_STATES = len(RIGID_BODY)

# Places in x by the states' names. After them stand η of each elastic mode, then η̇ of each.
NORTH_M, EAST_M, ALTITUDE_M, PHI, THETA, PSI, U, V, W, P, Q, R = range(RIGID_STATES)
VELOCITY_IN_X, RATES_IN_X = slice(U, W + 1), slice(P, R + 1)


def state_names(modes: int) -> tuple[str, ...]:
    """Twelve rigid-body states, amplitudes η of the elastic modes (from 1), their rates."""
    numbers = range(1, modes + 1)
    return RIGID_BODY + tuple(f"eta_{k}" for k in numbers) + tuple(f"eta_dot_{k}" for k in numbers)


def state_units(modes: int) -> tuple[str, ...]:
    """Units in the order of `state_names`."""
    rigid = ("m",) * 3 + ("rad",) * 3 + ("m/s",) * 3 + ("rad/s",) * 3
    return rigid + ("kg^0.5 m",) * modes + ("kg^0.5 m/s",) * modes
