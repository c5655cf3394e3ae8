"""The objective as a loss for JAX.

>>> import jax
>>> import fsot.jax
>>> objective = fsot.Objective(fsot.Config(16, 16))
>>> points = jax.random.uniform(jax.random.key(0), (256, 2))
>>> jax.grad(lambda points: fsot.jax.filtered_sliced_loss(points, objective, "all"))(points).shape
(256, 2)
"""

from __future__ import annotations

import functools
import operator
from typing import Any

import numpy

from . import _fsot
from ._loss import ONCE, Slices, check, evaluate

try:
    import jax
    import jax.numpy as jnp
except ImportError as error:  # pragma: no cover
    raise ImportError("fsot.jax needs JAX: pip install jax") from error

__all__ = ["Slices", "filtered_sliced_loss"]


def filtered_sliced_loss(
    points: jax.Array,
    objective: _fsot.Objective,
    slices: Slices = None,
    *,
    seed: int | jax.Array | None = None,
    step: int | jax.Array | None = None,
) -> jax.Array:
    """How far filtered samples are from their targets, differentiable once with respect to the points.

    It is computed on the CPU, in float64, without Python's lock; under `jax.jit` by way of
    `jax.pure_callback`, and under `jax.vmap` one after the other.

    Parameters
    ----------
    points : jax.Array
        Numbers in [0, 1) of dtype float32 or float64, in the shape of the table, as [sample, dim], or flat;
        axes of length 1 may be left out. What a sigmoid or a remainder gives may round to 1.0: clip it to
        ``[0, fsot.BELOW_ONE]``.
    objective : Objective
        What is optimised. Under `jax.jit` it belongs to the function, not to its arguments.
    slices : Slices or "all", optional
        Slices of the objective, or all of them at once in closed form, where there is one
        (`Objective.cramer`). By default those of ``objective.draw(seed, step)``.
    seed, step : int, optional
        Name the random slices; 0 by default. They may be traced, so that a compiled step of stochastic
        gradient descent takes other slices each time.

    Returns
    -------
    jax.Array
        A scalar of the dtype of `points`. Its gradient is 1 / N of a sample's own: steps of plain gradient
        descent are in the order of the number of samples; Adam needs no such thing.

    Raises
    ------
    TypeError
        Points of another dtype; a second derivative.
    ValueError
        Points outside [0, 1), or of another shape; slices of another objective; "all" without a closed form.
        Where a compiled function finds out about the points, it is an error of JAX's that says so.
    """
    check(objective, slices, seed, step)
    points = jnp.asarray(points)
    if points.dtype not in (jnp.float32, jnp.float64):
        raise TypeError(
            f"points of dtype {points.dtype}: give float32 or float64, as by points.astype('float32')"
        )
    # Numbers of Python's belong to the function, since JAX's may end at 2**31; those of JAX's are traced.
    names: dict[str, int] = {"seed": 0, "step": 0}
    traced: dict[str, jax.Array] = {}
    for name, number in (("seed", seed), ("step", step)):
        if isinstance(number, jax.Array):
            if number.ndim > 0 or not jnp.issubdtype(number.dtype, jnp.integer):
                raise TypeError(f"{name} is {number}: give a whole number")
            traced[name] = number
        elif number is not None:
            names[name] = operator.index(number)
    return _loss(points, traced, functools.partial(_evaluate, objective, slices, names))


def _evaluate(
    objective: _fsot.Objective,
    slices: Slices,
    names: dict[str, int],
    points: Any,
    traced: dict[str, Any],
) -> tuple[Any, Any]:
    """Value and gradient of arrays that are there."""
    named = names | {name: int(number) for name, number in traced.items()}
    points = numpy.asarray(points)
    value, gradient = evaluate(points, objective, slices, **named)
    return numpy.asarray(value, points.dtype), gradient.astype(points.dtype)


@functools.partial(jax.custom_jvp, nondiff_argnums=(1, 2))
def _both(points: jax.Array, traced: dict[str, jax.Array], of: Any) -> tuple[jax.Array, jax.Array]:
    if not any(isinstance(value, jax.core.Tracer) for value in (points, *traced.values())):
        # Exceptions are then the caller's, and not wrapped into JAX's.
        value, gradient = of(points, traced)
        return jnp.asarray(value), jnp.asarray(gradient)
    shapes = jax.ShapeDtypeStruct((), points.dtype), jax.ShapeDtypeStruct(points.shape, points.dtype)
    return jax.pure_callback(of, shapes, points, traced, vmap_method="sequential")


@_both.defjvp
def _twice(*_: Any) -> Any:
    raise TypeError(ONCE.format("JAX"))


@functools.partial(jax.custom_vjp, nondiff_argnums=(2,))
def _loss(points: jax.Array, traced: dict[str, jax.Array], of: Any) -> jax.Array:
    return _both(points, traced, of)[0]


def _forward(points: jax.Array, traced: dict[str, jax.Array], of: Any) -> tuple[jax.Array, jax.Array]:
    return _both(points, traced, of)


def _backward(of: Any, gradient: jax.Array, of_loss: jax.Array) -> tuple[jax.Array, None]:
    return of_loss * gradient, None


_loss.defvjp(_forward, _backward)
