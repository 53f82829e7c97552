//! How many frames a second.

use std::fmt;
use std::str::FromStr;

/// Frames a second, as a fraction in lowest terms: films run at 24000/1001, not at 23.976.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rate {
    numerator: u32,
    denominator: u32,
}

/// Largest denominator that a decimal number is taken for.
const MAX_DENOMINATOR: u32 = 1_000_000;

impl Rate {
    /// One frame a second.
    pub const ONE: Rate = Rate { numerator: 1, denominator: 1 };

    /// A rate of `numerator / denominator` frames a second; `None` when either is 0.
    pub fn new(numerator: u32, denominator: u32) -> Option<Rate> {
        let divisor = gcd(numerator.into(), denominator.into());
        if numerator == 0 || denominator == 0 {
            return None;
        }
        Some(Rate { numerator: (u64::from(numerator) / divisor) as u32, denominator: (u64::from(denominator) / divisor) as u32 })
    }

    /// The fraction that a number stands for: a whole number, the rates of television (23.976, 29.97, 59.94 and the like, over 1001), else
    /// the nearest fraction with a denominator of at most a million. `None` outside of 0.001 to 1,000.
    pub fn from_number(number: f64) -> Option<Rate> {
        if !(0.001..=1000.0).contains(&number) {
            return None;
        }
        let television = (number * 1.001).round();
        if number.fract() != 0.0 && television >= 6.0 && television % 6.0 == 0.0 && (television * 1000.0 / 1001.0 - number).abs() < 0.005 {
            return Rate::new((television * 1000.0) as u32, 1001);
        }
        // Convergents of the continued fraction.
        let (mut before, mut now) = ((0_u64, 1_u64), (1_u64, 0_u64));
        let mut rest = number;
        for _ in 0..32 {
            let whole = rest.floor();
            // Saturated ones are beyond the largest denominator.
            let follow = |now: u64, before: u64| (whole as u64).saturating_mul(now).saturating_add(before);
            let next = (follow(now.0, before.0), follow(now.1, before.1));
            if next.1 > MAX_DENOMINATOR.into() {
                break;
            }
            (before, now) = (now, next);
            if (rest - whole) < 1e-9 || ((now.0 as f64 / now.1 as f64) - number).abs() < 1e-9 * number {
                break;
            }
            rest = 1.0 / (rest - whole);
        }
        Rate::new(u32::try_from(now.0).ok()?, u32::try_from(now.1).ok()?)
    }

    /// Frames in [`Rate::denominator`] seconds.
    pub const fn numerator(self) -> u32 {
        self.numerator
    }

    /// Seconds in which there are [`Rate::numerator`] frames.
    pub const fn denominator(self) -> u32 {
        self.denominator
    }

    /// Frames a second.
    pub fn per_second(self) -> f64 {
        f64::from(self.numerator) / f64::from(self.denominator)
    }

    /// The time of a frame in seconds; frame 0 is at 0.
    pub fn time(self, frame: u64) -> f64 {
        frame as f64 * f64::from(self.denominator) / f64::from(self.numerator)
    }

    /// The rate of every `step`th frame; `None` when the fraction has no room for it, or of step 0.
    pub fn every(self, step: u32) -> Option<Rate> {
        let divisor = gcd(self.numerator.into(), step.into()).max(1);
        let denominator = u64::from(self.denominator) * (u64::from(step) / divisor);
        Rate::new((u64::from(self.numerator) / divisor) as u32, u32::try_from(denominator).ok()?)
    }
}

const fn gcd(mut a: u64, mut b: u64) -> u64 {
    while b != 0 {
        (a, b) = (b, a % b);
    }
    a
}

impl fmt::Display for Rate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.denominator == 1 { write!(f, "{}", self.numerator) } else { write!(f, "{}/{}", self.numerator, self.denominator) }
    }
}

impl FromStr for Rate {
    type Err = &'static str;

    /// `24`, `23.976`, `24000/1001`.
    fn from_str(text: &str) -> Result<Rate, &'static str> {
        let rate = match text.split_once('/') {
            Some((numerator, denominator)) => match (numerator.trim().parse(), denominator.trim().parse()) {
                (Ok(numerator), Ok(denominator)) => Rate::new(numerator, denominator),
                _ => None,
            },
            None => text.trim().parse().ok().and_then(Rate::from_number),
        };
        rate.ok_or("write frames a second as 24, 23.976 or 24000/1001")
    }
}

#[cfg(test)]
mod tests {
    use super::Rate;

    #[test]
    fn fractions_of_numbers() {
        let text = |number: f64| Rate::from_number(number).map(|rate| rate.to_string());
        for (number, expected) in [
            (24.0, "24"),
            (23.976, "24000/1001"),
            (23.98, "24000/1001"),
            (29.97, "30000/1001"),
            (59.94, "60000/1001"),
            (119.88, "120000/1001"),
            (12.5, "25/2"),
            (0.1, "1/10"),
            (1.0 / 3.0, "1/3"),
            (15.015, "3003/200"),
        ] {
            assert_eq!(text(number).as_deref(), Some(expected), "{number}");
        }
        for number in [0.0, -24.0, f64::NAN, f64::INFINITY, 1e9, 1e-9] {
            assert_eq!(text(number), None, "{number}");
        }
        for number in [std::f64::consts::PI, 47.952_047, 1.234_567_8, 0.001_234, 999.99] {
            let rate = Rate::from_number(number).map_or(0.0, Rate::per_second);
            assert!((rate / number - 1.0).abs() < 1e-6, "{number} became {rate}");
        }
    }

    #[test]
    fn steps_and_times() {
        let rate = |text: &str| text.parse::<Rate>().ok();
        assert_eq!(rate("24").and_then(|rate| rate.every(2)), rate("12"));
        assert_eq!(rate("24000/1001").and_then(|rate| rate.every(5)), rate("4800/1001"));
        assert_eq!(rate("25").and_then(|rate| rate.every(2)), rate("12.5"));
        assert_eq!(rate("25").and_then(|rate| rate.every(0)), None);
        assert_eq!(rate("1/4294967295").and_then(|rate| rate.every(2)), None);
        assert_eq!(rate("25").map(|rate| rate.time(50)), Some(2.0));
        assert_eq!(rate("24000/1001").map(|rate| rate.time(24_000)), Some(1001.0));
        for wrong in ["", "0", "x", "1/0", "0/1", "24/", "-1", "1/2/3", "nan"] {
            assert_eq!(rate(wrong), None, "{wrong}");
        }
    }
}
