"""A small network learns to turn white noise into a table whose error is blue noise.

It is a convolution over pixels that wraps, trained through the filtered sliced loss on new white noise in
each step, so that it cannot remember a table: it is judged on noise that it has not seen, and on a larger
table.

    python train_network.py --seconds 100 --out network.npy
"""

from __future__ import annotations

import argparse
import time

import torch
from torch import nn

import fsot
import fsot.metrics
import fsot.torch


class Network(nn.Module):
    """Moves the numbers of each pixel by what its neighbourhood holds."""

    def __init__(self, dims: int, width: int = 32, layers: int = 4) -> None:
        super().__init__()
        channels = [3 * dims] + [width] * (layers - 1)
        stages: list[nn.Module] = []
        for given, made in zip(channels, channels[1:], strict=False):
            stages += [nn.Conv2d(given, made, 5, padding=2, padding_mode="circular"), nn.SiLU()]
        last = nn.Conv2d(width, dims, 5, padding=2, padding_mode="circular")
        # At first it changes nothing.
        nn.init.zeros_(last.weight)
        assert last.bias is not None
        nn.init.zeros_(last.bias)
        self.stages = nn.Sequential(*stages, last)

    def forward(self, noise: torch.Tensor) -> torch.Tensor:
        """From ``[table, dim, y, x]`` in ``[0, 1)`` to the same."""
        turns = 2 * torch.pi * noise
        features = torch.cat([2 * noise - 1, turns.sin(), turns.cos()], 1)
        moved = torch.sigmoid(torch.logit(noise, 1e-6) + 4 * self.stages(features))
        # A sigmoid rounds to 1.0.
        return moved.clamp(max=fsot.BELOW_ONE)


def points_of(tables: torch.Tensor) -> torch.Tensor:
    """As fsot orders points, ``[table, y, x, dim]``."""
    return tables.permute(0, 2, 3, 1)


def all_descend(config: fsot.Config, share: float = 0.3) -> fsot.Config:
    """What fsot balances after each of its steps, a loss can only descend, with this share of the work."""
    balanced = [term for term in config.terms if term.role == "balance"]
    rest = [term for term in config.terms if term.role == "descend"]
    weight = share / len(balanced)
    descending = [fsot.Term(term.classes, dims=term.dims, weight=weight) for term in balanced]
    return config.with_terms(rest + descending)


def train(network: Network, size: int, seconds: float, most: int | None, seed: int, batch: int = 2) -> int:
    """Adam for so many seconds, or steps; returns how many steps that were."""
    objective = fsot.Objective(all_descend(fsot.Config(size, size)))
    generator = torch.Generator().manual_seed(seed)
    adam = torch.optim.Adam(network.parameters())
    begin, step = time.perf_counter(), 0
    while (share := step / most if most else (time.perf_counter() - begin) / seconds) < 1:
        adam.param_groups[0]["lr"] = 0.003 * 0.03**share
        noise = torch.rand(batch, 2, size, size, generator=generator)
        points = points_of(network(noise))
        slices = objective.draw(seed, step)
        losses = [fsot.torch.filtered_sliced_loss(one, objective, slices) for one in points]
        adam.zero_grad()
        torch.autograd.backward(torch.stack(losses).mean())
        adam.step()
        step += 1
    return step


def judge(network: Network, size: int, seed: int, seconds: float) -> dict[str, fsot.Table]:
    """Tables of noise that the network has not seen, of the network, and of fsot."""
    noise = torch.rand(1, 2, size, size, generator=torch.Generator().manual_seed(2**40 + seed))
    with torch.no_grad():
        made = network(noise)
    white_noise, of_network = (fsot.Table(points_of(one).numpy()[:, :, :, None, :]) for one in (noise, made))
    of_fsot = fsot.table(size, size, seed=seed, seconds=seconds, progress=False)
    return {"white noise": white_noise, "network": of_network, "fsot": of_fsot}


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--size", type=int, default=32, help="pixels of a side, in training")
    parser.add_argument("--seconds", type=float, default=100, help="of training")
    parser.add_argument("--steps", type=int, help="of training, instead of seconds")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--out", help="where a table that the network makes goes, a .npy")
    arguments = parser.parse_args()

    # More threads would wait for each other: the network is small.
    torch.set_num_threads(1)
    torch.manual_seed(arguments.seed)
    network = Network(dims=2)
    steps = train(network, arguments.size, arguments.seconds, arguments.steps, arguments.seed)
    print(f"{steps} steps, {sum(weights.numel() for weights in network.parameters())} weights")
    integrands = fsot.metrics.Integrands.random(2, seed=2**40)
    print(f"{'of white noise:':24} filtered error  one pixel   bias")
    for size in (arguments.size, 2 * arguments.size):
        tables = judge(network, size, arguments.seed, min(1.0, arguments.seconds))
        for name, table in tables.items():
            error = fsot.metrics.filtered_error(table, integrands=integrands)
            bias = fsot.metrics.bias(table, integrands=integrands).table.mean
            figures = f"{error.spatial.mean:14.3f} {error.unfiltered.mean:10.3f} {bias:6.3f}"
            print(f"{size} x {size}, {name:14} {figures}")
        if arguments.out and size == arguments.size:
            tables["network"].save(arguments.out)


if __name__ == "__main__":
    main()
