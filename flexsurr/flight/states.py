"""The states of a flexible aircraft and their places."""

EARTH = ("north_m", "east_m", "altitude_m")
ATTITUDE = ("phi", "theta", "psi")
VELOCITY = ("u", "v", "w")
RATES = ("p", "q", "r")
RIGID_BODY = EARTH + ATTITUDE + VELOCITY + RATES


def state_names(modes: int) -> tuple[str, ...]:
    """Twelve rigid-body states, amplitudes η of the elastic modes (from 1), their rates."""
    numbers = range(1, modes + 1)
    return RIGID_BODY + tuple(f"eta_{k}" for k in numbers) + tuple(f"eta_dot_{k}" for k in numbers)


def state_units(modes: int) -> tuple[str, ...]:
    """Units in the order of `state_names`."""
    rigid = ("m",) * 3 + ("rad",) * 3 + ("m/s",) * 3 + ("rad/s",) * 3
    return rigid + ("kg^0.5 m",) * modes + ("kg^0.5 m/s",) * modes
