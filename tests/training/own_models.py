"""Networks as a user writes them: rates, H, H and D, a Lagrangian network and a graph network."""

import torch
from torch import nn


class Plain(nn.Module):
    """ẋ = W₂ σ(W₁ x + b₁) + b₂."""

    def __init__(self, states, hidden=6):
        super().__init__()
        self.layers = nn.Sequential(nn.Linear(states, hidden), nn.Tanh(), nn.Linear(hidden, states))

    def forward(self, x):
        return self.layers(x)


class Energy(nn.Module):
    """H, as a vector (batch,)."""

    def __init__(self, states, hidden=6):
        super().__init__()
        self.layers = nn.Sequential(nn.Linear(states, hidden), nn.Softplus(), nn.Linear(hidden, 1))

    def forward(self, x):
        return self.layers(x).squeeze(-1)


class EnergyAndDissipation(nn.Module):
    """H and D, each (batch, 1)."""

    def __init__(self, states):
        super().__init__()
        self.energy = nn.Sequential(nn.Linear(states, 6), nn.Tanh(), nn.Linear(6, 1))
        self.dissipation = nn.Sequential(nn.Linear(states, 6), nn.Tanh(), nn.Linear(6, 1))

    def forward(self, x):
        return self.energy(x), self.dissipation(x)


class Lagrangian(nn.Module):
    """L = ½ q̇ᵀ M(q) q̇ − V(q): q̇ = M⁻¹ p and, by Euler and Lagrange, ṗ = ∂L/∂q at constant q̇."""

    def __init__(self, states, hidden=8):
        super().__init__()
        self.r = states // 2
        self.root = nn.Sequential(nn.Linear(self.r, hidden), nn.Tanh(), nn.Linear(hidden, self.r**2))
        self.potential = nn.Sequential(nn.Linear(self.r, hidden), nn.Softplus(), nn.Linear(hidden, 1))

    def mass(self, q):
        root = self.root(q).view(-1, self.r, self.r)
        return root @ root.transpose(1, 2) + 0.1 * torch.eye(self.r, dtype=q.dtype)

    def forward(self, x):
        q, p = x.split(self.r, dim=1)
        velocity = torch.linalg.solve(self.mass(q), p)
        # ∂L/∂q holds the velocity: it comes from q, not from this copy of it
        at = q.detach().requires_grad_()
        kinetic = 0.5 * torch.einsum("bi,bij,bj->b", velocity, self.mass(at), velocity)
        lagrangian = kinetic - self.potential(at).squeeze(1)
        (force,) = torch.autograd.grad(lagrangian.sum(), at, create_graph=True)
        return torch.cat([velocity, force], dim=1)


class MessagePassing(nn.Module):
    """Each pair (q, p) is a node of a chain; messages pass between neighbours."""

    def __init__(self, states, hidden=8, rounds=2):
        super().__init__()
        self.r, self.rounds = states // 2, rounds
        links = [(i, j) for i in range(self.r) for j in (i - 1, i + 1) if 0 <= j < self.r]
        self.register_buffer("links", torch.tensor(links, dtype=torch.int64).reshape(-1, 2).T)
        self.encode = nn.Linear(2, hidden)
        self.message = nn.Linear(2 * hidden, hidden)
        self.update = nn.Linear(2 * hidden, hidden)
        self.decode = nn.Linear(hidden, 2)

    def forward(self, x):
        nodes = torch.tanh(self.encode(torch.stack([x[:, : self.r], x[:, self.r :]], dim=2)))
        to, since = self.links
        for _ in range(self.rounds):
            sent = torch.tanh(self.message(torch.cat([nodes[:, to], nodes[:, since]], dim=2)))
            received = torch.zeros_like(nodes).index_add(1, to, sent)
            nodes = nodes + torch.tanh(self.update(torch.cat([nodes, received], dim=2)))
        rates = self.decode(nodes)
        return torch.cat([rates[..., 0], rates[..., 1]], dim=1)
