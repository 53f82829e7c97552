//! Finds what a plan's barriers do not order: a walk over the steps as the device may run them.

use gridwalk_core::kernel::Access;

use crate::plan::{Barrier, Buffer, Dispatch, Item, Plan, Step};

/// An access that nothing orders after an earlier one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Hazard {
    /// Index of the step among the plan's items.
    pub item: usize,
    /// Kernel of the step.
    pub kernel: &'static str,
    /// The memory.
    pub buffer: Buffer,
    /// What is not ordered.
    pub kind: HazardKind,
}

/// Kinds of hazards.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HazardKind {
    /// Read before an earlier write is visible.
    ReadAfterWrite,
    /// Written while an earlier read may still run.
    WriteAfterRead,
    /// Written while an earlier write may still run.
    WriteAfterWrite,
    /// Indirect arguments read before their write is visible to indirect dispatches.
    StaleArguments,
}

#[derive(Clone, Copy, Default)]
struct Pending {
    read: bool,
    written: bool,
    /// Written and made visible to shaders, but not to indirect dispatches.
    hidden_from_indirect: bool,
}

/// The first hazard of plans that run one after another with a full barrier (the library's documented one) between each two.
pub fn find_hazard<'a>(plans: impl IntoIterator<Item = &'a Plan>) -> Option<Hazard> {
    plans.into_iter().find_map(|plan| find_hazard_in(plan.items()))
}

/// The first hazard of a list of items that begins and ends with a full barrier.
pub fn find_hazard_in(items: &[Item]) -> Option<Hazard> {
    let mut pending = [Pending::default(); Buffer::ALL.len()];
    for (index, item) in items.iter().enumerate() {
        let step = match item {
            Item::Barrier(barrier) => {
                for state in &mut pending {
                    let hidden = (state.written || state.hidden_from_indirect) && *barrier == Barrier::Shader;
                    *state = Pending { hidden_from_indirect: hidden, ..Pending::default() };
                }
                continue;
            }
            Item::Step(step) => step,
        };
        let hazard = |buffer, kind| Some(Hazard { item: index, kernel: step.kernel.name, buffer, kind });
        if let Dispatch::Indirect(buffer, _) = step.dispatch {
            let state = &pending[buffer as usize];
            if state.written || state.hidden_from_indirect {
                return hazard(buffer, HazardKind::StaleArguments);
            }
        }
        for (buffer, kind) in accesses(step) {
            let state = pending[buffer as usize];
            if kind.reads() && state.written {
                return hazard(buffer, HazardKind::ReadAfterWrite);
            }
            if kind.writes() && state.written {
                return hazard(buffer, HazardKind::WriteAfterWrite);
            }
            if kind.writes() && state.read {
                return hazard(buffer, HazardKind::WriteAfterRead);
            }
        }
        for (buffer, kind) in accesses(step) {
            let state = &mut pending[buffer as usize];
            state.read |= kind.reads();
            state.written |= kind.writes();
        }
        if let Dispatch::Indirect(buffer, _) = step.dispatch {
            pending[buffer as usize].read = true;
        }
    }
    None
}

/// The parts of a grid that its header leads to.
const BEHIND_HEADER: [Buffer; 4] = [Buffer::Cells, Buffer::References, Buffer::Triangles, Buffer::Bricks];

/// What a step reads and writes: by its own qualifiers; and a kernel that traces rays, all of the grid whose header it is given.
fn accesses(step: &Step) -> impl Iterator<Item = (Buffer, Access)> + '_ {
    let own = step.kernel.accesses.iter().enumerate().map(|(access, (_, kind))| (step.buffer(access), *kind));
    let traces = own.clone().any(|(buffer, _)| buffer == Buffer::Rays);
    own.chain(BEHIND_HEADER.into_iter().filter(move |_| traces).map(|buffer| (buffer, Access::Read)))
}
