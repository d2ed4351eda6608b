"""Ensembles by torch, on a device: the same methods and tableaus, thousands of trajectories at once.

For a graphics processor; the tests run it on a CPU, where compiled code is what to use.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
import torch
from torch import Tensor, nn

from flexsurr.config.study import Integrator
from flexsurr.simulation.ensemble import Ensemble, Observe
from flexsurr.simulation.fixed_step import steps_within
from flexsurr.simulation.rhs import Array
from flexsurr.simulation.simulate import check_times
from flexsurr.simulation.tableaus import DOP853, RK4, ExplicitTableau, Row
from flexsurr.simulation.trajectory import COMPLETED, NOT_FINITE, from_compiled
from flexsurr.surrogates import (
    EvenHNN,
    Network,
    NetworkPortHamiltonian,
    PolynomialHamiltonian,
    PolynomialPortHamiltonian,
    PortHamiltonian,
    Surrogate,
)
from flexsurr.surrogates.packed import rows_and_columns, symmetric
from flexsurr.surrogates.scaling import origins
from flexsurr.surrogates.torch_module import field
from flexsurr.training.networks import ACTIVATIONS, to_torch

TABLEAUS: dict[str, ExplicitTableau] = {"rk4": RK4, "dop853_fixed": DOP853.method}

BLOCK = 1 << 14
"""Trajectories that are on the device at a time."""

Field = Callable[[Tensor], Tensor]
Put = Callable[[Any], Tensor]


def simulate_on_device(
    surrogate: Surrogate,
    t: Array,
    x0: Array,
    integrator: Integrator,
    device: str,
    observe: Observe | None = None,
) -> Ensemble:
    """As `flexsurr.simulation.simulate_ensemble`, by torch on `device` ("cpu", "cuda"), in double precision.

    With rk4 or dop853_fixed. Raises ValueError for another method, and for a device that there is not.
    """
    t = np.ascontiguousarray(t, dtype=np.float64)
    check_times(t)
    if integrator.method not in TABLEAUS or integrator.step_s is None:
        raise ValueError(f"device: {integrator.method} does not run on one; allowed: {', '.join(TABLEAUS)}")
    tableau = TABLEAUS[integrator.method]
    rates = rates_on_device(surrogate, _device(device))
    pieces, last = [], np.full(len(x0), t.size)
    end_s = np.full(len(x0), t[-1])
    steps = 0
    for first in range(0, len(x0), BLOCK):
        numbers = slice(first, min(first + BLOCK, len(x0)))
        x = torch.from_numpy(np.ascontiguousarray(x0[numbers])).to(device)
        samples = [x.cpu().numpy()]
        steps = 0
        for row in range(1, t.size):
            interval = t[row] - t[row - 1]
            count = steps_within(interval, integrator.step_s)
            for n in range(count):
                x = _step(tableau, rates, x, interval / count)
                steps += 1
                lost = ~torch.isfinite(x).all(dim=1)
                if lost.any():
                    at = numbers.start + np.flatnonzero(lost.cpu().numpy())
                    at = at[last[at] == t.size]
                    last[at] = row
                    end_s[at] = t[row - 1] + n * interval / count
                    x = torch.where(lost[:, None], torch.zeros_like(x), x)
            samples.append(x.cpu().numpy())
        states = np.stack(samples, axis=1)
        states[np.arange(t.size) >= last[numbers, None]] = np.nan
        pieces.append(states if observe is None else np.asarray(observe(numbers, states)))
    ended = [
        from_compiled(int(rows), float(end), 0, steps, COMPLETED if rows == t.size else NOT_FINITE)
        for rows, end in zip(last, end_s, strict=True)
    ]
    return Ensemble(
        t=t,
        kept=np.concatenate(pieces),
        state_names=surrogate.state_names,
        state_units=surrogate.state_units,
        completed=last == t.size,
        reasons=tuple(outcome.reason for outcome in ended),
        end_time_s=end_s,
        evaluations=steps * len(tableau.c) * len(x0),
    )


def _device(name: str) -> torch.device:
    try:
        device = torch.device(name)
        torch.empty(0, device=device)
    except (RuntimeError, AssertionError) as problem:
        cause = str(problem).splitlines()[0]
        raise ValueError(
            f"device: {name!r} is not allowed; allowed: cpu, or cuda where torch finds it ({cause})"
        ) from None
    return device


def _step(tableau: ExplicitTableau, rates: Field, x: Tensor, h: float) -> Tensor:
    stages = [rates(x)]
    for row in tableau.a[1:]:
        stages.append(rates(x + h * _sum(row, stages)))
    return x + h * _sum(tableau.b, stages)


def _sum(row: Row, stages: list[Tensor]) -> Tensor:
    return torch.stack([coefficient * stages[j] for j, coefficient in row.items()]).sum(dim=0)


def rates_on_device(surrogate: Surrogate, device: torch.device) -> Field:
    """ẋ (n, d) of states (n, d), both in their units, on `device`."""
    count = len(surrogate.state_names)

    def put(array: Any) -> Tensor:
        return torch.from_numpy(np.array(array)).to(device)

    scaled = _scaled(surrogate, put)
    x_from, dx_from = map(put, origins(surrogate.scaling, count))
    states, rates = put(surrogate.scaling.states(count)), put(surrogate.scaling.rates(count))

    def of(x: Tensor) -> Tensor:
        return (dx_from + rates * field(scaled, (x - x_from) / states)).detach()

    return of


def _scaled(surrogate: Any, put: Put) -> Field:
    """What `torch_module.field` takes: scaled states (n, d) -> a scalar, two of them, or rates (n, d)."""
    if isinstance(surrogate, EvenHNN):
        return _even_energy(surrogate, put)
    if isinstance(surrogate, PolynomialHamiltonian):
        return _polynomials(put(surrogate.exponents), put(surrogate.parameters[:, None]))
    if isinstance(surrogate, PortHamiltonian):
        return _port_hamiltonian(surrogate, put)
    module = to_torch(surrogate) if isinstance(surrogate, Network) else surrogate.module  # of the user's own
    on_device: nn.Module = module.double().eval().requires_grad_(False).to(put(0.0).device)
    return on_device


def _polynomials(exponents: Tensor, coefficients: Tensor) -> Field:
    """Polynomials (n, k) of x (n, d) by exponents (count, d) and coefficients (count, k)."""
    return lambda x: (x[:, None, :] ** exponents).prod(dim=-1) @ coefficients


def _even_energy(surrogate: EvenHNN, put: Put) -> Field:
    """The scalar of an even Hamiltonian network, (n, 2r) -> (n, 1)."""
    weights, biases, readout = map(put, surrogate.arrays())
    rows, columns = map(put, rows_and_columns(len(surrogate.state_names) // 2))
    sigma = ACTIVATIONS[surrogate.activation]

    def energy(x: Tensor) -> Tensor:
        products = torch.cat([part[:, rows] * part[:, columns] for part in x.chunk(2, dim=1)], dim=1)
        return sigma(products @ weights + biases) @ readout[:, None]

    return energy


def _port_hamiltonian(surrogate: PortHamiltonian, put: Put) -> Field:
    """The scaled rates of a port-Hamiltonian surrogate, (n, 2r) -> (n, 2r)."""
    mass_matrix = _mass_matrix(surrogate, put)
    stiffness, damping = put(surrogate.scaled_stiffness), put(surrogate.scaled_damping)
    potential, springs = surrogate.potential, None
    if potential is not None:
        lowered, coefficients = potential.gradient_terms
        springs = _polynomials(put(lowered), put(coefficients))

    def rates(x: Tensor) -> Tensor:
        q, p = x.detach().chunk(2, dim=1)
        q = q.clone().requires_grad_()
        mass = mass_matrix(q)
        velocities = torch.linalg.solve(mass.detach(), p[..., None])[..., 0]
        kinetic = 0.5 * torch.einsum("ni,nij,nj->", velocities, mass, velocities)
        (gyroscopic,) = torch.autograd.grad(kinetic, q)
        forces = gyroscopic - q.detach() @ stiffness - velocities @ damping
        if springs is not None:
            forces = forces - springs(q.detach())
        return torch.cat([velocities, forces], dim=1)

    return rates


def _mass_matrix(surrogate: PortHamiltonian, put: Put) -> Field:
    """M̂ (n, r, r) at scaled coordinates (n, r)."""
    rows, columns = map(put, rows_and_columns(surrogate.pairs))

    def triangle(packed: Tensor) -> Tensor:
        matrix = packed.new_zeros((len(packed), surrogate.pairs, surrogate.pairs))
        return matrix.index_put(
            (torch.arange(len(packed), device=packed.device)[:, None], rows, columns), packed
        )

    def mirrored(packed: Tensor) -> Tensor:
        lower = triangle(packed)
        return lower + lower.tril(-1).mT

    if isinstance(surrogate, PolynomialPortHamiltonian):
        entries = surrogate.parameters[: -2 * surrogate.packed_size].reshape(surrogate.packed_size, -1)
        polynomials = _polynomials(put(surrogate.exponents), put(entries.T))
        return lambda q: mirrored(polynomials(q))
    assert isinstance(surrogate, NetworkPortHamiltonian)
    weights, biases, readout, constant, *_ = map(put, surrogate.arrays())
    floor, sigma = put(symmetric(surrogate.floor, surrogate.pairs)), ACTIVATIONS[surrogate.activation]
    even, factored = surrogate.even, surrogate.factored

    def of_network(q: Tensor) -> Tensor:
        inputs = q[:, rows] * q[:, columns] if even else q
        found = constant + sigma(inputs @ weights + biases) @ readout.T
        if not factored:
            return floor + mirrored(found)
        factor = triangle(found)
        return floor + factor @ factor.mT

    return of_network
