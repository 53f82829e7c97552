//! A mesh that morph targets, a skin or a node move, on the device.

use crate::{
    Buffer, BufferDesc, BufferKind, Context, Error, Result, kernels,
    pipeline::{Pipeline, Recorder, map_groups},
    push,
    scene::{Arrays, VertexRange},
};
use gridwalk::gridwalk_core::twin::motion::{ActiveTarget, Influence, NO_DELTAS};
use gridwalk_scene::{Animation, Deformed, Pose};

/// The kernels that move a mesh.
pub(super) struct BendKernels {
    morph: Pipeline,
    skin: Pipeline,
}

impl BendKernels {
    pub(super) fn new(context: &Context) -> Result<BendKernels> {
        Ok(BendKernels { morph: Pipeline::new(context, &kernels::MORPH, &[])?, skin: Pipeline::new(context, &kernels::SKIN, &[])? })
    }
}

/// A deformed mesh: what its kernels read.
#[derive(Debug)]
pub(super) struct Bent {
    positions: Buffer,
    normals: Buffer,
    deltas: Buffer,
    influences: Buffer,
    /// Matrices, then the active targets.
    pose_memory: Buffer,
    /// Positions and normals after the targets; none without targets.
    morphed: Option<[Buffer; 2]>,
    /// Where the deltas of each target begin.
    targets: Vec<ActiveTarget>,
    vertex_count: u32,
    influences_each: u32,
    matrix_count: u32,
    /// The pose to come, and the one that the scene shows.
    pub(super) next: Pose,
    pub(super) shown: Pose,
    active: Vec<ActiveTarget>,
}

/// lavapipe ends loops after 65,535 turns; kernels stay well below.
const MOST_TURNS: u32 = 32_767;

/// Bytes of a matrix of three rows.
const MATRIX_BYTES: u64 = 48;

impl Bent {
    /// Brings a mesh of `vertices` vertices to the device.
    pub(super) fn new(context: &Context, name: &str, vertices: usize, source: &Deformed) -> Result<Bent> {
        let bad = |what: String| Error::Scene { reason: format!("mesh {name}: {what}") };
        let fits = |what: &str, count: usize, expected: usize| {
            if count == expected { Ok(()) } else { Err(bad(format!("{count} {what} of a deformed mesh of {expected}"))) }
        };
        fits("positions", source.positions.len(), vertices)?;
        fits("normals", source.normals.len(), vertices)?;
        let bounded = |what: &str, count: usize, most: u32| {
            u32::try_from(count).ok().filter(|&count| count <= most).ok_or_else(|| bad(format!("{count} {what}; {most} are possible")))
        };
        let vertex_count = bounded("vertices", vertices, gridwalk::MAX_VERTICES)?;
        let influences_each = if source.influences.is_empty() { 0 } else { source.influences_each };
        bounded("influences a vertex", influences_each as usize, MOST_TURNS)?;
        fits("influences", source.influences.len(), vertices.saturating_mul(influences_each as usize))?;
        if source.matrix_count == 0 {
            return Err(bad("a deformed mesh without a matrix".to_owned()));
        }
        if let Some(influence) = source.influences.iter().find(|influence| influence.joint >= source.matrix_count) {
            return Err(bad(format!("joint {} of {}", influence.joint, source.matrix_count)));
        }
        let influences: Vec<Influence> =
            source.influences.iter().map(|influence| Influence { joint: influence.joint, weight: influence.weight }).collect();

        bounded("morph targets", source.targets.len(), MOST_TURNS)?;
        let mut deltas: Vec<[f32; 3]> = Vec::new();
        let mut place = |what: &str, of_target: &[[f32; 3]]| {
            if of_target.is_empty() {
                return Ok::<u32, Error>(NO_DELTAS);
            }
            fits(what, of_target.len(), vertices)?;
            let begin = deltas.len().saturating_mul(3);
            bounded("words of morph targets", begin.saturating_add(vertices.saturating_mul(3)), i32::MAX as u32)?;
            deltas.extend_from_slice(of_target);
            // In range, as its end is.
            Ok(begin as u32)
        };
        let targets = source
            .targets
            .iter()
            .map(|target| {
                let positions = place("positions of a morph target", &target.positions)?;
                let normals = place("normals of a morph target", &target.normals)?;
                Ok(ActiveTarget { positions, normals, weight: 0.0, reserved: 0 })
            })
            .collect::<Result<Vec<_>>>()?;
        let buffer = |name, size| context.buffer(&BufferDesc { name, size, kind: BufferKind::Device, dedicated: false });
        let vertex_bytes = u64::from(vertex_count) * 12;
        let morphed = if targets.is_empty() {
            None
        } else {
            Some([buffer("morphed positions", vertex_bytes)?, buffer("morphed normals", vertex_bytes)?])
        };
        let pose_bytes = u64::from(source.matrix_count) * MATRIX_BYTES + (targets.len() * size_of::<ActiveTarget>()) as u64;
        Ok(Bent {
            positions: context.upload("base positions", &source.positions)?,
            normals: context.upload("base normals", &source.normals)?,
            deltas: context.upload("morph deltas", &deltas)?,
            influences: context.upload("influences", &influences)?,
            pose_memory: buffer("pose", pose_bytes)?,
            morphed,
            active: Vec::with_capacity(targets.len()),
            targets,
            vertex_count,
            influences_each,
            matrix_count: source.matrix_count,
            next: Pose::default(),
            shown: Pose::default(),
        })
    }

    /// Checks the pose to come, and lists the targets that count in it.
    pub(super) fn prepare(&mut self, name: &str) -> Result<()> {
        let Pose { matrices, weights } = &self.next;
        if matrices.len() != self.matrix_count as usize || weights.len() != self.targets.len() {
            return Err(Error::Scene {
                reason: format!(
                    "mesh {name}: a pose of {} matrices and {} weights; it has {} and {}",
                    matrices.len(),
                    weights.len(),
                    self.matrix_count,
                    self.targets.len()
                ),
            });
        }
        self.active.clear();
        let counting = self.targets.iter().zip(weights).filter(|(_, weight)| **weight != 0.0);
        self.active.extend(counting.map(|(target, &weight)| ActiveTarget { weight, ..*target }));
        Ok(())
    }

    /// Bytes and places of what [`Bent::record`] reads of the pose.
    pub(super) fn pose_parts(&self) -> [(&Buffer, u64, &[u8]); 2] {
        let targets = u64::from(self.matrix_count) * MATRIX_BYTES;
        let matrices = self.next.matrices.as_flattened();
        [(&self.pose_memory, 0, bytemuck::cast_slice(matrices)), (&self.pose_memory, targets, bytemuck::cast_slice(&self.active))]
    }

    /// Records the kernels that make the mesh's vertices in the scene's arrays, after the pose was brought there.
    pub(super) fn record(&self, recorder: &mut Recorder<'_>, kernels: &BendKernels, arrays: &Arrays, range: &VertexRange) {
        let (mut positions, mut normals) = (self.positions.address(), self.normals.address());
        if let (Some([to_positions, to_normals]), false) = (&self.morphed, self.active.is_empty()) {
            let push = push::Morph {
                base_positions: positions,
                base_normals: normals,
                deltas: self.deltas.address(),
                targets: self.pose_memory.address() + u64::from(self.matrix_count) * MATRIX_BYTES,
                positions: to_positions.address(),
                normals: to_normals.address(),
                vertex_count: self.vertex_count,
                target_count: self.active.len() as u32,
            };
            recorder.dispatch(&kernels.morph, &push, map_groups(self.vertex_count));
            (positions, normals) = (to_positions.address(), to_normals.address());
        }
        let push = push::Skin {
            base_positions: positions,
            base_normals: normals,
            influences: self.influences.address(),
            matrices: self.pose_memory.address(),
            positions: arrays.positions.address() + u64::from(range.first) * 12,
            normals: arrays.normals.address() + u64::from(range.first) * 12,
            vertex_count: self.vertex_count,
            influences_each: self.influences_each,
        };
        recorder.dispatch(&kernels.skin, &push, map_groups(self.vertex_count));
    }
}

/// A mesh of key-frames that moves as a whole: a matrix after the interpolation.
#[derive(Debug)]
pub(super) struct Placing {
    pose_memory: Buffer,
    /// The pose to come, and the one that the scene shows.
    pub(super) next: Pose,
    pub(super) shown: Pose,
}

impl Placing {
    /// Of a mesh of an animation; `None` where no matrix moves it.
    pub(super) fn new(context: &Context, animation: &Animation, mesh: usize) -> Result<Option<Placing>> {
        let mut next = Pose::default();
        animation.pose(mesh, 0.0, &mut next);
        if next.matrices.is_empty() {
            return Ok(None);
        }
        let desc = BufferDesc { name: "pose", size: MATRIX_BYTES, kind: BufferKind::Device, dedicated: false };
        Ok(Some(Placing { pose_memory: context.buffer(&desc)?, next, shown: Pose::default() }))
    }

    /// Bytes and place of what [`Placing::record`] reads of the pose.
    pub(super) fn pose_part(&self) -> (&Buffer, u64, &[u8]) {
        (&self.pose_memory, 0, bytemuck::cast_slice(self.next.matrices.get(..1).unwrap_or_default().as_flattened()))
    }

    /// Records the kernel that moves the mesh's vertices in the scene's arrays where they are: each is read before it is written.
    pub(super) fn record(&self, recorder: &mut Recorder<'_>, kernels: &BendKernels, arrays: &Arrays, range: &VertexRange, count: u32) {
        let first = u64::from(range.first) * 12;
        let (positions, normals) = (arrays.positions.address() + first, arrays.normals.address() + first);
        let push = push::Skin {
            base_positions: positions,
            base_normals: normals,
            influences: self.pose_memory.address(),
            matrices: self.pose_memory.address(),
            positions,
            normals,
            vertex_count: count,
            influences_each: 0,
        };
        recorder.dispatch(&kernels.skin, &push, map_groups(count));
    }
}
