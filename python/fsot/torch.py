"""The objective as a loss for PyTorch.

>>> import torch
>>> import fsot.torch
>>> objective = fsot.Objective(fsot.Config(16, 16))
>>> points = torch.rand(256, 2, requires_grad=True)
>>> loss = fsot.torch.filtered_sliced_loss(points, objective, "all")
>>> loss.backward()
>>> points.grad.shape
torch.Size([256, 2])
"""

from __future__ import annotations

from typing import Any

from . import _fsot
from ._loss import ONCE, Slices, check, evaluate

try:
    import torch
except ImportError as error:  # pragma: no cover
    raise ImportError("fsot.torch needs PyTorch: pip install torch") from error

BACKWARDS = (
    "the filtered sliced loss can be differentiated once and backwards alone, not in forward mode: use "
    "backward(), torch.func.grad or torch.func.jacrev, and finite differences of the gradient for a Hessian"
)

__all__ = ["Slices", "filtered_sliced_loss"]


def filtered_sliced_loss(
    points: torch.Tensor,
    objective: _fsot.Objective,
    slices: Slices = None,
    *,
    seed: int | None = None,
    step: int | None = None,
) -> torch.Tensor:
    """How far filtered samples are from their targets, differentiable once with respect to the points.

    It is computed on the CPU, in float64, without Python's lock. Tensors elsewhere, as on CUDA, are copied
    there, and their gradient back.

    Parameters
    ----------
    points : torch.Tensor
        Numbers in [0, 1) of dtype float32 or float64, in the shape of the table, as [sample, dim], or flat;
        axes of length 1 may be left out. What a sigmoid or a remainder gives may round to 1.0: clamp it to
        ``[0, fsot.BELOW_ONE]``.
    objective : Objective
        What is optimised.
    slices : Slices or "all", optional
        Slices of the objective, or all of them at once in closed form, where there is one
        (`Objective.cramer`). By default those of ``objective.draw(seed, step)``: count `step` in a loop of
        stochastic gradient descent.
    seed, step : int, optional
        Name the random slices; 0 by default.

    Returns
    -------
    torch.Tensor
        A scalar of the dtype and on the device of `points`. Its gradient is 1 / N of a sample's own: steps of
        plain gradient descent are in the order of the number of samples; Adam needs no such thing.

    Raises
    ------
    TypeError
        Points of another dtype.
    ValueError
        Points outside [0, 1), or of another shape; slices of another objective; "all" without a closed form.
    RuntimeError
        From a second derivative, and from forward-mode ones, as `torch.func.jacfwd` and `hessian` take.
    """
    check(objective, slices, seed, step)
    if not isinstance(points, torch.Tensor):
        raise TypeError(f"points are a {type(points).__name__}: give a tensor, as by torch.as_tensor(points)")
    if points.dtype not in (torch.float32, torch.float64):
        raise TypeError(f"points of dtype {points.dtype}: give float32 or float64, as by points.float()")
    if points.layout != torch.strided:
        raise TypeError(f"points of layout {points.layout}: give dense ones, as by points.to_dense()")
    if points.device.type == "meta":
        raise TypeError("points on the device meta have no values: give some that do")
    loss, _ = _Loss.apply(points, objective, slices, seed or 0, step or 0)
    return loss


class _Loss(torch.autograd.Function):
    """Value, and the gradient for the backward pass, which nobody else sees."""

    @staticmethod
    def forward(
        points: torch.Tensor, objective: _fsot.Objective, slices: Slices, seed: int, step: int
    ) -> tuple[torch.Tensor, torch.Tensor]:
        values = points.detach().resolve_neg().cpu().numpy()
        value, gradient = evaluate(values, objective, slices, seed, step)
        # The dtype first: not every device has float64.
        slopes = torch.from_numpy(gradient).to(points.dtype).to(points.device)
        return torch.tensor(value, dtype=points.dtype, device=points.device), slopes

    @staticmethod
    def setup_context(ctx: Any, inputs: tuple[Any, ...], output: tuple[torch.Tensor, torch.Tensor]) -> None:
        _, slopes = output
        ctx.mark_non_differentiable(slopes)
        ctx.save_for_backward(inputs[0], slopes)

    @staticmethod
    def vmap(info: Any, in_dims: tuple[int | None, ...], points: torch.Tensor, *rest: Any) -> Any:
        """One after the other."""
        assert in_dims[0] is not None
        if points.shape[in_dims[0]] == 0:
            return (points.new_zeros(0), torch.zeros_like(points.movedim(in_dims[0], 0))), (0, 0)
        found = [_Loss.apply(one, *rest) for one in points.unbind(in_dims[0])]
        losses, slopes = zip(*found, strict=True)
        return (torch.stack(losses), torch.stack(slopes)), (0, 0)

    @staticmethod
    def backward(ctx: Any, of_loss: torch.Tensor, _: torch.Tensor) -> tuple[Any, ...]:
        points, slopes = ctx.saved_tensors
        return _Slope.apply(points, slopes, of_loss), None, None, None, None

    @staticmethod
    def jvp(ctx: Any, *_: Any) -> Any:
        raise RuntimeError(BACKWARDS)


class _Slope(torch.autograd.Function):
    """The gradient, of which there is no further one."""

    @staticmethod
    def forward(
        points: torch.Tensor, slopes: torch.Tensor, of_loss: torch.Tensor
    ) -> torch.Tensor:
        return of_loss * slopes

    @staticmethod
    def setup_context(ctx: Any, inputs: tuple[Any, ...], output: torch.Tensor) -> None:
        pass

    @staticmethod
    def vmap(info: Any, in_dims: tuple[int | None, ...], *of: torch.Tensor) -> Any:
        """All at once. The rule that torch generates takes no batch of 0."""
        points, slopes, of_loss = (
            one.unsqueeze(0) if dim is None else one.movedim(dim, 0) for one, dim in zip(of, in_dims, strict=True)
        )
        return _Slope.apply(points, slopes, of_loss.reshape(-1, *(slopes.dim() - 1) * [1])), 0

    @staticmethod
    def backward(ctx: Any, _: torch.Tensor) -> tuple[Any, ...]:
        raise RuntimeError(ONCE.format("torch"))

    @staticmethod
    def jvp(ctx: Any, *_: Any) -> Any:
        raise RuntimeError(ONCE.format("torch"))
