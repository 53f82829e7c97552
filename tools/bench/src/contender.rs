//! What gridwalk and its rivals have in common, so that all are measured alike and in turns.

use std::sync::Arc;

use anyhow::Result;
use gridwalk::{Hit, Ray};

use crate::report::Run;

/// What is asked of rays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Query {
    /// The closest hit.
    Closest,
    /// Whether there is one.
    Any,
}

/// Rays of one kind.
pub struct Set {
    pub kind: &'static str,
    pub query: Query,
    pub rays: Vec<Ray>,
    /// Whether we sort the rays before we trace them; rivals trace them as they are.
    pub sorts: bool,
}

/// Which of its trees a rival is to trace through. A grid is always the same.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tree {
    /// The one that is rebuilt fastest.
    Fast,
    /// The one that is traced fastest.
    Best,
}

/// What rays have found, in their order. Of any hits, those that hit are hits at 0 of triangle 0.
#[derive(Clone, Debug, PartialEq)]
pub struct Answers {
    pub hits: Vec<Hit>,
    /// Who is far too slow for all rays traces one run of [`RUN`] of so many.
    pub step: usize,
}

/// Rays that are neighbours in a set and stay together where some are left out: a tile of the camera's.
pub const RUN: usize = 64;

impl Answers {
    /// Which ray an answer belongs to.
    pub fn ray(&self, answer: usize) -> usize {
        answer / RUN * RUN * self.step.max(1) + answer % RUN
    }

    /// How many of the rays are answered.
    pub fn count(rays: usize, step: usize) -> usize {
        let last = rays.div_ceil(RUN).saturating_sub(1) / step.max(1);
        last * RUN + RUN.min(rays - last * step.max(1) * RUN)
    }
}

/// Someone who builds and traces. Milliseconds are those of the device for who runs there, else those on the wall.
pub trait Contender {
    /// As the report has it.
    fn name(&self) -> &'static str;

    /// Makes one tree and frees the other.
    ///
    /// # Errors
    /// What the contender reports.
    fn prepare(&mut self, tree: Tree) -> Result<()>;

    /// Builds again, as if every vertex had moved; returns the milliseconds. Only after the fast tree was prepared.
    ///
    /// # Errors
    /// What the contender reports.
    fn rebuild(&mut self) -> Result<f64>;

    /// Takes the rays that are to be traced from now on, and forgets those before.
    ///
    /// # Errors
    /// What the contender reports.
    fn load(&mut self, sets: &[Arc<Set>]) -> Result<()>;

    /// Traces the rays of a set that was loaded; returns the milliseconds, those that all rays would take where some are left out.
    ///
    /// # Errors
    /// What the contender reports.
    fn trace(&mut self, set: usize) -> Result<f64>;

    /// What the last trace of a set has found.
    ///
    /// # Errors
    /// What the contender reports.
    fn answers(&mut self, set: usize) -> Result<Answers>;

    /// Bytes of what was built and of what building it needs besides, where that is known.
    fn bytes(&self) -> Option<u64>;

    /// Whether the last trace has left rays out.
    fn is_sampled(&self) -> bool {
        false
    }
}

/// What one turn gave, and the milliseconds of processor time that all threads of the program took for it.
#[derive(Clone, Debug, PartialEq)]
pub struct Turn<T> {
    pub value: T,
    pub processor_ms: f64,
}

/// What each contender did in each of `runs` turns, in which they follow one another; the turn before the first is left out.
///
/// # Errors
/// What a contender reports.
pub fn turns<T>(
    runs: u32,
    contenders: &mut [&mut dyn Contender],
    mut turn: impl FnMut(&mut dyn Contender) -> Result<T>,
) -> Result<Vec<Vec<Turn<T>>>> {
    let mut all: Vec<Vec<Turn<T>>> = contenders.iter().map(|_| Vec::new()).collect();
    for run in 0..=runs {
        for (contender, turns) in contenders.iter_mut().zip(&mut all) {
            let begin = processor_ms();
            let value = turn(&mut **contender)?;
            if run > 0 {
                turns.push(Turn { value, processor_ms: processor_ms() - begin });
            }
        }
    }
    Ok(all)
}

/// The times of each contender.
pub fn times(turns: &[Vec<Turn<f64>>]) -> Vec<Vec<Run>> {
    let run = |turn: &Turn<f64>| Run { ms: turn.value, processor_ms: turn.processor_ms };
    turns.iter().map(|turns| turns.iter().map(run).collect()).collect()
}

/// Processor time of all threads of this program so far, those that have ended included; not a number on systems without such a clock.
#[cfg(not(unix))]
fn processor_ms() -> f64 {
    f64::NAN
}

/// Processor time of all threads of this program so far, those that have ended included.
#[cfg(unix)]
fn processor_ms() -> f64 {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    time.tv_sec as f64 * 1e3 + time.tv_nsec as f64 * 1e-6
}

/// The answers to any hits as hits: a hit is nearer than none.
pub fn occluded(answers: &[u32]) -> Vec<Hit> {
    let hit = |&answer: &u32| match answer {
        0 => Hit::MISS,
        gridwalk::UNFINISHED => Hit { triangle: gridwalk::UNFINISHED, ..Hit::MISS },
        _ => Hit { t: 0.0, u: 0.0, v: 0.0, triangle: 0 },
    };
    answers.iter().map(hit).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::VecDeque;

    struct Scripted(VecDeque<f64>);

    impl Contender for Scripted {
        fn name(&self) -> &'static str {
            "scripted"
        }
        fn prepare(&mut self, _: Tree) -> Result<()> {
            Ok(())
        }
        fn rebuild(&mut self) -> Result<f64> {
            self.0.pop_front().ok_or_else(|| anyhow::anyhow!("one turn too many"))
        }
        fn load(&mut self, _: &[Arc<Set>]) -> Result<()> {
            Ok(())
        }
        fn trace(&mut self, _: usize) -> Result<f64> {
            Ok(0.0)
        }
        fn answers(&mut self, _: usize) -> Result<Answers> {
            Ok(Answers { hits: Vec::new(), step: 1 })
        }
        fn bytes(&self) -> Option<u64> {
            None
        }
    }

    #[test]
    fn the_first_turn_is_left_out() {
        let mut ours = Scripted([5.0, 1.0, 2.0].into());
        let mut theirs = Scripted([9.0, 3.0, 4.0].into());
        let turns = turns(2, &mut [&mut ours, &mut theirs], |contender| contender.rebuild()).unwrap();
        let ms = times(&turns).iter().map(|runs| runs.iter().map(|run| run.ms).collect::<Vec<_>>()).collect::<Vec<_>>();
        assert_eq!(ms, [[1.0, 2.0], [3.0, 4.0]]);
        assert!(turns.iter().flatten().all(|turn| turn.processor_ms >= 0.0));
    }

    #[test]
    fn some_runs_of_rays() {
        for (rays, step, count, last) in [(1000, 1, 1000, 999), (1000, 3, 5 * 64 + 40, 999), (990, 5, 4 * 64 - 34, 989), (0, 4, 0, 0)] {
            let answers = Answers { hits: Vec::new(), step };
            assert_eq!(Answers::count(rays, step), count, "{rays} rays, one run of {step}");
            assert_eq!(answers.ray(count.saturating_sub(1)), last);
        }
        assert_eq!([63, 64, 130].map(|answer| Answers { hits: Vec::new(), step: 3 }.ray(answer)), [63, 192, 386]);
    }

    #[test]
    fn any_hits_as_hits() {
        let hits = occluded(&[1, 0, gridwalk::UNFINISHED]);
        assert!(hits[0].is_hit() && hits[1] == Hit::MISS && hits[2].triangle == gridwalk::UNFINISHED);
    }
}
