"""The objective as a loss for JAX."""

import importlib

import numpy
import pytest

import fsot

jax = pytest.importorskip("jax")
import jax.numpy as jnp  # noqa: E402
from jax.test_util import check_grads  # noqa: E402

import fsot.jax  # noqa: E402
from fsot.jax import filtered_sliced_loss  # noqa: E402

OBJECTIVE = fsot.Objective(fsot.Config(4, 4))
SLICES = OBJECTIVE.draw(1, steps=2)
KINDS = pytest.mark.parametrize("slices", [SLICES, "all", None], ids=["slices", "all", "drawn"])


def enable_x64(enabled):
    """Under its name of today, or its older one."""
    if hasattr(jax, "enable_x64"):
        return jax.enable_x64(enabled)
    return importlib.import_module("jax.experimental").enable_x64(enabled)


@pytest.fixture(params=[False, True], ids=["float32", "float64"])
def double(request):
    with enable_x64(request.param):
        yield request.param


def noise(*shape, seed=0):
    return jnp.asarray(0.05 + 0.9 * numpy.random.default_rng(seed).random(shape))


def loss_of(slices):
    return lambda at: filtered_sliced_loss(at, OBJECTIVE, slices)


@KINDS
class TestGradients:
    def test_it_is_the_objective_s(self, slices, double):
        points = noise(16, 2)
        value, gradient = jax.value_and_grad(loss_of(slices))(points)
        if slices == "all":
            expected = OBJECTIVE.cramer(numpy.asarray(points))
        else:
            expected = OBJECTIVE.value_and_gradient(numpy.asarray(points), slices or OBJECTIVE.draw())
        assert value.dtype == gradient.dtype == points.dtype == (jnp.float64 if double else jnp.float32)
        few = 10 * float(jnp.finfo(points.dtype).eps)
        assert float(value) == pytest.approx(expected[0], rel=few)
        assert numpy.asarray(gradient) == pytest.approx(expected[1], rel=few)

    def test_compiled_it_is_the_same(self, slices, double):
        points = noise(4, 4, 2)
        ask = jax.value_and_grad(loss_of(slices))
        alone, compiled = ask(points), jax.jit(ask)(points)
        assert alone[0] == compiled[0] and jnp.array_equal(alone[1], compiled[1])

    def test_gradients_are_those_of_differences(self, slices):
        with enable_x64(True):
            check_grads(loss_of(slices), (noise(16, 2),), 1, modes=["rev"], atol=1e-7, rtol=1e-4, eps=1e-6)

    def test_several_are_mapped_one_after_the_other(self, slices, double):
        several = jnp.stack([noise(16, 2, seed=seed) for seed in range(3)])
        ask = jax.grad(loss_of(slices))
        one_by_one = jnp.stack([ask(points) for points in several])
        assert jnp.array_equal(jax.vmap(ask)(several), one_by_one)
        assert jnp.array_equal(jax.jit(jax.vmap(ask))(several), one_by_one)

    def test_a_second_derivative_is_refused_in_words(self, slices):
        points = noise(16, 2)
        for ask in (
            jax.hessian(loss_of(slices)),
            jax.jit(jax.hessian(loss_of(slices))),
            jax.grad(lambda at: jax.grad(loss_of(slices))(at).sum()),
        ):
            with pytest.raises(TypeError, match="can be differentiated once.*use first derivatives alone"):
                ask(points)

    def test_the_chain_goes_on(self, slices):
        points = noise(16, 2)
        ask = jax.grad(lambda at: 3 * loss_of(slices)(at**2))
        expected = 6 * points * jax.grad(loss_of(slices))(points**2)
        assert numpy.asarray(ask(points)) == pytest.approx(numpy.asarray(expected), rel=1e-5)


class TestArguments:
    def test_steps_may_be_traced(self):
        """A compiled step of a descent takes other slices each time."""
        points, traces = noise(16, 2), []

        @jax.jit
        def ask(points, step):
            traces.append(step)
            return filtered_sliced_loss(points, OBJECTIVE, seed=3, step=step)

        for step in range(4):
            expected = filtered_sliced_loss(points, OBJECTIVE, OBJECTIVE.draw(3, step))
            assert ask(points, step) == expected
        assert len(traces) == 1
        several = jax.vmap(lambda step: filtered_sliced_loss(points, OBJECTIVE, step=step))(jnp.arange(3))
        assert [float(one) for one in several] == [
            float(filtered_sliced_loss(points, OBJECTIVE, step=step)) for step in range(3)
        ]
        slope = jax.grad(lambda at: filtered_sliced_loss(at, OBJECTIVE, step=jnp.asarray(1)))(points)
        assert slope.shape == (16, 2)

    def test_large_seeds_are_python_s(self):
        points = noise(16, 2)
        expected = filtered_sliced_loss(points, OBJECTIVE, OBJECTIVE.draw(2**64 - 1, 2**40))

        def ask(at):
            return filtered_sliced_loss(at, OBJECTIVE, seed=2**64 - 1, step=2**40)

        assert ask(points) == jax.jit(ask)(points) == expected

    @pytest.mark.parametrize(
        "arguments, error, sentence",
        [
            ({"points": jnp.zeros((16, 2), jnp.float16)}, TypeError, "float16: give float32 or float64"),
            ({"points": jnp.zeros((16, 2), jnp.bfloat16)}, TypeError, "bfloat16: give float32 or float64"),
            ({"points": jnp.zeros((16, 2), int)}, TypeError, "int32: give float32 or float64"),
            ({"points": jnp.ones((16, 2))}, ValueError, r"as by clamping to \[0, fsot.BELOW_ONE\]: sigmoids"),
            ({"points": jnp.full((16, 2), jnp.nan)}, ValueError, r"is NaN: give finite values in .*\)(\n|$)"),
            ({"points": jnp.zeros((2, 16))}, ValueError, r"points of shape \[2, 16\]"),
            ({"objective": fsot.Config(4, 4)}, TypeError, "is no objective"),
            ({"slices": "some"}, ValueError, "'some' are no slices"),
            ({"slices": SLICES, "step": 1}, ValueError, "leave out seed and step"),
            ({"seed": -1}, ValueError, "give a whole number from 0"),
            ({"step": 0.5}, TypeError, "integer"),
            ({"step": jnp.asarray(0.5)}, TypeError, "step is 0.5: give a whole number"),
        ],
    )
    def test_others_are_refused(self, arguments, error, sentence):
        given = {"points": noise(16, 2), "objective": OBJECTIVE, "slices": None} | arguments
        with pytest.raises(error, match=sentence):
            filtered_sliced_loss(**given)
        if error is ValueError and "points" in arguments:
            with pytest.raises(error, match=sentence):
                jax.grad(lambda at: filtered_sliced_loss(at, OBJECTIVE))(given["points"])

    def test_a_compiled_function_says_what_is_wrong_with_its_points(self):
        with pytest.raises(Exception, match="as by clamping"):
            jax.block_until_ready(jax.jit(loss_of("all"))(jnp.ones((16, 2))))


def test_a_compiled_descent_comes_near_what_fsot_makes():
    config = fsot.Config(8, 8)
    objective = fsot.Objective(config)

    @jax.jit
    def step(points):
        gradient = jax.grad(lambda at: filtered_sliced_loss(at, objective, "all"))(points)
        return jnp.clip(points - 2 * gradient, 0, fsot.BELOW_ONE)

    points = noise(*objective.shape)
    before = objective.cramer(numpy.asarray(points))[0]
    for _ in range(200):
        points = step(points)
    assert objective.cramer(numpy.asarray(points))[0] < 0.4 * before


def test_large_points_are_no_deadlock():
    """Callbacks that wait for large arrays on the thread that makes them would."""
    objective = fsot.Objective(fsot.Config(64, 64, 4), threads=2)
    step = jax.jit(lambda points: jax.grad(lambda at: filtered_sliced_loss(at, objective))(points))
    points = noise(*objective.shape)
    for _ in range(4):
        points = jnp.clip(points - 1000 * step(points), 0, fsot.BELOW_ONE)
    assert jnp.isfinite(points).all()
