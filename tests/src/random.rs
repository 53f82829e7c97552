//! Random numbers with a seed that a failing test can name.

/// SplitMix64 (Steele, Lea and Flood 2014).
#[derive(Clone, Debug)]
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Random {
        Random(seed)
    }

    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// In [0, limit).
    pub fn below(&mut self, limit: u32) -> u32 {
        ((u64::from((self.bits() >> 32) as u32) * u64::from(limit)) >> 32) as u32
    }

    /// In [0, 1).
    pub fn unit(&mut self) -> f32 {
        (self.bits() >> 40) as f32 / (1 << 24) as f32
    }

    /// In [low, high).
    pub fn range(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.unit()
    }

    /// In the box [low, high)^3.
    pub fn point(&mut self, low: f32, high: f32) -> [f32; 3] {
        [self.range(low, high), self.range(low, high), self.range(low, high)]
    }

    /// Of unit length.
    pub fn direction(&mut self) -> [f32; 3] {
        loop {
            let p = self.point(-1.0, 1.0);
            let length = (p[0] * p[0] + p[1] * p[1] + p[2] * p[2]).sqrt();
            if length > 0.01 && length <= 1.0 {
                return p.map(|x| x / length);
            }
        }
    }
}
