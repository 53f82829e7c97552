//! Rivals that run on the host's processors: a query a ray, on threads that share the rays.

use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

use anyhow::{Context as _, Result};
use gridwalk::{Hit, Ray};

use crate::contender::{Answers, Contender, Query, Set, Tree, occluded};

/// A library that makes trees of one mesh.
pub trait Library {
    /// What it makes.
    type Tree: HostTree;

    /// As the report has it.
    fn name(&self) -> &'static str;

    /// Threads of the queries.
    fn threads(&self) -> u32;

    /// Makes a tree, built and ready to trace.
    ///
    /// # Errors
    /// What the library reports.
    fn tree(&self, tree: Tree) -> Result<Self::Tree>;
}

/// A tree that was built.
pub trait HostTree: Sync {
    /// Builds it again as if all vertices had moved; returns the milliseconds.
    ///
    /// # Errors
    /// What the library reports.
    fn rebuild(&mut self) -> Result<f64>;

    /// The closest hit of a ray.
    fn closest(&self, ray: &Ray) -> Hit;

    /// Whether a ray hits anything.
    fn any(&self, ray: &Ray) -> bool;

    /// Bytes that it takes, where that is known.
    fn bytes(&self) -> Option<u64>;
}

/// A library as one of the contenders.
pub struct HostRival<L: Library> {
    rival: L,
    tree: Option<L::Tree>,
    sets: Vec<(Arc<Set>, Found)>,
}

enum Found {
    Closest(Vec<Hit>),
    Any(Vec<u32>),
}

impl<L: Library> HostRival<L> {
    /// A rival without a tree.
    pub fn new(library: L) -> HostRival<L> {
        HostRival { rival: library, tree: None, sets: Vec::new() }
    }
}

const NO_TREE: &str = "no tree was prepared";

impl<L: Library> Contender for HostRival<L> {
    fn name(&self) -> &'static str {
        self.rival.name()
    }

    fn prepare(&mut self, tree: Tree) -> Result<()> {
        self.tree = None;
        self.tree = Some(self.rival.tree(tree)?);
        Ok(())
    }

    fn rebuild(&mut self) -> Result<f64> {
        self.tree.as_mut().context(NO_TREE)?.rebuild()
    }

    fn load(&mut self, sets: &[Arc<Set>]) -> Result<()> {
        let room = |set: &Arc<Set>| match set.query {
            Query::Closest => Found::Closest(vec![Hit::MISS; set.rays.len()]),
            Query::Any => Found::Any(vec![0; set.rays.len()]),
        };
        self.sets = sets.iter().map(|set| (Arc::clone(set), room(set))).collect();
        Ok(())
    }

    fn trace(&mut self, set: usize) -> Result<f64> {
        let tree = self.tree.as_ref().context(NO_TREE)?;
        let threads = self.rival.threads();
        Ok(match self.sets.get_mut(set) {
            Some((set, Found::Closest(hits))) => ask(threads, &set.rays, hits, |ray| tree.closest(ray)),
            Some((set, Found::Any(answers))) => ask(threads, &set.rays, answers, |ray| u32::from(tree.any(ray))),
            None => 0.0,
        })
    }

    fn answers(&mut self, set: usize) -> Result<Answers> {
        let hits = match self.sets.get(set) {
            Some((_, Found::Closest(hits))) => hits.clone(),
            Some((_, Found::Any(answers))) => occluded(answers),
            None => Vec::new(),
        };
        Ok(Answers { hits, step: 1 })
    }

    fn bytes(&self) -> Option<u64> {
        self.tree.as_ref()?.bytes()
    }
}

/// Rays that a thread takes at once.
const CHUNK: usize = 4096;

/// Asks for each ray, on so many threads; returns the milliseconds.
fn ask<T: Send>(threads: u32, rays: &[Ray], answers: &mut [T], answer: impl Fn(&Ray) -> T + Sync) -> f64 {
    let begin = Instant::now();
    let work = Mutex::new(rays.chunks(CHUNK).zip(answers.chunks_mut(CHUNK)));
    let thread = || {
        loop {
            let Some((rays, answers)) = work.lock().unwrap_or_else(PoisonError::into_inner).next() else { return };
            for (ray, place) in rays.iter().zip(answers) {
                *place = answer(ray);
            }
        }
    };
    std::thread::scope(|scope| {
        for _ in 1..threads {
            scope.spawn(thread);
        }
        thread();
    });
    begin.elapsed().as_secs_f64() * 1e3
}
