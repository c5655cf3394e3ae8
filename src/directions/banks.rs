//! Banks that the terms of an objective share.

use std::sync::Arc;

use super::cube_bank::CubeBank;
use super::target_bank::TargetBank;
use crate::error::TargetError;
use crate::targets::Target;

/// Banks by dimensions and target, each made at its first use.
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

    /// The bank of a target that is not the cube.
    ///
    /// # Errors
    /// A law that is none.
    pub(crate) fn of_target(&mut self, dims: usize, target: &Target) -> Result<Arc<TargetBank>, TargetError> {
        let known = |made: &&(usize, Target, _)| (made.0, &made.1) == (dims, target);
        if let Some((_, _, bank)) = self.of_targets.iter().find(known) {
            return Ok(bank.clone());
        }
        let bank = Arc::new(TargetBank::new(dims, target)?);
        self.of_targets.push((dims, target.clone(), bank.clone()));
        Ok(bank)
    }
}
