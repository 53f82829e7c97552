//! The layers of a picture, by their names.

/// A layer that can be asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Aov {
    Beauty,
    Z,
    N,
    Ng,
    P,
    Albedo,
    Uv,
    Id,
    Debug,
}

impl Aov {
    /// All of them, in the order in which they are listed.
    pub const ALL: [Aov; 9] = [Aov::Beauty, Aov::Z, Aov::N, Aov::Ng, Aov::P, Aov::Albedo, Aov::Uv, Aov::Id, Aov::Debug];

    /// The name of the layer.
    pub const fn name(self) -> &'static str {
        match self {
            Aov::Beauty => "beauty",
            Aov::Z => "Z",
            Aov::N => "N",
            Aov::Ng => "Ng",
            Aov::P => "P",
            Aov::Albedo => "albedo",
            Aov::Uv => "uv",
            Aov::Id => "id",
            Aov::Debug => "debug",
        }
    }

    /// Its channels in an EXR, and what they hold.
    pub const fn description(self) -> &'static str {
        match self {
            Aov::Beauty => "R G B A: the picture, linear",
            Aov::Z => "Z: distance along the ray, infinite where nothing is (also: depth)",
            Aov::N => "N.X N.Y N.Z: shading normal (also: normal)",
            Aov::Ng => "Ng.X Ng.Y Ng.Z: geometric normal (also: geometric_normal)",
            Aov::P => "P.X P.Y P.Z: position (also: position)",
            Aov::Albedo => "albedo.R albedo.G albedo.B: diffuse colour without light",
            Aov::Uv => "uv.U uv.V: texture coordinates",
            Aov::Id => "id.prim id.mesh id.material: integers, 4294967295 where nothing is (also: prim_id, mesh_id, material_id)",
            Aov::Debug => "debug.steps debug.tests debug.cells: the cost of the camera ray (also: steps, tests, cells)",
        }
    }
}
