//! gridwalk as one of the contenders.

use std::sync::Arc;

use anyhow::Result;
use gridwalk_render::{GpuScene, Grid, Player, RayBatch, StepTime};

use crate::contender::{Answers, Contender, Query, Set, Tree, occluded};

/// What is rebuilt and traced.
enum Source<'a> {
    Still(Box<Grid>, &'a GpuScene),
    Moving(&'a mut Player),
}

/// A grid and the rays that are traced through it.
pub struct Ours<'a> {
    source: Source<'a>,
    batches: Vec<(Query, RayBatch)>,
    /// Milliseconds of each trace that sorting took.
    sorts: Vec<f64>,
}

impl<'a> Ours<'a> {
    /// A grid over a scene.
    pub fn still(grid: Grid, scene: &'a GpuScene) -> Ours<'a> {
        Ours { source: Source::Still(Box::new(grid), scene), batches: Vec::new(), sorts: Vec::new() }
    }

    /// A player's grid, over what it shows now.
    pub fn moving(player: &'a mut Player) -> Ours<'a> {
        Ours { source: Source::Moving(player), batches: Vec::new(), sorts: Vec::new() }
    }

    /// The grid.
    pub fn grid(&self) -> &Grid {
        match &self.source {
            Source::Still(grid, _) => grid,
            Source::Moving(player) => player.grid(),
        }
    }

    /// The steps of some more rebuilds, of which the first does not count. Timestamps between the steps make them slower on a CPU driver, so no
    /// rebuild that is compared has them.
    pub fn steps(&mut self, runs: u32) -> Result<Vec<Vec<StepTime>>> {
        self.time_steps(true);
        self.rebuild()?;
        let mut steps = Vec::new();
        for _ in 0..runs {
            self.rebuild()?;
            steps.push(self.grid().stats().steps.clone());
        }
        self.time_steps(false);
        Ok(steps)
    }

    fn time_steps(&mut self, time_steps: bool) {
        match &mut self.source {
            Source::Still(grid, _) => grid.time_steps(time_steps),
            Source::Moving(player) => player.time_steps(time_steps),
        }
    }
}

impl Ours<'_> {
    /// Of all traces since the rays were loaded but the first, which is no turn that counts: milliseconds that sorting took.
    pub fn take_sorts(&mut self) -> impl Iterator<Item = f64> + use<> {
        std::mem::take(&mut self.sorts).into_iter().skip(1)
    }
}

impl Contender for Ours<'_> {
    fn name(&self) -> &'static str {
        "gridwalk"
    }

    fn prepare(&mut self, _: Tree) -> Result<()> {
        Ok(())
    }

    fn rebuild(&mut self) -> Result<f64> {
        match &mut self.source {
            Source::Still(grid, scene) => grid.rebuild(scene)?,
            Source::Moving(player) => player.rebuild()?,
        }
        Ok(self.grid().stats().ms)
    }

    fn load(&mut self, sets: &[Arc<Set>]) -> Result<()> {
        self.batches.clear();
        self.sorts.clear();
        let context = self.grid().context().clone();
        for set in sets {
            let make = if set.sorts { RayBatch::sorted } else { RayBatch::new };
            self.batches.push((set.query, make(&context, &set.rays)?));
        }
        Ok(())
    }

    fn trace(&mut self, set: usize) -> Result<f64> {
        let grid = match &self.source {
            Source::Still(grid, _) => grid,
            Source::Moving(player) => player.grid(),
        };
        let Some((query, batch)) = self.batches.get_mut(set) else { return Ok(0.0) };
        let ms = match query {
            Query::Closest => batch.closest_hit(grid)?,
            Query::Any => batch.any_hit(grid)?,
        };
        self.sorts.push(batch.sort_ms());
        Ok(ms)
    }

    fn answers(&mut self, set: usize) -> Result<Answers> {
        let hits = match self.batches.get(set) {
            Some((Query::Closest, batch)) => batch.read_hits()?,
            Some((Query::Any, batch)) => occluded(&batch.read_occluded()?),
            None => Vec::new(),
        };
        Ok(Answers { hits, step: 1 })
    }

    fn bytes(&self) -> Option<u64> {
        let stats = self.grid().stats();
        Some(stats.grid_bytes + stats.scratch_bytes)
    }
}
