"""A table that Adam makes, beside the one that fsot makes.

The loss is the filtered sliced distance of fsot, in closed form (``all``) or along random slices, and the
optimiser that of PyTorch: a recipe for whoever adds terms of their own to the loss.

    python adam_table.py --seconds 20 --out adam.npy
"""

from __future__ import annotations

import argparse
import time

import numpy
import torch

import fsot
import fsot.torch


def mean_slices(objective: fsot.Objective, points: numpy.ndarray, steps: int = 16) -> float:
    """The loss along slices that no optimiser has seen."""
    value, _ = objective.value_and_gradient(points, objective.draw(seed=2**40, steps=steps))
    return value


def optimise(objective: fsot.Objective, slices: str | None, seconds: float, seed: int) -> tuple[numpy.ndarray, int]:
    """Adam for so many seconds, from white noise, with a step size that falls by equal factors."""
    points = torch.from_numpy(numpy.random.default_rng(seed).random(objective.shape, dtype=numpy.float32))
    points.requires_grad_()
    adam = torch.optim.Adam([points], betas=(0.9, 0.99))
    begin, steps = time.perf_counter(), 0
    while (share := (time.perf_counter() - begin) / seconds) < 1:
        adam.param_groups[0]["lr"] = 0.03 * 0.02**share
        adam.zero_grad()
        step = None if slices else steps
        fsot.torch.filtered_sliced_loss(points, objective, slices, seed=None if slices else seed, step=step).backward()
        adam.step()
        with torch.no_grad():
            points.clamp_(0, fsot.BELOW_ONE)
        steps += 1
    return points.detach().numpy(), steps


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--size", type=int, default=32, help="pixels of a side")
    parser.add_argument("--seconds", type=float, default=20, help="of each way to make a table")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--out", help="where the table of all slices goes, a .npy")
    arguments = parser.parse_args()

    # Adam compromises where fsot balances: the terms that descend are all that the loss sees.
    config = fsot.Config(arguments.size, arguments.size, seed=arguments.seed)
    objective = fsot.Objective(config)
    noise = numpy.random.default_rng(arguments.seed).random(objective.shape, dtype=numpy.float32)
    everything, steps = optimise(objective, "all", arguments.seconds, arguments.seed)
    some, steps_of_some = optimise(objective, None, arguments.seconds, arguments.seed)
    optimizer = fsot.Optimizer(config)
    optimizer.run(fsot.Until.seconds(arguments.seconds), progress=False)

    print("                         cramer  slices  (of white noise)")
    of_noise = objective.cramer(noise)[0], mean_slices(objective, noise)
    for name, points in [
        (f"Adam, all, {steps} steps", everything),
        (f"Adam, slices, {steps_of_some}", some),
        ("fsot", optimizer.points),
    ]:
        found = objective.cramer(points)[0], mean_slices(objective, points)
        print(f"{name:24} {found[0] / of_noise[0]:.4f}  {found[1] / of_noise[1]:.4f}")
    if arguments.out:
        fsot.Table(everything).save(arguments.out)


if __name__ == "__main__":
    main()
