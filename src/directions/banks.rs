//! Banks that the terms of an objective share.

use std::sync::Arc;

use super::cube_bank::CubeBank;
use super::target_bank::{BankError, TargetBank};
use crate::targets::Target;
use crate::targets::watch::Watch;

/// Banks by dimensions and target: those of cubes made at their first use, the others planned.
#[derive(Debug, Default)]
pub(crate) struct Banks {
    of_cubes: Vec<(usize, Arc<CubeBank>)>,
    of_targets: Vec<(usize, Target, Arc<TargetBank>)>,
}

impl Banks {
    /// The bank of the cube in `dims ≥ 3` dimensions.
    pub(crate) fn of_cube(&mut self, dims: usize) -> Arc<CubeBank> {
        if let Some((_, bank)) = self.of_cubes.iter().find(|(of, _)| *of == dims) {
            return bank.clone();
        }
        let bank = Arc::new(CubeBank::new(dims));
        self.of_cubes.push((dims, bank.clone()));
        bank
    }

    /// Makes the banks of targets, given with their numbers of dimensions and of points.
    ///
    /// # Errors
    /// A law that is none, with the number of its target; planning was stopped.
    pub(crate) fn plan(
        &mut self,
        targets: &[(usize, &Target, usize)],
        watch: &mut Watch,
    ) -> Result<(), (usize, BankError)> {
        let groups = groups(targets);
        for (number, group) in groups.iter().enumerate() {
            let (first, dims) = (group[0].0, targets[group[0].0].0);
            let asked: Vec<_> = group.iter().map(|&(index, points)| (targets[index].1, points)).collect();
            let share = |groups_done: usize| groups_done as f64 / groups.len() as f64;
            let watch = &mut watch.part(share(number), share(number + 1));
            let banks = TargetBank::of_targets(dims, &asked, watch).map_err(|problem| (first, problem))?;
            let made = asked.iter().zip(banks);
            self.of_targets.extend(made.map(|((target, _), bank)| (dims, (*target).clone(), bank.into())));
        }
        Ok(())
    }

    /// The bank of a target that is not the cube, if it has been planned.
    pub(crate) fn of_target(&self, dims: usize, target: &Target) -> Option<Arc<TargetBank>> {
        let known = |made: &&(usize, Target, _)| (made.0, &made.1) == (dims, target);
        self.of_targets.iter().find(known).map(|(_, _, bank)| bank.clone())
    }
}

/// Positions of the targets that are not the cube, each once, with the most points; sums of densities of one
/// size together.
fn groups(targets: &[(usize, &Target, usize)]) -> Vec<Vec<(usize, usize)>> {
    let mut groups: Vec<Vec<(usize, usize)>> = Vec::new();
    for (index, &(dims, target, points)) in targets.iter().enumerate() {
        if *target == Target::UniformCube {
            continue;
        }
        let is_same =
            |known: &&mut (usize, usize)| (targets[known.0].0, targets[known.0].1) == (dims, target);
        if let Some(known) = groups.iter_mut().flatten().find(is_same) {
            known.1 = known.1.max(points);
            continue;
        }
        let together = |group: &&mut Vec<(usize, usize)>| match (targets[group[0].0].1, target) {
            (Target::Densities(first), Target::Densities(other)) => first.size() == other.size(),
            _ => false,
        };
        match groups.iter_mut().find(together) {
            Some(group) => group.push((index, points)),
            None => groups.push(vec![(index, points)]),
        }
    }
    groups
}
