//! Values that are given at some times, and what they are in between.

/// How far from a key, in seconds, a time still counts as the key's: far above what is lost by computing a frame's time.
const SNAP: f64 = 1e-7;

/// What happens between two keys.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Interpolation {
    /// The first one's value until the second one's time.
    Step,
    /// Along a straight line.
    Linear,
    /// Along a curve without corners through all keys (Catmull and Rom 1974, with the slopes of uneven times).
    #[default]
    Smooth,
}

/// `N` values at each of some times.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Curve<const N: usize> {
    /// Rising, from 0 or above; one or more.
    times: Vec<f64>,
    /// One a time.
    values: Vec<[f64; N]>,
    interpolation: Interpolation,
    looped: bool,
    /// Values that stay between those of the two keys: sizes and strengths, which must not fall below 0 on the way.
    bounded: [bool; N],
}

impl<const N: usize> Curve<N> {
    /// `None` where times do not rise from 0 or above, or where there is no key.
    pub(crate) fn new(keys: Vec<(f64, [f64; N])>, interpolation: Interpolation, looped: bool, bounded: [bool; N]) -> Option<Self> {
        let (times, values): (Vec<f64>, Vec<[f64; N]>) = keys.into_iter().unzip();
        let rising = times.first().is_some_and(|&first| first >= 0.0) && times.windows(2).all(|pair| pair[0] < pair[1]);
        rising.then_some(Self { times, values, interpolation, looped, bounded })
    }

    /// When the last key is, after which a curve that loops begins anew.
    pub(crate) fn seconds(&self) -> f64 {
        self.times.last().copied().unwrap_or(0.0)
    }

    pub(crate) fn looped(&self) -> bool {
        self.looped && self.seconds() > 0.0
    }

    /// The values at a time. Before the first key they are the first one's, after the last one the last one's.
    pub(crate) fn at(&self, time: f64) -> [f64; N] {
        let (before, time) = self.locate(time);
        let (from, to) = (self.value(before), self.value(before + 1));
        let (Some(&begin), Some(&end)) = (self.times.get(before), self.times.get(before + 1)) else { return from };
        let length = end - begin;
        let s = (time - begin) / length;
        if time - begin < SNAP || self.interpolation == Interpolation::Step {
            return from;
        }
        let (slope_from, slope_to) = (self.slope(before), self.slope(before + 1));
        std::array::from_fn(|axis| {
            let (a, b) = (from[axis], to[axis]);
            if self.interpolation == Interpolation::Linear || a == b && self.bounded[axis] {
                return a + (b - a) * s;
            }
            // Hermite's cubic.
            let (m, n) = (slope_from[axis] * length, slope_to[axis] * length);
            let value = a + s * (m + s * (3.0 * (b - a) - 2.0 * m - n + s * (2.0 * (a - b) + m + n)));
            if self.bounded[axis] { value.clamp(a.min(b), a.max(b)) } else { value }
        })
    }

    /// The values of the last key that is not after a time; of the first key where there is none.
    pub(crate) fn held(&self, time: f64) -> [f64; N] {
        self.value(self.locate(time).0)
    }

    fn value(&self, at: usize) -> [f64; N] {
        self.values.get(at).copied().unwrap_or([0.0; N])
    }

    /// The last key that is not after a time, and the time within the curve.
    fn locate(&self, time: f64) -> (usize, f64) {
        let mut time = if time.is_finite() { time } else { 0.0 };
        if self.looped() {
            time = time.rem_euclid(self.seconds());
            if self.seconds() - time < SNAP {
                time = 0.0;
            }
        }
        let after = self.times.partition_point(|&key| key <= time + SNAP);
        (after.saturating_sub(1), time)
    }

    /// Change a second at a key: that from the key before to the key after. A curve that loops goes on at its ends as if the last key were
    /// the first, whatever values they have: an angle may have made a turn.
    fn slope(&self, at: usize) -> [f64; N] {
        let last = self.times.len() - 1;
        let step = |from: usize, to: usize, axis: usize| {
            let time = |at: usize| self.times.get(at).copied().unwrap_or(0.0);
            (self.value(to)[axis] - self.value(from)[axis], time(to) - time(from))
        };
        std::array::from_fn(|axis| {
            let (change, time) = match at {
                _ if last == 0 => return 0.0,
                at if at > 0 && at < last => step(at - 1, at + 1, axis),
                _ if self.looped() => {
                    let (first, last) = (step(0, 1, axis), step(last - 1, last, axis));
                    (first.0 + last.0, first.1 + last.1)
                }
                0 => step(0, 1, axis),
                _ => step(last - 1, last, axis),
            };
            change / time
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve(keys: &[(f64, f64)], interpolation: Interpolation, looped: bool) -> Curve<1> {
        let keys: Vec<(f64, [f64; 1])> = keys.iter().map(|&(time, value)| (time, [value])).collect();
        let none = Curve { times: Vec::new(), values: Vec::new(), interpolation, looped, bounded: [false] };
        Curve::new(keys, interpolation, looped, [false]).unwrap_or(none)
    }

    #[test]
    fn keys_are_met_exactly_and_ends_are_held() {
        let keys = [(0.5, 1.0), (1.0, 4.0), (3.0, -2.0)];
        for interpolation in [Interpolation::Step, Interpolation::Linear, Interpolation::Smooth] {
            let curve = curve(&keys, interpolation, false);
            for (time, value) in keys {
                assert_eq!([curve.at(time), curve.at(time - 1e-9), curve.at(time + 1e-9)], [[value]; 3], "{interpolation:?} at {time}");
            }
            assert_eq!([curve.at(0.0), curve.at(-7.0), curve.at(99.0), curve.at(f64::NAN)], [[1.0], [1.0], [-2.0], [1.0]]);
        }
        assert_eq!(curve(&keys, Interpolation::Step, false).at(2.9), [4.0]);
        assert_eq!(curve(&keys, Interpolation::Linear, false).at(2.0), [1.0]);
    }

    #[test]
    fn smooth_goes_straight_through_what_is_straight_and_has_no_corners() {
        let line = curve(&[(0.0, 0.0), (1.0, 2.0), (4.0, 8.0), (4.5, 9.0)], Interpolation::Smooth, false);
        for step in 0..45 {
            let time = f64::from(step) / 10.0;
            assert!((line.at(time)[0] - 2.0 * time).abs() < 1e-12);
        }
        let bent = curve(&[(0.0, 0.0), (1.0, 5.0), (1.5, -1.0), (3.0, 2.0)], Interpolation::Smooth, false);
        for key in [1.0, 1.5] {
            let step = 1e-4;
            let (left, right) = (bent.at(key)[0] - bent.at(key - step)[0], bent.at(key + step)[0] - bent.at(key)[0]);
            assert!((left - right).abs() / step < 0.05, "{} and {}", left / step, right / step);
        }
    }

    #[test]
    fn a_loop_has_no_corner_where_it_closes_even_after_a_turn() {
        for (keys, turn) in
            [([(0.0, 3.0), (1.0, 5.0), (2.0, 1.0), (3.0, 3.0)], 0.0), ([(0.0, 0.0), (1.0, 90.0), (2.0, 200.0), (3.0, 360.0)], 360.0)]
        {
            let curve = curve(&keys, Interpolation::Smooth, true);
            let step = 1e-4;
            let (left, right) = (turn + curve.at(3.0)[0] - curve.at(3.0 - step)[0], curve.at(step)[0] - curve.at(0.0)[0]);
            assert!((left - right).abs() / step < 0.1, "{} and {}", left / step, right / step);
            assert_eq!((curve.at(3.0), curve.at(-2.0), curve.at(31.0)), (curve.at(0.0), curve.at(1.0), curve.at(1.0)));
        }
    }

    #[test]
    fn bounded_values_never_leave_their_keys() {
        let keys = vec![(0.0, [1.0]), (1.0, [0.0]), (2.0, [0.0]), (3.0, [8.0])];
        let free = Curve::new(keys.clone(), Interpolation::Smooth, false, [false]);
        let bounded = Curve::new(keys, Interpolation::Smooth, false, [true]);
        let least = |curve: &Option<Curve<1>>| {
            let values = (0..300).filter_map(|step| curve.as_ref().map(|curve| curve.at(f64::from(step) / 100.0)[0]));
            values.fold(f64::INFINITY, f64::min)
        };
        assert_eq!(least(&bounded), 0.0);
        assert!(least(&free) < 0.0);
    }

    #[test]
    fn times_that_do_not_rise_are_refused() {
        for times in [vec![], vec![-1.0], vec![0.0, 0.0], vec![2.0, 1.0], vec![f64::NAN]] {
            let keys = times.into_iter().map(|time| (time, [0.0])).collect();
            assert_eq!(Curve::<1>::new(keys, Interpolation::Linear, false, [false]), None);
        }
    }
}
