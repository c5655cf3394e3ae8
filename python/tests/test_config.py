"""Configurations: what is set stays, in dictionaries, in JSON and in pickles."""

import json
import pickle

import numpy
import pytest

import fsot

CLOUD = fsot.Target.cloud([[0.5], [0.25]])
LATTICE = fsot.Classes.lattice(fsot.Kernel.gaussian(1.2))


def quantiles(theta):
    """Of the uniform square, roughly; a function of a module, which pickle finds again."""
    low, high = numpy.minimum(theta, 0).sum(), numpy.maximum(theta, 0).sum()
    return numpy.linspace(low, high, 65)


def own_config():
    classes = fsot.Classes.listed([range(8), (range(4, 16), numpy.linspace(1, 0.1, 12))], name="mine")
    target = fsot.Target.quantiles(quantiles, dims=2, name="theirs")
    rest = fsot.Target.quantiles([0.1, 0.5, 0.6])
    terms = [
        fsot.Term(classes, target, dims=[0, 1]),
        fsot.Term(fsot.Classes.whole_table(), target, dims=[1, 2], weight=0.1),
        fsot.Term(classes, rest, dims=[2]),
    ]
    return fsot.Config.points(16, 3, terms).with_seed(5).with_descent("sgd")


CONFIGS = {
    "default": fsot.Config(),
    "animation": fsot.Config(8, 4, 3, 2, 5, seed=2**64 - 1).with_kernel(fsot.Kernel.box_(3)),
    "all": fsot.Config(8, 8, dims=3)
    .with_kernels([fsot.Kernel.gaussian(1.0), fsot.Kernel.gaussian(3.0, temporal="ema:0.2")])
    .with_groups([([0, 1], 0.75), [2]])
    .with_form("weighted")
    .with_companions(False)
    .with_domain(["interval", "torus", "torus"])
    .with_slicing(directions=8, axis_share=0.25, batch_slices=1000)
    .with_descent("adam", rate=(0.1, 0.01), beta2=0.9)
    .with_sweeps(rate=1.5, truncation=0.01, softening=0)
    .with_balance({"shape": "cosine", "first": 0.9, "last": 0.1}),
    "terms": fsot.Config(4, 4).with_terms(
        [
            fsot.Term(LATTICE, dims=[1, 0]),
            fsot.Term(fsot.Classes.labelled(range(16), [[1, 2], [3]]), dims=1, weight=2, role="balance"),
            fsot.Term(fsot.Classes.ramps(numpy.linspace(0, 1, 16)), CLOUD, dims=0),
            fsot.Term(fsot.Classes.prefixes(), fsot.Target.density(numpy.eye(3)), dims=[0, 1]),
        ]
    ),
}


@pytest.mark.parametrize("config", CONFIGS.values(), ids=CONFIGS)
class TestRoundTrips:
    def test_by_dictionary(self, config):
        again = fsot.Config.from_dict(config.to_dict())
        assert again == config and again.to_json() == config.to_json()

    def test_by_json(self, config):
        text = config.to_json()
        assert fsot.Config.from_json(text) == config
        assert json.loads(text) == config.to_dict()

    def test_by_pickle(self, config):
        again = pickle.loads(pickle.dumps(config))
        assert again == config and again.terms == config.terms
        assert again != config.with_seed(17)


class TestOwn:
    def test_arrays_and_functions_survive_pickle(self):
        config = own_config()
        again = pickle.loads(pickle.dumps(config))
        assert again == config == own_config()
        assert again != config.with_seed(6)
        others = config.terms[:2] + [fsot.Term(config.terms[2].classes, dims=[2])]
        assert again != config.with_terms(others)

    def test_a_pickled_run_has_the_same_bits(self):
        config = own_config()
        found = []
        for one in (config, pickle.loads(pickle.dumps(config))):
            optimizer = fsot.Optimizer(one, threads=1)
            optimizer.run(fsot.Until.slices(64), progress=False)
            found.append(optimizer.points)
        assert numpy.array_equal(*found)

    def test_what_terms_share_they_share_again(self):
        """So that a function is asked once, not once for each term."""
        again = pickle.loads(pickle.dumps(own_config()))
        whole = len(pickle.dumps(own_config()))
        once = len(pickle.dumps(own_config().with_terms(own_config().terms[:1])))
        assert whole < once + 600
        first, second, _ = again.terms
        assert first.target == second.target

    def test_a_function_that_cannot_be_pickled_says_so(self):
        target = fsot.Target.quantiles(lambda theta: quantiles(theta), dims=2)
        config = fsot.Config.points(4, 2, [fsot.Term(fsot.Classes.whole_table(), target, dims=[0, 1])])
        with pytest.raises((pickle.PicklingError, AttributeError), match="lambda"):
            pickle.dumps(config)

    def test_json_holds_their_names_and_is_not_read_back(self):
        config = own_config()
        data = config.to_dict()
        assert data["terms"][0]["classes"]["custom"].startswith("mine#")
        assert data["terms"][0]["target"] == {"custom": "theirs"}
        with pytest.raises(ValueError, match='"mine#[0-9a-f]{8}" is code.*again with Classes.listed'):
            fsot.Config.from_dict(data)

    def test_a_table_of_theirs_has_metadata(self):
        optimizer = fsot.Optimizer(own_config())
        optimizer.run(fsot.Until.slices(16), progress=False)
        metadata = optimizer.table().metadata
        assert json.loads(json.dumps(metadata)) == metadata and "mine" in json.dumps(metadata)

    def test_a_checkpoint_of_theirs_is_resumed(self):
        config = own_config()
        optimizer = fsot.Optimizer(config, threads=1)
        checkpoints = []
        until = fsot.Until.slices(200)
        optimizer.run(until, lambda step: checkpoints.append(step.checkpoint()), progress=False)
        other = fsot.Optimizer(pickle.loads(pickle.dumps(config)), threads=1)
        other.resume(checkpoints[2])
        other.finish(progress=False)
        assert numpy.array_equal(other.points, optimizer.points)

    def test_a_checkpoint_of_other_lists_is_refused(self):
        """Both are called the same."""
        configs = [
            fsot.Config.points(4, 2, [fsot.Term(fsot.Classes.listed([lists]), dims=[0, 1])])
            for lists in ([0, 1], [0, 2])
        ]
        checkpoint = fsot.Optimizer(configs[0]).checkpoint()
        with pytest.raises(ValueError, match="configuration"):
            fsot.Optimizer(configs[1]).resume(checkpoint)
        fsot.Optimizer(pickle.loads(pickle.dumps(configs[0]))).resume(checkpoint)

    def test_names_tell_arrays_apart(self):
        names = {
            str(fsot.Target.quantiles(values).to_dict()) for values in ([0, 1], [0, 0.5], [0, 0.5, 1], [0, 1])
        }
        assert len(names) == 3


class TestSettings:
    def test_properties_say_what_was_set(self):
        config = CONFIGS["all"]
        assert (config.dims, config.domains) == (3, ["interval", "torus", "torus"])
        assert config.groups == [([0, 1], 0.75), ([2], 1.0)] and not config.companions
        assert config.kernels == [fsot.Kernel.gaussian(1.0), fsot.Kernel.gaussian(3.0, temporal="ema:0.2")]
        assert config.slicing == {"directions": 8, "axis_share": 0.25, "batch_slices": 1000}
        rate = {"shape": "geometric", "first": 0.1, "last": 0.01}
        assert config.descent == {"adam": {"rate": rate, "beta1": 0.9, "beta2": 0.9, "epsilon": 1e-8}}
        assert config.sweeps["rate"] == {"shape": "constant", "value": 1.5}
        assert (config.sweeps["truncation"], config.sweeps["softening"]) == (0.01, 0.0)
        assert config.balance == {"shape": "cosine", "first": 0.9, "last": 0.1}
        assert {term.classes.kind for term in config.terms} == {"lattice", "whole_table"}

    def test_terms_put_together_again_are_the_configuration(self):
        config = fsot.Config(8, 8, 2, 2, 3)
        same = config.with_companions(False)
        assert same.with_terms(same.terms) == same
        assert len(config.terms) > len(same.terms)

    def test_data_of_a_descent_is_taken_as_it_is(self):
        for name in ("barycentric", "sgd", "adam"):
            config = fsot.Config().with_descent(name)
            assert fsot.Config().with_descent(config.descent) == config
        assert fsot.Config().with_descent("barycentric") == fsot.Config()

    def test_schedules_are_numbers_pairs_or_data(self):
        config = fsot.Config()
        data = {"shape": "geometric", "first": 2.0, "last": 0.5}
        assert config.with_balance((2, 0.5)) == config.with_balance(numpy.array([2, 0.5]))
        assert config.with_balance([2, 0.5]) == config.with_balance(data)
        assert config.with_balance(numpy.float32(0.5)).balance == {"shape": "constant", "value": 0.5}

    def test_points_are_what_stippling_would_be(self):
        term = fsot.Term(fsot.Classes.whole_table(), fsot.Target.density(numpy.ones((2, 2))), dims=[0, 1])
        config = fsot.Config.points(10, 2, [term])
        assert config.shape == (1, 1, 10, 1, 2) and config.terms == [term]
        assert config.descent == {"barycentric": {"rate": {"shape": "geometric", "first": 1.0, "last": 0.02}}}

    def test_domains_are_given_for_all_or_for_each(self):
        config = fsot.Config(dims=2)
        assert config.with_domain("torus") == config.with_domain(("torus", "torus"))

    @pytest.mark.parametrize(
        "change, error, sentence",
        [
            (lambda c: c.with_terms([]), ValueError, "no term with a positive weight: give at least one"),
            (lambda c: c.with_terms([fsot.Term(LATTICE, dims=[5])]), ValueError, "term 0: the dim"),
            (lambda c: c.with_terms(["lattice"]), TypeError, "Term"),
            # Notes name the argument, from Python 3.11 on.
            (lambda c: c.with_terms(None), TypeError, "terms|'None'"),
            (lambda c: fsot.Config.points(4, 1, [fsot.Term(LATTICE, dims=[0, 1])]), ValueError, "dimension"),
            (lambda c: c.with_form("soft"), ValueError, "write level_sets or weighted"),
            (lambda c: c.with_form(3), TypeError, "form|of 'str'"),
            (lambda c: c.with_groups([[0, 7]]), ValueError, "names dimension 7, but the table has 2"),
            (lambda c: c.with_groups([[]]), ValueError, "the dimension group is empty"),
            (lambda c: c.with_groups(3), TypeError, "iterable"),
            (lambda c: c.with_groups([([0, 1], "heavy")]), TypeError, "real number"),
            (lambda c: c.with_domain("sphere"), ValueError, "write interval or torus"),
            (lambda c: c.with_domain(["torus"]), ValueError, "1 domains for 2 dimensions"),
            (lambda c: c.with_domain([1, 2]), TypeError, "str"),
            (lambda c: c.with_slicing(directions=17), ValueError, "give a value from 1 to 16"),
            (lambda c: c.with_slicing(directions="many"), TypeError, "whole number"),
            (lambda c: c.with_slicing(axis_share=1.5), ValueError, r"in \[0, 1\]"),
            (lambda c: c.with_slicing(batch_slices=0), ValueError, "at least 1 slice"),
            (lambda c: c.with_slicing(rate=1), TypeError, "rate"),
            (lambda c: c.with_descent("newton"), ValueError, "write barycentric, sgd or adam"),
            (lambda c: c.with_descent(3), TypeError, "give a dictionary"),
            (lambda c: c.with_descent("sgd", beta1=0.9), TypeError, "sgd has no beta1: leave it out"),
            (lambda c: c.with_descent("sgd", momentum=1), ValueError, "from 0 to 0.999999"),
            (lambda c: c.with_descent("sgd", momentum="0.9"), TypeError, "momentum is '0.9': give a number"),
            (lambda c: c.with_descent("adam", epsilon=0), ValueError, "epsilon is 0"),
            (lambda c: c.with_descent("adam", epsilon=numpy.nan), ValueError, "give a finite number"),
            (lambda c: c.with_descent("adam", rate="fast"), TypeError, "'fast' is no schedule"),
            (lambda c: c.with_descent("adam", rate=0), ValueError, "the first step size is 0"),
            (lambda c: c.with_descent("adam", rate=[1, 2, 3]), TypeError, "is no schedule"),
            (lambda c: c.with_descent({"adam": {}}), ValueError, "missing field"),
            (lambda c: c.with_sweeps(rate=(1, numpy.nan)), ValueError, "the last step size is NaN"),
            (lambda c: c.with_sweeps(truncation=1), ValueError, r"in \[0, 1\)"),
            (lambda c: c.with_sweeps(softening=-1), ValueError, "from 0 to 1e6"),
            (lambda c: c.with_sweeps(softening=True), TypeError, "give a number"),
            (lambda c: c.with_balance({"shape": "round"}), ValueError, "unknown variant"),
            (lambda c: c.with_balance(None), TypeError, "is no schedule"),
            (lambda c: c.with_balance(True), TypeError, "is no schedule"),
            (lambda c: fsot.Config.from_json("{"), ValueError, "correct that"),
        ],
    )
    def test_bad_settings_are_refused(self, change, error, sentence):
        with pytest.raises(error, match=sentence):
            change(fsot.Config(4, 4))
