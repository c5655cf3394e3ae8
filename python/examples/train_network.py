"""A small network learns to turn white noise into a table whose error is blue noise.

It is a convolution over pixels that wraps, trained through the filtered sliced loss on new white noise in every
step, so that it cannot remember a table: it is judged on noise that it has not seen, and on a larger table.

    python train_network.py --seconds 100 --out network.npy
"""

from __future__ import annotations

import argparse
import time

import numpy
import torch
from torch import nn

import fsot
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


def train(network: Network, size: int, seconds: float, seed: int, batch: int = 2) -> int:
    """Adam for so many seconds; returns how many steps that were."""
    objective = fsot.Objective(fsot.Config(size, size, seed=seed))
    generator = torch.Generator().manual_seed(seed)
    adam = torch.optim.Adam(network.parameters())
    begin, step = time.perf_counter(), 0
    while (share := (time.perf_counter() - begin) / seconds) < 1:
        adam.param_groups[0]["lr"] = 0.003 * 0.03**share
        noise = torch.rand(batch, 2, size, size, generator=generator)
        points = points_of(network(noise))
        slices = objective.draw(seed, step)
        loss = sum(fsot.torch.filtered_sliced_loss(one, objective, slices) for one in points) / batch
        adam.zero_grad()
        loss.backward()
        adam.step()
        step += 1
    return step


def filtered_error(objective: fsot.Objective, points: numpy.ndarray) -> float:
    """Squared error of edges after the filter: all of them at once, in closed form."""
    return objective.cramer(points)[0]


def judge(network: Network, size: int, seed: int, seconds: float) -> dict[str, float]:
    """Filtered errors, of white noise, of the network, and of fsot, and how far noise is moved."""
    config = fsot.Config(size, size, seed=seed)
    objective = fsot.Objective(config)
    noise = torch.rand(1, 2, size, size, generator=torch.Generator().manual_seed(2**40 + seed))
    with torch.no_grad():
        made = points_of(network(noise))
    optimizer = fsot.Optimizer(config)
    optimizer.run(fsot.Until.seconds(seconds), progress=False)
    before, after = filtered_error(objective, points_of(noise).numpy()), filtered_error(objective, made.numpy())
    return {
        "network": after / before,
        "fsot": filtered_error(objective, optimizer.points) / before,
        "moved": float((made - points_of(noise)).square().mean().sqrt()),
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--size", type=int, default=32, help="pixels of a side, in training")
    parser.add_argument("--seconds", type=float, default=100, help="of training")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--out", help="where a table that the network makes goes, a .npy")
    arguments = parser.parse_args()

    # More threads would wait for each other: the network is small.
    torch.set_num_threads(1)
    torch.manual_seed(arguments.seed)
    network = Network(dims=2)
    steps = train(network, arguments.size, arguments.seconds, arguments.seed)
    print(f"{steps} steps, {sum(weights.numel() for weights in network.parameters())} weights")
    print("filtered squared error of edges, of white noise's:")
    for size in (arguments.size, 2 * arguments.size):
        found = judge(network, size, arguments.seed, min(1.0, arguments.seconds))
        print(
            f"{size} x {size}, new noise: network {found['network']:.3f}, fsot in a second {found['fsot']:.3f}; "
            f"a number moved by {found['moved']:.3f}"
        )
    if arguments.out:
        noise = torch.rand(1, 2, arguments.size, arguments.size)
        with torch.no_grad():
            made = points_of(network(noise)).numpy()
        fsot.Table(made[:, :, :, None, :]).save(arguments.out)


if __name__ == "__main__":
    main()
