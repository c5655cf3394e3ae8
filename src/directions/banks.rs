//! Banks that the terms of an objective share.

use std::sync::Arc;

use super::cube_bank::Bank;
use super::target_bank::Atlas;
use crate::error::ConfigError;
use crate::targets::Target;

/// Banks and atlases that the terms of an objective share.
#[derive(Debug, Default)]
pub(crate) struct Banks {
    made: Vec<(usize, Target, Arc<Bank>)>,
    atlases: Vec<(usize, Target, Arc<Atlas>)>,
}

impl Banks {
    /// The bank for `dims ≥ 3` dimensions, made at its first use.
    pub(crate) fn bank(&mut self, dims: usize, target: &Target) -> Arc<Bank> {
        match self.made.iter().find(|made| (made.0, &made.1) == (dims, target)) {
            Some((_, _, bank)) => bank.clone(),
            None => {
                let bank = Arc::new(Bank::new(dims, target));
                self.made.push((dims, target.clone(), bank.clone()));
                bank
            }
        }
    }

    /// The atlas of a target that is not the cube, made at its first use, by term `index`.
    pub(crate) fn atlas(
        &mut self,
        index: usize,
        dims: usize,
        target: &Target,
    ) -> Result<Arc<Atlas>, ConfigError> {
        if let Some((_, _, atlas)) = self.atlases.iter().find(|made| (made.0, &made.1) == (dims, target)) {
            return Ok(atlas.clone());
        }
        let atlas = Arc::new(Atlas::new(index, dims, target)?);
        self.atlases.push((dims, target.clone(), atlas.clone()));
        Ok(atlas)
    }
}
