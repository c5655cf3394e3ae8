"""Values and gradients: the textbook's, and finite differences."""

import contextlib
import os
import pickle
import signal
import threading
import time

import numpy
import pytest

import fsot


def noise(shape, seed=0):
    return numpy.random.default_rng(seed).random(shape)


def differences(value, points, places, step=1e-6):
    """Central differences of a function at some places of an array."""
    found = []
    for place in places:
        ends = []
        for sign in (1, -1):
            moved = points.copy()
            moved.flat[place] += sign * step
            ends.append(value(moved))
        found.append((ends[0] - ends[1]) / (2 * step))
    return numpy.array(found)


def cube_quantiles(theta, u):
    """Quantiles of a uniform square along a direction: the trapezoid's distribution function, inverted."""
    a, b = sorted(numpy.abs(theta))
    if a < 1e-12:
        q = u * b
    else:
        corner = a / (2 * b)
        lower = numpy.sqrt(2 * a * b * u)
        middle = b * u + a / 2
        upper = a + b - numpy.sqrt(2 * a * b * numpy.maximum(1 - u, 0))
        q = numpy.where(u < corner, lower, numpy.where(u > 1 - corner, upper, middle))
    return q + numpy.minimum(theta, 0).sum()


def textbook_slice(points, samples, theta, cells=20_000):
    """(n / N) W2² along one slice, as a sum over a fine grid of levels."""
    u = (numpy.arange(cells) + 0.5) / cells
    ordered = numpy.sort(points[samples] @ theta)
    at = ordered[(u * len(ordered)).astype(int)]
    return len(ordered) / len(points) * ((at - cube_quantiles(theta, u)) ** 2).mean()


def subset(objective, term, member, level):
    """The samples above a level of a kernel around a pixel."""
    _, height, width, _, _ = objective.shape
    y, x = divmod(member, width)
    taps = objective.taps(term)
    return [
        int((y + dy) % height * width + (x + dx) % width)
        for _, dy, dx, weight in taps
        if weight / taps[0, 3] > level
    ]


class TestValues:
    def test_slices_are_the_textbook_s(self):
        objective = fsot.Objective(fsot.Config(4, 4).with_kernel(fsot.Kernel.gaussian(1.5)))
        points = noise((16, 2))
        slices = objective.draw(seed=1)
        values = [
            textbook_slice(points, subset(objective, term, member, level), theta)
            for term, member, level, theta in zip(
                slices.term, slices.member, slices.level, slices.direction, strict=True
            )
        ]
        # The grid of levels misses jumps by a cell, in each of up to 16 samples.
        assert objective.value_and_gradient(points, slices)[0] == pytest.approx(numpy.mean(values), rel=1e-4)

    def test_all_slices_are_the_textbook_s(self):
        """The mean over pixels and directions of the integral of (F - G)²."""
        config = fsot.Config(4, 4).with_kernel(fsot.Kernel.gaussian(1.5)).with_companions(False)
        objective = fsot.Objective(config)
        points, taps = noise((16, 2)), objective.taps(0)
        sites = numpy.array([[subset(objective, 0, member, -1) for member in range(16)]])[0]
        weights = taps[:, 3] / taps[:, 3].sum()
        total, directions, cells = 0.0, 64, 4000
        for turn in range(directions):
            theta = numpy.array([numpy.cos((turn + 0.5) * numpy.pi / directions),
                                 numpy.sin((turn + 0.5) * numpy.pi / directions)])
            low, high = numpy.minimum(theta, 0).sum(), numpy.maximum(theta, 0).sum()
            s = low + (numpy.arange(cells) + 0.5) / cells * (high - low)
            u = numpy.linspace(0, 1, 20_001)
            cube = numpy.interp(s, cube_quantiles(theta, u), u)
            along = points @ theta
            for pixel in sites:
                held = (weights[:, None] * (along[pixel][:, None] <= s)).sum(0)
                total += ((held - cube) ** 2).mean() * (high - low)
        assert objective.cramer(points)[0] == pytest.approx(total / 16 / directions, rel=2e-3)

    def test_even_points_are_better_than_noise(self):
        config = fsot.Config(16, 16)
        objective = fsot.Objective(config)
        table = fsot.table(16, 16, sweeps=30, progress=False).array
        slices = objective.draw(steps=16)
        for value in (objective.cramer, lambda points: objective.value_and_gradient(points, slices)):
            assert value(table)[0] < 0.8 * value(noise(objective.shape))[0]

    def test_results_are_the_same_at_any_number_of_threads(self):
        config = fsot.Config(8, 8, 2)
        found = []
        for threads in (1, 2, 5):
            objective = fsot.Objective(config, threads=threads)
            points = noise(objective.shape)
            slices = objective.draw(3, 4, steps=3)
            parts = objective.value_and_gradient(points, slices) + objective.cramer(points)
            found.append((slices, [numpy.asarray(part).tobytes() for part in parts]))
        assert found[0] == found[1] == found[2]

    def test_nothing_is_worth_nothing(self):
        objective = fsot.Objective(fsot.Config(4, 4))
        value, gradient = objective.value_and_gradient(noise((16, 2)), objective.draw(steps=0))
        assert value == 0 and gradient.shape == (16, 2) and not gradient.any()


CASES = {
    "square": fsot.Config(4, 4),
    "line": fsot.Config(6, 3, dims=1),
    "weighted": fsot.Config(4, 4).with_form("weighted"),
    "cube": fsot.Config(4, 4, dims=3),
    "animation": fsot.Config(3, 3, 3, 2),
    "torus": fsot.Config(4, 4).with_domain("torus"),
    "labels": fsot.Config.points(
        16, 2, [fsot.Term(fsot.Classes.labelled([0] * 9 + [1] * 7, [[0], [1], [0, 1]]), dims=[0, 1])]
    ),
    "density": fsot.Config.points(
        16,
        2,
        [fsot.Term(fsot.Classes.whole_table(), fsot.Target.density([[1.0, 2.0], [0.5, 0.0]]), dims=[0, 1])],
    ),
}


class TestGradients:
    @pytest.mark.parametrize("config", CASES.values(), ids=CASES)
    def test_slices_have_the_gradient_of_finite_differences(self, config):
        objective = fsot.Objective(config)
        points = 0.05 + 0.9 * noise(objective.shape, 5)
        slices = objective.draw(2, steps=2)
        _, gradient = objective.value_and_gradient(points, slices)
        places = range(0, points.size, 3)
        # On a torus, points 1e-6 from a cut jump; none of these is.
        found = differences(lambda at: objective.value_and_gradient(at, slices)[0], points, places)
        # Of values around 1e-2 whose differences lose 10 digits.
        assert numpy.abs(found - gradient.flat[list(places)]).max() < 1e-8
        assert numpy.abs(gradient).max() > 1e-5

    @pytest.mark.parametrize("name", ["square", "line", "weighted", "cube", "animation"])
    def test_all_slices_have_the_gradient_of_finite_differences(self, name):
        objective = fsot.Objective(CASES[name])
        points = 0.05 + 0.9 * noise(objective.shape, 6)
        _, gradient = objective.cramer(points)
        places = range(0, points.size, 3)
        found = differences(lambda at: objective.cramer(at)[0], points, places)
        # Mean distances in the cube are tabulated, and their slopes are not those of the table to the bit.
        assert numpy.abs(found - gradient.flat[list(places)]).max() < 5e-8
        assert numpy.abs(gradient).max() > 1e-4

    @pytest.mark.parametrize("name", ["torus", "labels", "density"])
    def test_where_there_is_no_closed_form_it_says_so(self, name):
        objective = fsot.Objective(CASES[name])
        with pytest.raises(ValueError, match="has no closed form over all slices, since .*: give slices"):
            objective.cramer(numpy.full(objective.shape, 0.5))


class TestPoints:
    def setup_method(self):
        self.objective = fsot.Objective(fsot.Config(4, 8))
        self.points = noise(self.objective.shape).astype(numpy.float32)
        self.slices = self.objective.draw()

    @pytest.mark.parametrize("shape", [(1, 8, 4, 1, 2), (8, 4, 2), (32, 2), (64,), (1, 32, 2), (8, 4, 1, 2)])
    def test_any_arrangement_is_given_back(self, shape):
        value, gradient = self.objective.cramer(self.points.reshape(shape))
        assert gradient.shape == shape and gradient.dtype == numpy.float64
        assert value == self.objective.cramer(self.points)[0]
        assert self.objective.value_and_gradient(self.points.reshape(shape), self.slices)[1].shape == shape

    @pytest.mark.parametrize(
        "change",
        [
            lambda points: points.astype(float),
            lambda points: points.astype(">f4"),
            numpy.asfortranarray,
            lambda points: numpy.repeat(points, 2, 2)[:, :, ::2],
            lambda points: points.tolist(),
        ],
    )
    def test_any_memory_gives_the_same(self, change):
        points = change(self.points)
        if isinstance(points, numpy.ndarray):
            points.flags.writeable = False
        assert self.objective.cramer(points)[0] == self.objective.cramer(self.points)[0]

    def test_points_are_left_alone(self):
        before = self.points.copy()
        _, gradient = self.objective.cramer(self.points)
        gradient += 1
        assert numpy.array_equal(before, self.points)

    @pytest.mark.parametrize(
        "points, error, sentence",
        [
            (numpy.zeros((2, 32)), ValueError, r"\[2, 32\]: give \[1, 8, 4, 1, 2\], \[32, 2\] or \[64\]"),
            (numpy.zeros(63), ValueError, "points of shape"),
            (0.5, ValueError, "points of shape"),
            (numpy.zeros((0, 2)), ValueError, "points of shape"),
            (numpy.ones((32, 2)), ValueError, r"point coordinate 0 is 1: give finite values in \[0, 1\)"),
            (numpy.full((32, 2), numpy.nan), ValueError, "point coordinate 0 is NaN"),
            (numpy.full((32, 2), -1e-9), ValueError, "point coordinate 0 is -1e-9"),
            (numpy.zeros((32, 2), complex), TypeError, "give real numbers"),
            (None, TypeError, "give real numbers"),
            ("points", TypeError, "give real numbers"),
        ],
    )
    def test_what_are_no_points_is_refused(self, points, error, sentence):
        with pytest.raises(error, match=sentence):
            self.objective.cramer(points)
        with pytest.raises(error, match=sentence):
            self.objective.value_and_gradient(points, self.slices)

    def test_below_one_is_below_one(self):
        assert numpy.float32(fsot.BELOW_ONE) == numpy.nextafter(numpy.float32(1), numpy.float32(0))
        assert self.objective.cramer(numpy.full((32, 2), fsot.BELOW_ONE))[0] > 0


class TestObjectives:
    def test_it_says_what_it_is(self):
        config = fsot.Config(5, 4, 3, 2, 3)
        objective = fsot.Objective(config)
        assert objective.shape == config.shape == (3, 4, 5, 2, 3)
        assert objective.terms == config.terms and objective.config == config and objective.demand is None
        taps = objective.taps(0)
        assert taps.shape[1] == 4 and [0, 0, 0] in taps[:, :3].tolist()
        assert (numpy.diff(taps[:, 3]) <= 0).all()
        whole = [term.classes.kind for term in objective.terms].index("whole_table")
        assert objective.taps(whole) is None

    def test_it_survives_pickle(self):
        demand = fsot.Demand(numpy.eye(4, dtype=bool))
        for given in (None, demand):
            objective = fsot.Objective(fsot.Config(4, 4), given, threads=2)
            again = pickle.loads(pickle.dumps(objective))
            points = noise(objective.shape)
            assert again.demand == given and again.draw() == objective.draw()
            assert again.cramer(points)[0] == objective.cramer(points)[0]

    def test_several_threads_ask_at_once(self):
        objective = fsot.Objective(fsot.Config(8, 8), threads=2)
        alone = [
            (objective.value_and_gradient(noise((64, 2), seed), objective.draw(seed))[1].tobytes(),
             objective.cramer(noise((64, 2), seed))[1].tobytes())
            for seed in range(8)
        ]
        together = [None] * 8

        def ask(seed):
            for _ in range(5):
                points = noise((64, 2), seed)
                together[seed] = (
                    objective.value_and_gradient(points, objective.draw(seed))[1].tobytes(),
                    objective.cramer(points)[1].tobytes(),
                )

        threads = [threading.Thread(target=ask, args=(seed,)) for seed in range(8)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join(60)
        assert together == alone

    def test_the_interpreter_goes_on_meanwhile(self):
        objective = fsot.Objective(fsot.Config(48, 48), threads=1)
        points = noise(objective.shape)
        ticks, done = [], threading.Event()

        def tick():
            while not done.is_set():
                ticks.append(time.perf_counter())
                time.sleep(0.001)

        thread = threading.Thread(target=tick)
        thread.start()
        begin = time.perf_counter()
        objective.cramer(points)
        end = time.perf_counter()
        done.set()
        thread.join()
        inside = [at for at in ticks if begin < at < end]
        # Held, the lock would let no tick through; freed, one comes a millisecond where a core is free.
        assert len(inside) > 5, (end - begin, len(inside))

    # JAX, where other tests have imported it, warns of its own threads.
    @pytest.mark.filterwarnings("ignore:.*fork:RuntimeWarning", "ignore:.*fork:DeprecationWarning")
    @pytest.mark.skipif(not hasattr(os, "fork"), reason="a system without forks")
    def test_a_forked_child_gets_the_same(self):
        objective = fsot.Objective(fsot.Config(8, 8))
        points = noise(objective.shape)
        expected = objective.cramer(points)[0], objective.value_and_gradient(points, objective.draw())[0]
        read, write = os.pipe()
        child = os.fork()
        if child == 0:
            try:
                found = objective.cramer(points)[0], objective.value_and_gradient(points, objective.draw())[0]
                os.write(write, repr(found).encode())
            finally:
                os._exit(0)
        os.close(write)
        with os.fdopen(read) as pipe:
            assert pipe.read() == repr(expected)
        os.waitpid(child, 0)


@contextlib.contextmanager
def interrupted():
    """Ctrl-C after a fifth of a second, in the midst of what would take half a minute of a core or more."""

    def at_the_alarm(*_):
        raise KeyboardInterrupt

    before = signal.signal(signal.SIGALRM, at_the_alarm)
    begin = time.perf_counter()
    signal.setitimer(signal.ITIMER_REAL, 0.2)
    try:
        with pytest.raises(KeyboardInterrupt):
            yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)
    # Heard within moments, but the machine may be busy.
    assert time.perf_counter() - begin < 15


@pytest.mark.skipif(not hasattr(signal, "setitimer"), reason="a system without timers")
class TestInterrupts:
    def test_of_all_slices(self):
        objective = fsot.Objective(fsot.Config(64, 64, 32), threads=1)
        points = noise(objective.shape)
        with interrupted():
            objective.cramer(points)
        assert objective.value_and_gradient(points, objective.draw())[0] > 0

    def test_of_many_slices(self):
        objective = fsot.Objective(fsot.Config(32, 32, 8), threads=1)
        points, slices = noise(objective.shape), objective.draw()
        many = slices[numpy.arange(1_000_000) % len(slices)]
        with interrupted():
            objective.value_and_gradient(points, many)

    def test_of_planning(self):
        def quantiles(theta):
            time.sleep(0.1)
            return numpy.linspace(0, 0.5, 5)

        target = fsot.Target.quantiles(quantiles, dims=2)
        config = fsot.Config.points(8, 2, [fsot.Term(fsot.Classes.whole_table(), target, dims=[0, 1])])
        with interrupted():
            fsot.Objective(config, threads=1)


def test_objectives_are_the_same_by_what_they_optimise():
    config = fsot.Config(4, 4)
    one, same = fsot.Objective(config), fsot.Objective(fsot.Config(4, 4), threads=1)
    assert one == same == pickle.loads(pickle.dumps(one)) and hash(one) == hash(same)
    half = fsot.Demand(numpy.arange(4) < numpy.full((4, 1), 2))
    others = [fsot.Objective(config, half), fsot.Objective(config.with_seed(1)), fsot.Objective(fsot.Config(4, 5))]
    assert all(one != other for other in others) and one != config
    assert {one: 1}[same] == 1 and fsot.Objective(config, half) == others[0]


def test_what_has_no_closed_form_says_so():
    objective = fsot.Objective(fsot.Config(4, 4).with_domain("torus"))
    with pytest.raises(ValueError, match="term 0 has no closed form .* that is a torus: give slices, as those of draw"):
        objective.cramer(numpy.full(objective.shape, 0.5))
