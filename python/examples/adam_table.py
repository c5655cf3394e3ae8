"""A table that Adam makes, beside the one that fsot makes.

The loss is the filtered sliced distance of fsot, all slices at once or along random ones, and the optimiser
that of PyTorch: a recipe for whoever adds terms of their own to the loss. It lacks what fsot's optimiser
balances after each step, the table as a whole, which the column of the bias shows.

    python adam_table.py --seconds 20 --out adam.npy
"""

from __future__ import annotations

import argparse
import time

import numpy
import torch
from numpy.typing import NDArray

import fsot
import fsot.metrics
import fsot.torch
from fsot.torch import Slices


def optimise(
    objective: fsot.Objective, closed: bool, seconds: float, most: int | None, seed: int
) -> tuple[NDArray[numpy.float32], int]:
    """Adam for so many seconds, or steps, from white noise, with a step size that falls by equal factors."""
    points = torch.from_numpy(white_noise(objective, seed)).requires_grad_()
    adam = torch.optim.Adam([points], betas=(0.9, 0.99))
    begin, step = time.perf_counter(), 0
    while (share := step / most if most else (time.perf_counter() - begin) / seconds) < 1:
        adam.param_groups[0]["lr"] = 0.03 * 0.02**share
        slices: Slices = "all" if closed else objective.draw(seed, step)
        adam.zero_grad()
        torch.autograd.backward(fsot.torch.filtered_sliced_loss(points, objective, slices))
        adam.step()
        with torch.no_grad():
            points.clamp_(0, fsot.BELOW_ONE)
        step += 1
    return points.detach().numpy(), step


def white_noise(objective: fsot.Objective, seed: int) -> NDArray[numpy.float32]:
    return numpy.random.default_rng(seed).random(objective.shape, dtype=numpy.float32)


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--size", type=int, default=32, help="pixels of a side")
    parser.add_argument("--seconds", type=float, default=20, help="of each way to make a table")
    parser.add_argument("--steps", type=int, help="of Adam, and sweeps of fsot, instead of seconds")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--out", help="where Adam's table of all slices goes, a .npy")
    arguments = parser.parse_args()

    config = fsot.Config(arguments.size, arguments.size, seed=arguments.seed)
    objective = fsot.Objective(config)
    length = arguments.seconds, arguments.steps, arguments.seed
    everything, steps = optimise(objective, True, *length)
    some, steps_of_some = optimise(objective, False, *length)
    optimizer = fsot.Optimizer(config)
    until = fsot.Until.sweeps(arguments.steps) if arguments.steps else fsot.Until.seconds(arguments.seconds)
    optimizer.run(until, progress=False)

    # Slices that nobody has optimised along.
    fresh = objective.draw(seed=2**40, steps=32)
    integrands = fsot.metrics.Integrands.random(2, seed=2**40)
    found = {}
    for name, points in {
        "white noise": white_noise(objective, 2**40),
        f"Adam, all slices, {steps} steps": everything,
        f"Adam, some slices, {steps_of_some} steps": some,
        "fsot": optimizer.points,
    }.items():
        found[name] = (
            fsot.metrics.filtered_error(points, integrands=integrands, kernel=config.kernels[0]).spatial.mean,
            objective.cramer(points)[0],
            objective.value_and_gradient(points, fresh)[0],
            fsot.metrics.bias(points, integrands=integrands).table.mean,
        )
    of_noise = found["white noise"]
    print(f"{'of white noise:':36} filtered error  all slices  some slices   bias")
    for name, figures in found.items():
        error, all_slices, some_slices, bias = figures
        all_slices, some_slices = all_slices / of_noise[1], some_slices / of_noise[2]
        print(f"{name:36} {error:14.3f} {all_slices:11.3f} {some_slices:12.3f} {bias:6.3f}")
    if arguments.out:
        fsot.Table(everything).save(arguments.out)


if __name__ == "__main__":
    main()
