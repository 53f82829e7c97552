//! Cameras, lights and meshes that a scene file moves.

use crate::curve::Curve;
use crate::transform::Transform;
use crate::vector::{Vector, add, cross, dot, normalised, scale, single, sub};
use crate::{Camera, Deformed, Light, Mesh, Pose};

/// A camera with keys.
#[derive(Clone, Debug)]
pub(crate) struct CameraCurve {
    curve: Curve<11>,
    orthographic: bool,
}

/// Numbers of a camera in a curve: eye, target, up, angle, height.
pub(crate) fn camera_values(camera: &Camera) -> [f64; 11] {
    let mut values = [0.0; 11];
    values[..3].copy_from_slice(&camera.eye.map(f64::from));
    values[3..6].copy_from_slice(&camera.target.map(f64::from));
    values[6..9].copy_from_slice(&camera.up.map(f64::from));
    values[9] = f64::from(camera.vertical_fov_degrees);
    values[10] = f64::from(camera.orthographic_height.unwrap_or(0.0));
    values
}

/// Angle and height do not leave those of the keys.
pub(crate) const CAMERA_BOUNDED: [bool; 11] = [false, false, false, false, false, false, false, false, false, true, true];

impl CameraCurve {
    /// The cameras of the keys are sound, and all orthographic or none.
    pub(crate) fn new(curve: Curve<11>, orthographic: bool) -> Self {
        Self { curve, orthographic }
    }

    pub(crate) fn at(&self, time: f64) -> Camera {
        let camera = self.camera(&self.curve.at(time));
        sound(camera, &self.camera(&self.curve.held(time)))
    }

    fn camera(&self, values: &[f64; 11]) -> Camera {
        Camera {
            eye: three(values, 0).map(single),
            target: three(values, 3).map(single),
            up: three(values, 6).map(single),
            vertical_fov_degrees: values[9] as f32,
            orthographic_height: self.orthographic.then_some(values[10] as f32),
        }
    }
}

fn three(values: &[f64], first: usize) -> Vector {
    std::array::from_fn(|axis| values.get(first + axis).copied().unwrap_or(0.0))
}

/// The camera, unless it flies through its own target or comes to look along its up: then it takes from one that does not.
fn sound(mut camera: Camera, other: &Camera) -> Camera {
    let view = |camera: &Camera| normalised(sub(camera.target.map(f64::from), camera.eye.map(f64::from)));
    if view(&camera).is_none() {
        (camera.eye, camera.target) = (other.eye, other.target);
    }
    let Some(view) = view(&camera) else { return *other };
    let across = |up: [f32; 3]| normalised(up.map(f64::from)).map(|up| cross(view, up)).is_some_and(|side| dot(side, side) >= 1e-12);
    let axes = [other.up, [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    if !across(camera.up)
        && let Some(&up) = axes.iter().find(|&&up| across(up))
    {
        camera.up = up;
    }
    camera
}

/// A camera that circles its target.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Turntable {
    /// For one turn; not 0. Above 0 the camera moves to its right, counterclockwise seen from above.
    pub(crate) seconds: f64,
    /// Of length one.
    pub(crate) axis: Vector,
}

impl Turntable {
    /// `start` is the camera at time 0.
    pub(crate) fn at(&self, start: &Camera, time: f64) -> Camera {
        let turns = (if time.is_finite() { time } else { 0.0 } / self.seconds).rem_euclid(1.0);
        // A whole turn is none, bit for bit.
        if turns.min(1.0 - turns) < 1e-9 {
            return *start;
        }
        let (sine, cosine) = (std::f64::consts::TAU * turns).sin_cos();
        let turned = |vector: Vector| {
            let along = scale(self.axis, dot(self.axis, vector) * (1.0 - cosine));
            add(add(scale(vector, cosine), scale(cross(self.axis, vector), sine)), along)
        };
        let target = start.target.map(f64::from);
        let eye = add(target, turned(sub(start.eye.map(f64::from), target)));
        let camera = Camera { eye: eye.map(single), up: turned(start.up.map(f64::from)).map(single), ..*start };
        sound(camera, start)
    }
}

/// A light with keys.
#[derive(Clone, Debug)]
pub(crate) struct LightCurve {
    curve: Curve<9>,
    /// Whether the second three numbers are what the light looks at, rather than where it goes.
    aimed: bool,
}

/// Intensities and irradiances do not leave those of the keys.
pub(crate) const LIGHT_BOUNDED: [bool; 9] = [false, false, false, false, false, false, true, true, true];

impl LightCurve {
    /// Numbers of a key: position, direction or target, intensity or irradiance.
    pub(crate) fn new(curve: Curve<9>, aimed: bool) -> Self {
        Self { curve, aimed }
    }

    /// A light of the kind of `like`.
    pub(crate) fn at(&self, like: &Light, time: f64) -> Light {
        let values = self.curve.at(time);
        let place = three(&values, 0).map(single);
        let power = three(&values, 6).map(single);
        let way = |values: &[f64; 9]| normalised(if self.aimed { sub(three(values, 3), three(values, 0)) } else { three(values, 3) });
        // Half-way between two opposite directions there is none.
        let towards =
            |other: [f32; 3]| way(&values).or_else(|| way(&self.curve.held(time))).map_or(other, |way| way.map(|value| value as f32));
        match *like {
            Light::Point { .. } => Light::Point { position: place, intensity: power },
            Light::Directional { direction, .. } => Light::Directional { direction: towards(direction), irradiance: power },
            Light::Spot { direction, inner_degrees, outer_degrees, .. } => {
                Light::Spot { position: place, direction: towards(direction), intensity: power, inner_degrees, outer_degrees }
            }
        }
    }
}

/// A mesh whose place has keys: translation, degrees about the axes, scale.
#[derive(Clone, Debug)]
pub(crate) struct PlacedCurve(Curve<9>);

/// Scales do not leave those of the keys, which have one sign.
pub(crate) const PLACED_BOUNDED: [bool; 9] = [false, false, false, false, false, false, true, true, true];

impl PlacedCurve {
    pub(crate) fn new(curve: Curve<9>) -> Self {
        Self(curve)
    }

    fn transform(&self, time: f64) -> Transform {
        let values = self.0.at(time);
        Transform::new(three(&values, 6), three(&values, 3), three(&values, 0))
    }

    pub(crate) fn pose(&self, time: f64, pose: &mut Pose) {
        pose.weights.clear();
        pose.matrices.clear();
        pose.matrices.push(self.transform(time).matrix());
    }

    /// Takes a mesh in its own space to its place at time 0, and tells what moves it from there on.
    pub(crate) fn deform(&self, mesh: &mut Mesh) -> Deformed {
        let base = Deformed { positions: mesh.positions.clone(), normals: mesh.normals.clone(), matrix_count: 1, ..Deformed::default() };
        self.transform(0.0).apply(mesh);
        base
    }

    /// Whether it mirrors the mesh, which it does always or never.
    pub(crate) fn is_mirrored(&self) -> bool {
        self.transform(0.0).is_mirrored()
    }

    /// Takes a key-frame to its place at time 0. Of one that will be mirrored the winding is turned already.
    pub(crate) fn place(&self, mesh: &mut Mesh) {
        let indices = std::mem::take(&mut mesh.indices);
        self.transform(0.0).apply(mesh);
        mesh.indices = indices;
    }

    pub(crate) fn curve(&self) -> &Curve<9> {
        &self.0
    }
}
