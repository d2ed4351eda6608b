"""Networks of one's own, which a sweep names as `architecture: examples/my_models.py:Oscillators`.

A class is made with the number of states, 2r, and the options of the sweep. Its forward takes scaled states
(batch, 2r), r coordinates and r momenta, and returns rates (batch, 2r), or an energy H (batch, 1), of which
flexsurr makes Hamilton's equations. Run as a script, this file tries them.
"""

import torch
from torch import Tensor, nn


class Residual(nn.Module):
    """Rates: a linear model, and a network for what it leaves."""

    def __init__(self, states: int, hidden: int = 16) -> None:
        super().__init__()
        self.linear = nn.Linear(states, states, bias=False)
        self.rest = nn.Sequential(nn.Linear(states, hidden), nn.Tanh(), nn.Linear(hidden, states))

    def forward(self, x: Tensor) -> Tensor:
        """Scaled rates (batch, 2r)."""
        return self.linear(x) + self.rest(x)


class Oscillators(nn.Module):
    """Energy H = ½ |L(q)ᵀ p|² + V(q): kinetic energy is a square, whatever the weights."""

    def __init__(self, states: int, hidden: int = 16) -> None:
        super().__init__()
        self.r = states // 2
        self.factor = nn.Sequential(nn.Linear(self.r, hidden), nn.Softplus(), nn.Linear(hidden, self.r**2))
        self.potential = nn.Sequential(nn.Linear(self.r, hidden), nn.Softplus(), nn.Linear(hidden, 1))

    def forward(self, x: Tensor) -> Tensor:
        """Scaled energy (batch, 1)."""
        q, p = x[:, : self.r], x[:, self.r :]
        factor = self.factor(q).reshape(-1, self.r, self.r)
        turned = (factor * p[:, :, None]).sum(dim=1)
        return 0.5 * (turned**2).sum(dim=1, keepdim=True) + self.potential(q)


if __name__ == "__main__":
    states = torch.randn(3, 2)
    for form in (Residual, Oscillators):
        print(form.__name__, tuple(form(states.shape[1])(states).shape))
