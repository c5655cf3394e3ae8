//! Going on: optimisers out of tables and checkpoints, and checkpoints of optimisers.

use super::Optimizer;
use super::checkpoint::{Checkpoint, Counters, Identity, Place, damaged};
use super::record::Past;
use crate::config::Config;
use crate::error::{CheckpointError, ConfigError};
use crate::files::{Metadata, RunRecord};
use crate::slices::Slices;
use crate::table::SampleTable;

impl Optimizer {
    /// Starts from a table, as made by an earlier run, with the slices and sweeps that this run would begin
    /// with: if its seed was the same, it repeats them. [`Optimizer::from_table_with`] doesn't.
    ///
    /// # Errors
    /// As [`Optimizer::new`]; a table whose shape is not that of the configuration.
    pub fn from_table(config: Config, table: SampleTable) -> Result<Self, ConfigError> {
        let mut optimizer = Self::new(config)?;
        optimizer.start_from(table)?;
        Ok(optimizer)
    }

    /// Starts from a table whose metadata say how many slices and sweeps it has seen, and goes on with those
    /// that come next. Schedules begin anew, with fresh moments; to end what a run has planned it takes a
    /// [`Checkpoint`].
    ///
    /// Where metadata of before 2026-11-27 don't number them, it goes on after as many as there can have been
    /// at most.
    ///
    /// # Errors
    /// As [`Optimizer::from_table`].
    ///
    /// ```
    /// use fsot::{Config, Extent, Optimizer, SampleTable, Until};
    ///
    /// let config = Config::new(Extent::still(16, 16), 2);
    /// let folder = tempfile::tempdir()?;
    /// let path = folder.path().join("table.npy");
    /// let mut optimizer = Optimizer::new(config.clone())?;
    /// let report = optimizer.run(Until::Sweeps(4))?;
    /// optimizer.table().save_with(&path, &optimizer.metadata(&report))?;
    ///
    /// let (table, metadata) = SampleTable::load_with(&path)?;
    /// let mut next = Optimizer::from_table_with(config, table, &metadata)?;
    /// assert_eq!(next.run(Until::Sweeps(4))?.work, optimizer.run(Until::Sweeps(4))?.work);
    /// assert_eq!(next.points(), optimizer.points());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn from_table_with(
        config: Config,
        table: SampleTable,
        metadata: &Metadata,
    ) -> Result<Self, ConfigError> {
        let mut optimizer = Self::from_table(config, table)?;
        let RunRecord { steps, sweeps, next_step, next_sweep, .. } = metadata.run;
        optimizer.steps = next_step.unwrap_or(steps);
        optimizer.swept = next_sweep.unwrap_or(sweeps);
        Ok(optimizer)
    }

    /// Goes on from this table instead of what was reached, with fresh moments.
    ///
    /// # Errors
    /// A table whose shape is not that of the configuration.
    pub fn start_from(&mut self, table: SampleTable) -> Result<(), ConfigError> {
        self.objective.check_table(&table)?;
        self.points = table.into_values();
        self.slices = Slices::new(self.config.descent, self.points.len());
        (self.sweeper, self.resumed) = (None, None);
        (self.fresh, self.past) = (false, Past::Other);
        Ok(())
    }

    /// All that further steps depend on; a copy. In the middle of a run it is
    /// [`StepReport::checkpoint`](super::StepReport::checkpoint).
    pub fn checkpoint(&self) -> Checkpoint {
        let identity = self.identity.get_or_init(|| Identity::new(&self.config, &self.objective));
        let (course, frame) = self.resumed.clone().unzip();
        let points = frame.flatten().unwrap_or_else(|| self.points.clone());
        Checkpoint::new(&self.config, identity, course, self.place(), points)
    }

    /// Goes on from a checkpoint instead of what was reached: with its coordinates, moments and counters, and
    /// with its run, if it was taken in one, which [`finish`](Optimizer::finish) ends. A new run would begin
    /// its schedules anew.
    ///
    /// The optimiser must be made as that of the checkpoint, from the same configuration (which
    /// [`Checkpoint::config`] gives back) and, for [`Optimizer::for_demand`], the same demand.
    ///
    /// # Errors
    /// [`CheckpointError::OtherObjective`] if it was not; [`CheckpointError::Damaged`] if its parts do not
    /// fit each other. Nothing is changed then.
    pub fn resume(&mut self, checkpoint: Checkpoint) -> Result<(), CheckpointError> {
        let Checkpoint { header, points, moments, .. } = checkpoint;
        let here = self.identity.get_or_init(|| Identity::new(&self.config, &self.objective));
        if header.hash != here.hash {
            let here = here.hash.clone();
            return Err(CheckpointError::OtherObjective { checkpoint: header.hash, here });
        }
        let Counters { steps, swept, fresh, descended, past } = header.place;
        let mut slices = Slices::new(self.config.descent, self.points.len());
        let is_whole = points.len() == self.points.len();
        // The frame that an animation begins with is swept: nothing has descended yet.
        if is_whole || header.course.is_none() {
            let walker = slices.walker().clone().with_moments(moments, descended);
            slices.set_walker(walker.ok_or_else(|| damaged("its moments are of another descent"))?);
        }
        match (is_whole, header.course) {
            (true, course) => {
                self.points = points;
                self.resumed = course.map(|course| (course, None));
            }
            (false, Some(course)) if course.step <= course.work.frame_sweeps => {
                self.resumed = Some((course, Some(points)));
            }
            _ => return Err(damaged("it holds a single frame of an animation")),
        }
        (self.slices, self.steps, self.swept, self.fresh) = (slices, steps, swept, fresh);
        (self.sweeper, self.past) = (None, past);
        Ok(())
    }

    /// Whether there is a run to go on with: one that was [resumed](Self::resume) and that nothing has
    /// replaced or ended since. [`finish`](Optimizer::finish) ends it.
    pub fn is_in_a_run(&self) -> bool {
        self.resumed.is_some()
    }

    pub(super) fn place(&self) -> Place<'_> {
        let walker = self.slices.walker();
        let Self { steps, swept, fresh, past, .. } = *self;
        Place { counters: Counters { steps, swept, fresh, descended: walker.steps(), past }, walker }
    }

    /// A frame whose sweeps have brought it here.
    pub(super) fn swept_to(mut self, points: Vec<f32>, sweeps: u64) -> Self {
        (self.points, self.swept, self.fresh) = (points, sweeps, false);
        self
    }

    /// Takes up the sweep that was begun last.
    pub(super) fn begin_again(&mut self) -> Result<(), ConfigError> {
        let (seed, sweep) = (self.config.seed, self.swept.wrapping_sub(1));
        self.sweeper()?.shuffle(seed, sweep);
        Ok(())
    }
}
