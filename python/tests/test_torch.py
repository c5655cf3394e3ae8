"""The objective as a loss for PyTorch."""

import threading

import numpy
import pytest

import fsot

torch = pytest.importorskip("torch")
import fsot.torch  # noqa: E402
from fsot.torch import filtered_sliced_loss  # noqa: E402

OBJECTIVE = fsot.Objective(fsot.Config(4, 4))
SLICES = OBJECTIVE.draw(1, steps=2)
TORUS = fsot.Objective(fsot.Config(4, 4).with_domain("torus"))


def noise(*shape, dtype=torch.float64, seed=0):
    """Away from the faces, where a difference would leave the cube."""
    generator = torch.Generator().manual_seed(seed)
    return 0.05 + 0.9 * torch.rand(*shape, dtype=dtype, generator=generator)


@pytest.mark.parametrize("slices", [SLICES, "all", None], ids=["slices", "all", "drawn"])
class TestGradients:
    @pytest.mark.parametrize(
        "config",
        [
            fsot.Config(4, 4),
            fsot.Config(5, 3, dims=1),
            fsot.Config(3, 3, 2, 2, 3).with_form("weighted"),
        ],
        ids=["square", "line", "cube"],
    )
    def test_gradcheck_passes(self, slices, config):
        objective = fsot.Objective(config)
        if isinstance(slices, fsot.Slices):
            slices = objective.draw(1, steps=2)
        points = noise(*objective.shape).requires_grad_()
        # The defaults of gradcheck, but for the absolute part, which is above these gradients.
        assert torch.autograd.gradcheck(
            lambda at: filtered_sliced_loss(at, objective, slices), points, atol=1e-7, rtol=1e-4
        )

    @pytest.mark.parametrize("dtype", [torch.float32, torch.float64])
    def test_it_is_the_objective_s(self, slices, dtype):
        points = noise(16, 2, dtype=dtype).requires_grad_()
        loss = filtered_sliced_loss(points, OBJECTIVE, slices)
        (3 * loss).backward()
        if slices == "all":
            value, gradient = OBJECTIVE.cramer(points.detach().numpy())
        else:
            drawn = slices or OBJECTIVE.draw()
            value, gradient = OBJECTIVE.value_and_gradient(points.detach().numpy(), drawn)
        assert loss.dtype == points.grad.dtype == dtype and loss.shape == ()
        few = 10 * torch.finfo(dtype).eps
        assert loss.item() == pytest.approx(value, rel=few)
        assert points.grad.numpy() == pytest.approx(3 * gradient, rel=few)

    def test_a_second_derivative_is_refused_in_words(self, slices):
        points = noise(16, 2).requires_grad_()
        loss = filtered_sliced_loss(points, OBJECTIVE, slices)
        (slope,) = torch.autograd.grad(loss, points, create_graph=True)
        with pytest.raises(RuntimeError, match="can be differentiated once.*use first derivatives alone"):
            slope.square().sum().backward()
        with pytest.raises(RuntimeError, match="can be differentiated once"):
            torch.autograd.functional.hessian(
                lambda at: filtered_sliced_loss(at, OBJECTIVE, slices), noise(16, 2)
            )

    def test_nothing_is_remembered_where_nothing_is_asked(self, slices):
        points = noise(16, 2)
        assert not filtered_sliced_loss(points, OBJECTIVE, slices).requires_grad
        with torch.no_grad():
            assert not filtered_sliced_loss(points.requires_grad_(), OBJECTIVE, slices).requires_grad

    def test_strides_do_not_count(self, slices):
        straight = noise(16, 2).requires_grad_()
        turned = straight.detach().T.contiguous().T.requires_grad_()
        assert not turned.is_contiguous()
        losses = [filtered_sliced_loss(points, OBJECTIVE, slices) for points in (straight, turned)]
        for loss in losses:
            loss.backward()
        assert losses[0] == losses[1] and torch.equal(straight.grad, turned.grad)

    def test_functions_of_torch_s_take_it(self, slices):
        def loss(at):
            return filtered_sliced_loss(at, OBJECTIVE, slices)

        several = noise(3, 16, 2)
        one_by_one = torch.stack([torch.func.grad(loss)(points) for points in several])
        assert torch.equal(torch.func.vmap(loss)(several), torch.stack([loss(points) for points in several]))
        assert torch.equal(torch.func.vmap(torch.func.grad(loss))(several), one_by_one)
        leaves = several.requires_grad_()
        torch.func.vmap(loss)(leaves).sum().backward()
        assert torch.equal(leaves.grad, one_by_one)


class TestArguments:
    def test_seed_and_step_name_the_slices(self):
        points = noise(16, 2)
        for seed, step in [(0, 0), (3, 1), (2**63, 2**64 - 1)]:
            drawn = filtered_sliced_loss(points, OBJECTIVE, seed=seed, step=step)
            assert drawn == filtered_sliced_loss(points, OBJECTIVE, OBJECTIVE.draw(seed, step))
        assert filtered_sliced_loss(points, OBJECTIVE) != filtered_sliced_loss(points, OBJECTIVE, step=1)

    @pytest.mark.parametrize(
        "arguments, error, sentence",
        [
            ({"points": noise(16, 2).half()}, TypeError, "float16: give float32 or float64, as by"),
            ({"points": noise(16, 2).bfloat16()}, TypeError, "bfloat16: give float32 or float64"),
            ({"points": torch.zeros(16, 2, dtype=torch.int64)}, TypeError, "int64: give float32 or float64"),
            ({"points": torch.zeros(16, 2, dtype=torch.complex64)}, TypeError, "complex64: give float32"),
            ({"points": noise(16, 2).to_sparse()}, TypeError, "give dense ones"),
            ({"points": noise(16, 2).to("meta")}, TypeError, "have no values"),
            ({"points": numpy.zeros((16, 2))}, TypeError, "give a tensor, as by torch.as_tensor"),
            ({"points": torch.ones(16, 2)}, ValueError, r"as by clamping to \[0, fsot.BELOW_ONE\]: sigmoids"),
            ({"points": torch.full((16, 2), -1e-6)}, ValueError, "as by clamping"),
            ({"points": torch.full((16, 2), torch.nan)}, ValueError, r"is NaN: give finite values in .*\)$"),
            ({"points": noise(2, 16)}, ValueError, r"points of shape \[2, 16\]"),
            ({"points": noise(0, 2)}, ValueError, r"points of shape \[0, 2\]"),
            ({"objective": fsot.Config(4, 4)}, TypeError, r"is no objective: give fsot.Objective\(config\)"),
            ({"slices": "some"}, ValueError, "'some' are no slices"),
            ({"slices": [1]}, TypeError, "are no slices: give those of"),
            ({"slices": fsot.Objective(fsot.Config(4, 4, dims=3)).draw()}, ValueError, "of another"),
            ({"slices": SLICES, "seed": 0}, ValueError, "leave out seed and step"),
            ({"seed": -1}, ValueError, "give a whole number from 0"),
            ({"step": 0.5}, TypeError, "whole number|integer"),
            ({"objective": TORUS, "slices": "all"}, ValueError, "give slices"),
        ],
    )
    def test_others_are_refused(self, arguments, error, sentence):
        with pytest.raises(error, match=sentence):
            filtered_sliced_loss(**({"points": noise(16, 2), "objective": OBJECTIVE} | arguments))

    def test_a_sigmoid_that_rounds_to_one_is_clamped_as_it_says(self):
        points = torch.sigmoid(torch.full((16, 2), 40.0))
        assert points.max() == 1
        assert filtered_sliced_loss(points.clamp(0, fsot.BELOW_ONE), OBJECTIVE, "all") > 0

    def test_the_points_of_a_table(self):
        table = fsot.table(4, 4, sweeps=3, progress=False)
        points = torch.tensor(table.array)
        assert filtered_sliced_loss(points, OBJECTIVE, "all").item() == pytest.approx(
            OBJECTIVE.cramer(table.array)[0], rel=1e-6
        )


def test_adam_comes_near_what_fsot_makes():
    config = fsot.Config(8, 8)
    objective = fsot.Objective(config)
    points = noise(*objective.shape, dtype=torch.float32).requires_grad_()
    of_noise = objective.cramer(points.detach().numpy())[0]
    adam = torch.optim.Adam([points], lr=0.02)
    for _ in range(60):
        adam.zero_grad()
        filtered_sliced_loss(points, objective, "all").backward()
        adam.step()
        with torch.no_grad():
            points.clamp_(0, fsot.BELOW_ONE)
    of_adam = objective.cramer(points.detach().numpy())[0]
    optimizer = fsot.Optimizer(config)
    optimizer.run(fsot.Until.sweeps(60), progress=False)
    of_fsot = objective.cramer(optimizer.points)[0]
    assert of_adam < 0.4 * of_noise
    assert of_adam < 1.6 * of_fsot


def test_several_threads_differentiate_at_once():
    alone, together = [], [None] * 6
    for seed in range(6):
        points = noise(16, 2, seed=seed).requires_grad_()
        filtered_sliced_loss(points, OBJECTIVE, "all").backward()
        alone.append(points.grad)

    def ask(seed):
        points = noise(16, 2, seed=seed).requires_grad_()
        filtered_sliced_loss(points, OBJECTIVE, "all").backward()
        together[seed] = points.grad

    threads = [threading.Thread(target=ask, args=(seed,)) for seed in range(6)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(60)
    assert all(torch.equal(*pair) for pair in zip(alone, together, strict=True))


class TestLimits:
    @pytest.mark.parametrize("in_dim", [0, 1])
    def test_a_batch_of_none_has_no_losses(self, in_dim):
        none = torch.zeros((0, 16, 2) if in_dim == 0 else (16, 0, 2))

        def loss(points):
            return filtered_sliced_loss(points, OBJECTIVE, SLICES)

        assert torch.func.vmap(loss, in_dims=in_dim)(none).shape == (0,)
        slopes = torch.func.vmap(torch.func.grad(loss), in_dims=in_dim)(none)
        assert slopes.shape == (0, 16, 2) and slopes.dtype == torch.float32

    @pytest.mark.parametrize("of", [torch.func.jacfwd, torch.func.hessian])
    def test_forward_mode_is_refused_in_words(self, of):
        with pytest.raises(RuntimeError, match="backwards alone, not in forward mode: use"):
            of(lambda points: filtered_sliced_loss(points, OBJECTIVE, SLICES))(noise(16, 2))

    def test_forward_mode_of_the_gradient_is_refused_in_words(self):
        def gradient(points):
            return torch.func.grad(lambda points: filtered_sliced_loss(points, OBJECTIVE, SLICES))(points)

        with pytest.raises(RuntimeError, match="differentiated once"):
            torch.func.jvp(gradient, (noise(16, 2),), (noise(16, 2),))
