"""Classes, targets and terms."""

import pickle
import threading

import numpy
import pytest

import fsot


def moved(config, points, slices=256):
    """What a run makes of a configuration."""
    optimizer = fsot.Optimizer(config, threads=1)
    optimizer.run(fsot.Until.slices(slices), progress=False)
    return optimizer.points.reshape(points, -1)


def one(classes, target=None, dims=(0, 1), **rest):
    return fsot.Term(classes, target, dims=dims, **rest)


WHOLE = fsot.Classes.whole_table()


class TestClasses:
    @pytest.mark.parametrize(
        "classes, kind",
        [
            (fsot.Classes.lattice(fsot.Kernel.gaussian(1.5)), "lattice"),
            (fsot.Classes.lattice(fsot.Kernel.box_(3), "weighted"), "lattice"),
            (fsot.Classes.whole_table(), "whole_table"),
            (fsot.Classes.per_frame(), "per_frame"),
            (fsot.Classes.per_pixel(), "per_pixel"),
            (fsot.Classes.labelled(numpy.arange(16) % 2, [[0], [0, 1]], weights=[1, 2.5]), "labelled"),
            (fsot.Classes.ramps(numpy.linspace(0, 1, 16)), "ramps"),
            (fsot.Classes.prefixes("pixel", "every"), "prefixes"),
            (fsot.Classes.prefixes("table", [4, (16, 0.5)]), "prefixes"),
            (fsot.Classes.listed([[0, 1, 2], ([3, 4], [1.0, 0.25])], weights=[1, 2], name="mine"), "listed"),
        ],
    )
    def test_every_kind_survives_pickle(self, classes, kind):
        again = pickle.loads(pickle.dumps(classes))
        assert classes.kind == kind
        assert again == classes and again.kind == kind and repr(again) == repr(classes)
        assert again != fsot.Classes.lattice(fsot.Kernel.gaussian(9.0))

    def test_listed_classes_do_what_labels_do(self):
        labels = numpy.random.default_rng(0).integers(0, 3, 96)
        lists = [numpy.flatnonzero(labels == label) for label in range(3)]
        by_labels = fsot.Config.points(96, 2, [one(fsot.Classes.labelled(labels, [[0], [1], [2]]))])
        by_lists = fsot.Config.points(96, 2, [one(fsot.Classes.listed(lists))])
        assert numpy.array_equal(moved(by_labels, 96), moved(by_lists, 96))

    def test_weights_of_listed_classes_are_those_of_a_ramp(self):
        coordinates = numpy.linspace(0, 1, 64)
        lists = [(numpy.arange(64), coordinates), (numpy.arange(64), 1 - coordinates)]
        by_ramps = fsot.Config.points(64, 2, [one(fsot.Classes.ramps(coordinates))])
        by_lists = fsot.Config.points(64, 2, [one(fsot.Classes.listed(lists))])
        assert numpy.array_equal(moved(by_ramps, 64), moved(by_lists, 64))

    def test_a_class_of_a_weight_of_its_own_pulls_by_it(self):
        point = numpy.full((8, 2), 0.5)
        gradients = []
        for weight in (1.0, 3.0):
            term = one(fsot.Classes.listed([[0, 1], [2, 3]], weights=[1.0, weight]))
            objective = fsot.Objective(fsot.Config.points(8, 2, [term]))
            slices = fsot.Slices(objective, 0, [1], 0.0, [[0.6, 0.8]])
            gradients.append(objective.value_and_gradient(point, slices)[1])
        assert gradients[1] == pytest.approx(3 * gradients[0], rel=1e-12)
        assert not gradients[0][[0, 1, 4, 5, 6, 7]].any() and gradients[0][[2, 3]].any()

    @pytest.mark.parametrize(
        "make, sentence",
        [
            (lambda: fsot.Classes.listed([[0, 1], [2, 2]]), 'class 1 of "listed" lists sample 2 twice'),
            (lambda: fsot.Classes.listed([([0, 1], [1.0, 1.5])]), r"weight 1.5: give weights in \[0, 1\]"),
            (lambda: fsot.Classes.listed([([0, 1], [numpy.nan, 1])]), "sample 0 weight NaN: give weights"),
            (lambda: fsot.Classes.listed([([0, 1], [1.0])]), "2 samples and 1 weights: give one each"),
            (lambda: fsot.Classes.listed([[-1]]), "a sample of a class is -1: give whole numbers from 0"),
            (lambda: fsot.Classes.listed([[2**40]]), "give whole numbers from 0 to 4294967295"),
            (lambda: fsot.Classes.listed([[[0, 1]]]), r"lists samples in shape \[1, 2\]: give them in a row"),
            (lambda: fsot.Classes.listed([]), "no class of the caller's classes holds a sample"),
            (lambda: fsot.Classes.listed([[0]], weights=[0.0]), "give a value from 1e-12 to 1e6"),
            (lambda: fsot.Classes.listed([[0]], weights=[1, 1]), "2 weights for 1 classes: give one each"),
            (lambda: fsot.Classes.labelled([0, -1], [[0]]), "a label is -1: give whole numbers from 0"),
            (lambda: fsot.Classes.ramps([0.5, 1.5]), r"a class coordinate is 1.5: give a value in \[0, 1\]"),
            (lambda: fsot.Classes.ramps([0.5], ["flat"]), "'flat' is no ramp: write rising or falling"),
            (lambda: fsot.Classes.prefixes("frame"), "'frame' has no prefixes: write table or pixel"),
            (lambda: fsot.Classes.prefixes("table", "odd"), "write powers_of_two, every, or numbers"),
            (lambda: fsot.Classes.lattice(fsot.Kernel.gaussian(1), "soft"), "write level_sets or weighted"),
        ],
    )
    def test_what_is_no_class_is_refused(self, make, sentence):
        with pytest.raises(ValueError, match=sentence):
            make()

    @pytest.mark.parametrize(
        "make",
        [
            lambda: fsot.Classes.listed([["a"]]),
            lambda: fsot.Classes.listed([[0.5]]),
            lambda: fsot.Classes.listed(3),
            lambda: fsot.Classes.labelled(["a"], [[0]]),
            lambda: fsot.Classes.ramps([1j]),
            lambda: fsot.Classes.lattice("gaussian"),
        ],
    )
    def test_wrong_types_are_type_errors(self, make):
        with pytest.raises(TypeError):
            make()

    def test_samples_beyond_the_table_are_refused_when_there_is_one(self):
        config = fsot.Config.points(4, 2, [one(fsot.Classes.listed([[0, 1], [4]], name="mine"))])
        with pytest.raises(ValueError, match='class 1 of "mine#[0-9a-f]*" gives sample 4 weight 1: name sam'):
            fsot.Objective(config)

    def test_lists_are_taken_from_any_array(self):
        reverse = numpy.arange(12, dtype=">i8")[::-2]
        same = fsot.Classes.listed([list(range(11, 0, -2))])
        assert fsot.Classes.listed([reverse]) == same
        assert fsot.Classes.listed([reverse.astype(float)]) == same
        assert fsot.Classes.listed(iter([range(11, 0, -2)])) == same


def beta_quantiles(theta, levels=numpy.linspace(0, 1, 129)):
    return numpy.quantile(DRAWS @ theta, levels)


DRAWS = numpy.random.default_rng(7).beta(2, 5, (4000, 2))


class TestTargets:
    @pytest.mark.parametrize(
        "target, kind, dims",
        [
            (fsot.Target.uniform(), "uniform", None),
            (fsot.Target.density(numpy.arange(12.0).reshape(3, 4)), "density", 2),
            (fsot.Target.cloud(DRAWS[:100]), "cloud", 2),
            (fsot.Target.quantiles([0, 0.2, 1]), "quantiles", 1),
            (fsot.Target.quantiles(beta_quantiles, dims=2, name="beta"), "quantiles", 2),
        ],
    )
    def test_every_kind_survives_pickle(self, target, kind, dims):
        again = pickle.loads(pickle.dumps(target))
        assert (again.kind, again.dims) == (target.kind, target.dims) == (kind, dims)
        assert again == target and again != fsot.Target.cloud([[0.5]])

    def test_points_follow_a_table_of_quantiles(self):
        """Of u², whose optimum of n points is known: the means of its n equal parts."""
        levels = numpy.linspace(0, 1, 1025)
        config = fsot.Config.points(32, 1, [one(WHOLE, fsot.Target.quantiles(levels**2), [0])])
        points = numpy.sort(moved(config, 32, 1024).ravel())
        edges = numpy.linspace(0, 1, 33)
        best = 32 * numpy.diff(edges**3) / 3
        assert numpy.abs(points - best).max() < 1e-3

    def test_points_follow_a_function_in_two_dimensions(self):
        config = fsot.Config.points(256, 2, [one(WHOLE, fsot.Target.quantiles(beta_quantiles, dims=2))])
        points = moved(config, 256, 512)
        # Means and spread of Beta(2, 5): 2/7, and a variance of 10 / (49 · 8).
        assert points.mean(0) == pytest.approx([2 / 7] * 2, abs=0.004)
        assert points.var(0) == pytest.approx([10 / 392] * 2, rel=0.05)

    def test_a_function_does_what_its_cloud_does(self):
        """Both hold the same law, one at its quantiles."""
        cloud = DRAWS[:500].astype(numpy.float32)
        levels = numpy.linspace(0, 1, 2001)

        def quantiles(theta):
            return numpy.quantile(cloud.astype(float) @ theta, levels, method="inverted_cdf")

        values = []
        points = numpy.random.default_rng(1).random((64, 2))
        for target in (fsot.Target.cloud(cloud), fsot.Target.quantiles(quantiles, dims=2)):
            objective = fsot.Objective(fsot.Config.points(64, 2, [one(WHOLE, target)]))
            values.append(objective.value_and_gradient(points, objective.draw(steps=4))[0])
        # A table of 1024 levels stands for 500 steps.
        assert values[0] == pytest.approx(values[1], rel=2e-3)

    def test_a_function_is_asked_once_for_each_direction(self):
        asked = []

        def quantiles(theta):
            asked.append(tuple(theta))
            return beta_quantiles(theta)

        target = fsot.Target.quantiles(quantiles, dims=2)
        config = fsot.Config.points(32, 2, [one(WHOLE, target), one(fsot.Classes.prefixes(), target)])
        optimizer = fsot.Optimizer(config, threads=2)
        planned = len(asked)
        assert 200 < planned < 400 and len(set(asked)) == planned
        optimizer.run(fsot.Until.slices(64), lambda step: step.loss, progress=False)
        objective = fsot.Objective(config)
        objective.value_and_gradient(numpy.full((32, 2), 0.5), objective.draw())
        assert len(asked) == planned

    @pytest.mark.parametrize("make", [fsot.Objective, fsot.Optimizer])
    @pytest.mark.parametrize("threads", [1, 2, None])
    def test_what_a_function_raises_is_raised(self, make, threads):
        class Mine(Exception):
            pass

        def raising(theta):
            if theta[0] > 0.9:
                raise Mine(theta)
            return beta_quantiles(theta)

        config = fsot.Config.points(8, 2, [one(WHOLE, fsot.Target.quantiles(raising, dims=2))])
        for _ in range(2):
            with pytest.raises(Mine):
                make(config, threads=threads)

    def test_what_a_function_raises_does_not_stay(self):
        broken = [True]

        def quantiles(theta):
            if broken[0]:
                raise KeyError("now")
            return beta_quantiles(theta)

        config = fsot.Config.points(8, 2, [one(WHOLE, fsot.Target.quantiles(quantiles, dims=2))])
        with pytest.raises(KeyError):
            fsot.Objective(config)
        broken[0] = False
        assert fsot.Objective(config).terms == config.terms

    def test_what_a_function_raises_is_raised_by_metrics(self):
        broken = [True]

        def quantiles(theta):
            if broken[0]:
                raise KeyError("now")
            return beta_quantiles(theta)

        points = numpy.random.default_rng(0).random((8, 2))

        def bound(target):
            return fsot.metrics.bound(points, fsot.Config.points(8, 2, [one(WHOLE, target)]))

        def distance(target):
            return fsot.metrics.sliced_distance(points, target=target)

        for measure in (bound, distance):
            target = fsot.Target.quantiles(quantiles, dims=2)
            broken[0] = True
            with pytest.raises(KeyError, match="now"):
                measure(target)
            # Later calls, which share the function, hear nothing of it.
            broken[0] = False
            assert fsot.Objective(fsot.Config.points(8, 2, [one(WHOLE, target)])).shape == (1, 1, 8, 1, 2)
            measure(target)

    def test_threads_hear_what_their_own_call_has_raised(self):
        def quantiles(theta):
            if abs(theta[0] - 0.28) < 1e-9:
                raise LookupError("there")
            return beta_quantiles(theta)

        target = fsot.Target.quantiles(quantiles, dims=2)
        objective = fsot.Objective(fsot.Config.points(8, 2, [one(WHOLE, target)]), threads=2)
        good = objective.draw()
        bad = fsot.Slices(objective, 0, 0, 0.0, [[0.28, 0.96]])
        points = numpy.full((8, 2), 0.5)
        objective.value_and_gradient(points, good)
        heard = {"good": [], "bad": []}

        def ask(name, slices):
            for _ in range(100):
                try:
                    objective.value_and_gradient(points, slices)
                    heard[name].append(None)
                except Exception as error:
                    heard[name].append(type(error))

        threads = [threading.Thread(target=ask, args=pair) for pair in 3 * [("good", good), ("bad", bad)]]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join(60)
        assert heard == {"good": 300 * [None], "bad": 300 * [LookupError]}

    def test_an_own_slice_along_which_a_function_raises(self):
        def quantiles(theta):
            if abs(theta[0] - 0.28) < 1e-9:
                raise LookupError("there")
            return beta_quantiles(theta)

        target = fsot.Target.quantiles(quantiles, dims=2)
        objective = fsot.Objective(fsot.Config.points(8, 2, [one(WHOLE, target)]))
        slices = fsot.Slices(objective, 0, 0, 0.0, [[0.28, 0.96]])
        with pytest.raises(LookupError, match="there"):
            objective.value_and_gradient(numpy.full((8, 2), 0.5), slices)

    @pytest.mark.parametrize("threads", [1, 2])
    def test_a_function_may_use_fsot_itself(self, threads):
        """It is called by a thread of the pool that plans, which waits for it."""
        inner = fsot.Objective(fsot.Config(4, 4), threads=threads)
        asked = []

        def quantiles(theta):
            asked.append(inner.cramer(numpy.full(inner.shape, 0.5))[0])
            if len(asked) < 3:
                inner.draw()
                fsot.table(4, 4, sweeps=1, threads=threads, progress=False, callback=lambda step: None)
                fsot.Objective(fsot.Config(4, 4), threads=threads)
            return beta_quantiles(theta)

        config = fsot.Config.points(8, 2, [one(WHOLE, fsot.Target.quantiles(quantiles, dims=2))])
        assert fsot.Objective(config, threads=threads).shape == (1, 1, 8, 1, 2)
        assert len(set(asked)) == 1

    def test_several_threads_plan_with_one_function(self):
        target = fsot.Target.quantiles(beta_quantiles, dims=2)
        config = fsot.Config.points(32, 2, [one(WHOLE, target)])
        found = []

        def plan():
            objective = fsot.Objective(config, threads=2)
            found.append(objective.value_and_gradient(numpy.full((32, 2), 0.3), objective.draw())[0])

        threads = [threading.Thread(target=plan) for _ in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join(60)
        assert len(found) == 4 and len(set(found)) == 1

    @pytest.mark.parametrize(
        "returned, error, sentence",
        [
            ([0.0], ValueError, r"quantiles of shape \[1\]"),
            ([[0.0, 1.0]], ValueError, r"quantiles of shape \[1, 2\]"),
            ([0.0, numpy.inf], ValueError, "quantile 1 is inf"),
            ([0.0, 0.5, 0.4], ValueError, "quantiles fall from 0.5 to 0.4 after number 1"),
            ([-5.0, 5.0], ValueError, "the target reaches from -5 to 5, but the unit cube"),
            ("text", TypeError, "give real numbers"),
            (None, TypeError, "give real numbers"),
        ],
    )
    def test_no_quantiles_are_refused(self, returned, error, sentence):
        config = fsot.Config.points(
            8, 2, [one(WHOLE, fsot.Target.quantiles(lambda theta: returned, dims=2))]
        )
        with pytest.raises(error, match=sentence):
            fsot.Objective(config)

    @pytest.mark.parametrize(
        "make, error, sentence",
        [
            (lambda: fsot.Target.quantiles([0, 2.0]), ValueError, r"go from 0 to 2: give values in \[0, 1\]"),
            (lambda: fsot.Target.quantiles([0, 1], dims=2), TypeError, "give a function of the direction"),
            (lambda: fsot.Target.quantiles(beta_quantiles, dims=0), ValueError, "dims is 0: give at least 1"),
            (lambda: fsot.Target.density([1.0, 2.0]), ValueError, r"give the two axes \[row, column\]"),
            (lambda: fsot.Target.density([[0.0, 0.0]]), ValueError, "the density is 0 in all"),
            (lambda: fsot.Target.density([[1.0, -1.0]]), ValueError, "column 1, row 0 is -1: give finite"),
            (lambda: fsot.Target.density([[1.0, numpy.nan]]), ValueError, "column 1, row 0 is NaN"),
            (lambda: fsot.Target.density(numpy.zeros((0, 4))), ValueError, "the height of the density is 0"),
            (lambda: fsot.Target.cloud([0.5, 0.5]), ValueError, r"give the two axes \[point, dim\]"),
            (lambda: fsot.Target.cloud([[0.5, 1.5]]), ValueError, r"coordinate 1 of the cloud is 1.5"),
            (lambda: fsot.Target.cloud(numpy.zeros((0, 2))), ValueError, "points of the cloud is 0"),
        ],
    )
    def test_what_is_no_target_is_refused(self, make, error, sentence):
        with pytest.raises(error, match=sentence):
            make()

    def test_bright_pixels_draw_their_share(self):
        density = numpy.ones((4, 4))
        density[:, 2:] = 3
        config = fsot.Config.points(64, 2, [one(WHOLE, fsot.Target.density(density))])
        right = (moved(config, 64)[:, 0] > 0.5).sum()
        assert 46 <= right <= 50


class TestTerms:
    def test_a_term_says_what_it_is(self):
        term = one(WHOLE, fsot.Target.uniform(), numpy.array([1, 0]), weight=0.5, role="balance")
        assert (term.classes, term.target) == (WHOLE, fsot.Target.uniform())
        assert (term.dims, term.weight, term.role) == ([1, 0], 0.5, "balance")
        assert pickle.loads(pickle.dumps(term)) == term != one(WHOLE, dims=[1, 0], weight=0.5)
        assert one(WHOLE, dims=1).dims == [1]

    @pytest.mark.parametrize(
        "make, error, sentence",
        [
            (lambda: one(WHOLE, dims=[]), ValueError, "the dimension group is empty"),
            (lambda: one(WHOLE, dims=[1, 1]), ValueError, "names dimension 1 twice"),
            (lambda: one(WHOLE, dims=[-1]), ValueError, "-1 is out of range"),
            (lambda: one(WHOLE, weight=0.0), ValueError, "the weight of a term is 0"),
            (lambda: one(WHOLE, weight=numpy.nan), ValueError, "the weight of a term is NaN"),
            (lambda: one(WHOLE, role="rest"), ValueError, "'rest' is no role: write descend or balance"),
            (lambda: one(WHOLE, fsot.Target.quantiles([0, 1])), ValueError, "name as many dimensions"),
            (lambda: one(WHOLE, dims="01"), TypeError, "is no whole number"),
            (lambda: one("whole_table"), TypeError, "Classes"),
            (lambda: one(WHOLE, "uniform"), TypeError, "Target"),
            # Notes name the argument, from Python 3.11 on.
            (lambda: one(WHOLE, weight="1"), TypeError, "weight|real number"),
        ],
    )
    def test_what_is_no_term_is_refused(self, make, error, sentence):
        with pytest.raises(error, match=sentence):
            make()
