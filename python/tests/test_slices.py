"""Slices: drawn, as arrays, and what is none."""

import pickle

import numpy
import pytest

import fsot

BAD = fsot.Config(0, 4)


def noise(shape, seed=0):
    return numpy.random.default_rng(seed).random(shape)


class TestSlices:
    def setup_method(self):
        self.objective = fsot.Objective(fsot.Config(4, 4, dims=3).with_groups([[0, 1], [2]]))
        self.slices = self.objective.draw(1, 2)

    def test_arrays_make_the_same_slices(self):
        slices = self.slices
        parts = slices.term, slices.member, slices.level, slices.direction, slices.cut
        assert fsot.Slices(self.objective, *parts) == slices
        assert [part.shape for part in parts] == [(len(slices),)] * 3 + [(len(slices), 3)] * 2
        assert pickle.loads(pickle.dumps(slices)) == slices

    def test_directions_are_unit_vectors_of_their_terms(self):
        terms = self.objective.terms
        for term, direction in zip(self.slices.term, self.slices.direction, strict=True):
            assert numpy.linalg.norm(direction) == pytest.approx(1, abs=1e-6)
            assert not numpy.delete(direction, terms[term].dims).any()

    def test_a_torus_has_cuts(self):
        objective = fsot.Objective(fsot.Config(4, 4).with_domain(["torus", "interval"]))
        cut = objective.draw(steps=4).cut
        assert len(numpy.unique(cut[:, 0])) > 1 and not cut[:, 1].any()

    def test_steps_come_one_after_the_other(self):
        together = self.objective.draw(1, 2, steps=3)
        assert self.slices + self.objective.draw(1, 3) + self.objective.draw(1, 4) == together
        assert self.objective.draw(1, 3) != self.slices != self.objective.draw(2, 2)
        assert self.objective.draw(1, 2**64 - 1, steps=2)[-1:] == self.objective.draw(1, 0)[-1:]

    def test_roles_are_drawn_apart(self):
        roles = [term.role for term in self.objective.terms]
        for role in ("descend", "balance"):
            assert {roles[term] for term in self.objective.draw(role=role, steps=64).term} == {role}

    def test_they_are_indexed_as_arrays_are(self):
        slices = self.slices
        assert slices[:3] + slices[3:] == slices
        assert slices[-1] == slices[[len(slices) - 1]] and len(slices[-1]) == 1
        assert slices[slices.level < 0.5] + slices[slices.level >= 0.5] != fsot.Slices
        assert len(slices[slices.level < 0.5]) + len(slices[slices.level >= 0.5]) == len(slices)
        with pytest.raises(IndexError):
            slices[len(slices)]

    def test_the_mean_of_parts_is_the_whole(self):
        points = noise(self.objective.shape)
        half = len(self.slices) // 2
        parts = [self.objective.value_and_gradient(points, part)[0] for part in (self.slices[:half],
                                                                                 self.slices[half:])]
        whole = self.objective.value_and_gradient(points, self.slices)[0]
        mean = (half * parts[0] + (len(self.slices) - half) * parts[1]) / len(self.slices)
        assert whole == pytest.approx(mean, rel=1e-12)

    @pytest.mark.parametrize(
        "parts, error, sentence",
        [
            ((0, 0, 0.0, [1, 0, 0]), ValueError, r"direction has shape \[3\]: give \[slices, 3\]"),
            ((0, 0, 0.0, [[1, 0]]), ValueError, r"direction has shape \[1, 2\]"),
            ((0, 0, 0.0, [[1, 0, 1]]), ValueError, "which term 0 doesn't see: give 0 there"),
            ((99, 0, 0.0, [[1, 0, 0]]), ValueError, "slice 0: term is 99, but the objective has"),
            (([0, 0], 0, 0.0, [[1, 0, 0]]), ValueError, r"term has shape \[2\]: give \[1\]"),
            ((-1, 0, 0.0, [[1, 0, 0]]), ValueError, "term is -1: give whole numbers"),
            ((0.5, 0, 0.0, [[1, 0, 0]]), TypeError, "term is 0.5: give whole numbers"),
            ((0, 0, "low", [[1, 0, 0]]), TypeError, "give real numbers"),
        ],
    )
    def test_what_are_no_slices_is_refused(self, parts, error, sentence):
        with pytest.raises(error, match=sentence):
            fsot.Slices(self.objective, *parts)

    @pytest.mark.parametrize(
        "parts, sentence",
        [
            ((0, 16, 0.0, [[1, 0, 0]]), "slice 0: member is 16, but the objective has 16: stay below it"),
            ((0, 0, 1.0, [[1, 0, 0]]), r"slice 0: level is 1: give a level in \[0, 1\)"),
            ((0, 0, 0.0, [[numpy.inf, 0, 0]]), "slice 0: direction is inf"),
        ],
    )
    def test_the_objective_refuses_the_rest(self, parts, sentence):
        slices = fsot.Slices(self.objective, *parts)
        with pytest.raises(ValueError, match=sentence):
            self.objective.value_and_gradient(noise((16, 3)), slices)

    def test_slices_of_another_objective_are_refused(self):
        other = fsot.Objective(fsot.Config(4, 4, dims=3).with_groups([[1, 0], [2]]))
        with pytest.raises(ValueError, match="slices of another objective: draw them from this one"):
            other.value_and_gradient(noise((16, 3)), self.slices)
        with pytest.raises(ValueError, match="slices of two objectives"):
            other.draw() + self.slices

    @pytest.mark.parametrize(
        "ask, error",
        [
            (lambda objective: objective.draw(-1), ValueError),
            (lambda objective: objective.draw(0, 2**64), ValueError),
            (lambda objective: objective.draw(steps=2**62), ValueError),
            (lambda objective: objective.draw(steps=10**9), ValueError),
            (lambda objective: objective.draw(role="rest"), ValueError),
            (lambda objective: objective.draw("one"), TypeError),
            (lambda objective: objective.draw(steps=1.5), TypeError),
            (lambda objective: objective.taps(99), ValueError),
            (lambda objective: objective.value_and_gradient(noise((16, 3)), "all"), TypeError),
            (lambda objective: fsot.Objective("config"), TypeError),
            (lambda objective: fsot.Objective(objective.config, threads=0), ValueError),
            (lambda objective: fsot.Objective(BAD), ValueError),
        ],
    )
    def test_other_questions_are_refused(self, ask, error):
        with pytest.raises(error):
            ask(self.objective)


@pytest.mark.parametrize("of_terms", [[[0, 9]], [[0, 1], [2]], [[2**40]]])
def test_a_damaged_pickle_is_refused(of_terms):
    # Terms that see dimensions that are not there.
    with pytest.raises(ValueError, match="there are 2: the pickle is damaged"):
        fsot.Slices._of_arrays(2, of_terms, ([0], [0], [0.0], [[1, 0]], [[0, 0]]))
