"""Demands: what counts, and what is left alone."""

import pickle

import numpy
import pytest

import fsot


def test_what_is_not_demanded_keeps_its_bits():
    pixels = numpy.zeros((16, 16), bool)
    pixels[:, :8] = True
    demand = fsot.Demand(pixels, [[0, 1]])
    config = fsot.Config(16, 16, dims=4, seed=3)
    optimizer = fsot.Optimizer(config, demand=demand)
    before = optimizer.points
    optimizer.run(fsot.Until.sweeps(4), progress=False)
    after = optimizer.points
    assert numpy.array_equal(before[:, :, 8:], after[:, :, 8:])
    assert numpy.array_equal(before[..., 2:], after[..., 2:])
    assert (before[:, :, :8, :, :2] != after[:, :, :8, :, :2]).mean() > 0.99


def test_a_table_is_made_for_a_demand():
    demand = fsot.Demand(numpy.eye(8, dtype=bool))
    table = fsot.table(8, 8, demand=demand, sweeps=3, progress=False)
    optimizer = fsot.Optimizer(fsot.Config(8, 8), demand=demand)
    optimizer.run(fsot.Until.sweeps(3), progress=False)
    assert numpy.array_equal(table.array, optimizer.points)


def test_an_objective_sees_no_more_than_is_demanded():
    pixels = numpy.arange(64).reshape(8, 8) % 3 == 0
    objective = fsot.Objective(fsot.Config(8, 8, dims=3), fsot.Demand(pixels, [[0, 1]]))
    points = numpy.random.default_rng(0).random(objective.shape)
    for _, gradient in (
        objective.cramer(points),
        objective.value_and_gradient(points, objective.draw(steps=16)),
    ):
        assert not gradient[0, ~pixels].any() and not gradient[..., 2].any()
        assert gradient[0, pixels][..., :2].all()
    assert {tuple(term.dims) for term in objective.terms} <= {(0, 1), (0,), (1,)}


def test_a_demand_says_what_it_is():
    pixels = numpy.zeros((2, 3, 4), bool)
    pixels[0, 1] = True
    demand = fsot.Demand(pixels, [[0], [2, 1]])
    assert numpy.array_equal(demand.pixels, pixels) and demand.groups == [[0], [2, 1]]
    assert demand.share == 4 / 24
    assert pickle.loads(pickle.dumps(demand)) == demand != fsot.Demand(pixels)
    assert fsot.Demand(pixels[0].astype(float)) == fsot.Demand(pixels[:1])


@pytest.mark.parametrize(
    "make, sentence",
    [
        (lambda: fsot.Demand([True]), r"give the axes \[frame, y, x\] or \[y, x\]"),
        (lambda: fsot.Demand(True), r"give the axes"),
        (lambda: fsot.Demand(numpy.zeros((0, 3), bool)), "height is 0: give at least 1"),
        (lambda: fsot.Demand([[True]], [[]]), "group 0 of the demand: the dimension group is empty"),
        (lambda: fsot.Objective(fsot.Config(2, 2), fsot.Demand([[False]])), "nothing is demanded"),
        (lambda: fsot.Objective(fsot.Config(2, 2), fsot.Demand([[True]], [[5]])), "names dimension 5"),
        (lambda: fsot.Optimizer(fsot.Config(2, 2), demand=fsot.Demand([[True]], [[5]])), "dimension 5"),
    ],
)
def test_what_is_no_demand_is_refused(make, sentence):
    with pytest.raises(ValueError, match=sentence):
        make()
