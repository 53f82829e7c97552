//! From linear light to what a display shows.

/// How linear colours above the display's range are brought into it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Tonemap {
    /// Cut off at one.
    #[default]
    None,
    /// Luminance L to L / (1 + L) (Reinhard et al. 2002, equation 3).
    Reinhard,
    /// The fit by Stephen Hill of the ACES reference rendering and output transforms.
    Aces,
    /// AgX by Troy Sobotka, in the polynomial form by Benjamin Wrensch.
    Agx,
    /// The Khronos PBR neutral tone mapper (2024): base colours come out as they went in.
    Neutral,
}

/// Far brighter than any light, and its square is still a number.
const BRIGHTEST: f32 = 1e15;

/// Luminance weights of Rec. 709.
pub(super) const LUMINANCE: [f32; 3] = [0.2126, 0.7152, 0.0722];

impl Tonemap {
    /// All of them, in the order in which they are listed.
    pub const ALL: [Tonemap; 5] = [Tonemap::None, Tonemap::Reinhard, Tonemap::Aces, Tonemap::Agx, Tonemap::Neutral];

    /// The name used in options.
    pub const fn name(self) -> &'static str {
        match self {
            Tonemap::None => "none",
            Tonemap::Reinhard => "reinhard",
            Tonemap::Aces => "aces",
            Tonemap::Agx => "agx",
            Tonemap::Neutral => "neutral",
        }
    }

    /// What it does, in one line.
    pub const fn description(self) -> &'static str {
        match self {
            Tonemap::None => "linear, cut off at one",
            Tonemap::Reinhard => "L / (1 + L) on the luminance",
            Tonemap::Aces => "filmic: the fit of the ACES transforms by Hill",
            Tonemap::Agx => "filmic, bright colours lose saturation as on film",
            Tonemap::Neutral => "Khronos PBR neutral: keeps base colours, compresses highlights only",
        }
    }

    /// The tone map of this name.
    pub fn from_name(name: &str) -> Option<Tonemap> {
        Tonemap::ALL.into_iter().find(|tonemap| tonemap.name() == name)
    }

    /// Maps a linear scene colour (Rec. 709 primaries) to a linear display colour in 0 to 1. Not-a-number and negative values count as 0,
    /// infinity as very bright.
    #[expect(clippy::manual_clamp, reason = "clamp hands a NaN on, max does not")]
    pub fn apply(self, color: [f32; 3]) -> [f32; 3] {
        let color = color.map(|value| value.max(0.0).min(BRIGHTEST));
        let mapped = match self {
            Tonemap::None => color,
            Tonemap::Reinhard => {
                let scale = 1.0 / (1.0 + dot(LUMINANCE, color));
                color.map(|value| value * scale)
            }
            Tonemap::Aces => aces(color),
            Tonemap::Agx => agx(color),
            Tonemap::Neutral => neutral(color),
        };
        mapped.map(|value| value.clamp(0.0, 1.0))
    }
}

fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn transform(rows: &[[f32; 3]; 3], color: [f32; 3]) -> [f32; 3] {
    [dot(rows[0], color), dot(rows[1], color), dot(rows[2], color)]
}

fn aces(color: [f32; 3]) -> [f32; 3] {
    const FROM_SRGB: [[f32; 3]; 3] = [[0.59719, 0.35458, 0.04823], [0.07600, 0.90834, 0.01566], [0.02840, 0.13383, 0.83777]];
    const TO_SRGB: [[f32; 3]; 3] = [[1.60475, -0.53108, -0.07367], [-0.10208, 1.10813, -0.00605], [-0.00327, -0.07276, 1.07602]];
    let curve = |v: f32| (v * (v + 0.024_578_6) - 0.000_090_537) / (v * (0.983_729 * v + 0.432_951) + 0.238_081);
    transform(&TO_SRGB, transform(&FROM_SRGB, color).map(curve))
}

fn agx(color: [f32; 3]) -> [f32; 3] {
    const INSET: [[f32; 3]; 3] =
        [[0.842_479_06, 0.078_433_6, 0.079_223_745], [0.042_328_242, 0.878_468_64, 0.079_166_13], [0.042_375_655, 0.078_433_6, 0.879_143]];
    const OUTSET: [[f32; 3]; 3] = [
        [1.196_879, -0.098_020_88, -0.099_029_74],
        [-0.052_896_85, 1.151_903_1, -0.098_961_18],
        [-0.052_971_635, -0.098_043_45, 1.151_073_7],
    ];
    const EV_MIN: f32 = -12.473_93;
    const EV_MAX: f32 = 4.026_069;
    // Fit of the sigmoid over the logarithm, sixth order.
    let sigmoid = |value: f32| {
        let x = (value.max(1e-10).log2().clamp(EV_MIN, EV_MAX) - EV_MIN) / (EV_MAX - EV_MIN);
        let x2 = x * x;
        let x4 = x2 * x2;
        15.5 * x4 * x2 - 40.14 * x4 * x + 31.96 * x4 - 6.868 * x2 * x + 0.429_8 * x2 + 0.119_1 * x - 0.002_32
    };
    // The curve ends in display values of gamma 2.2; the caller encodes from linear ones.
    transform(&OUTSET, transform(&INSET, color).map(sigmoid)).map(|value| value.max(0.0).powf(2.2))
}

fn neutral(color: [f32; 3]) -> [f32; 3] {
    const START: f32 = 0.8 - 0.04;
    const DESATURATION: f32 = 0.15;
    let least = color[0].min(color[1]).min(color[2]);
    let offset = if least < 0.08 { least - 6.25 * least * least } else { 0.04 };
    let color = color.map(|value| value - offset);
    let peak = color[0].max(color[1]).max(color[2]);
    if peak < START {
        return color;
    }
    let room = 1.0 - START;
    let new_peak = 1.0 - room * room / (peak + room - START);
    let white = 1.0 - 1.0 / (DESATURATION * (peak - new_peak) + 1.0);
    color.map(|value| {
        let value = value * (new_peak / peak);
        value + (new_peak - value) * white
    })
}

/// The sRGB curve (IEC 61966-2-1): linear light to the value that is stored.
pub fn srgb_encode(linear: f32) -> f32 {
    if linear <= 0.003_130_8 { linear * 12.92 } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

/// The inverse of [`srgb_encode`].
pub fn srgb_decode(stored: f32) -> f32 {
    if stored <= 0.040_45 { stored / 12.92 } else { ((stored + 0.055) / 1.055).powf(2.4) }
}

/// [`srgb_encode`], rounded to eight bits; not-a-number becomes 0.
pub fn srgb_encode_u8(linear: f32) -> u8 {
    // Float to integer saturates, and takes NaN to 0.
    (srgb_encode(linear.clamp(0.0, 1.0)) * 255.0 + 0.5) as u8
}
