//! A value over time: the samplers of an animation.

/// What lies between two keys.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Between {
    Step,
    Linear,
    Cubic,
}

/// Keys with `width` numbers each.
#[derive(Clone, Debug)]
pub(super) struct Track {
    /// Seconds, finite, 0 or more, in order; at least one.
    times: Vec<f32>,
    /// `width` numbers a key; for cubic ones three times as many: incoming tangent, value, outgoing tangent.
    values: Vec<f32>,
    width: usize,
    between: Between,
}

/// Where a time lies among the keys.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    key: usize,
    next: usize,
    /// From 0 at `key` to below 1.
    part: f64,
    /// Seconds between the two keys.
    span: f64,
}

impl Track {
    /// `None` where the counts do not fit together or the times do not go up.
    pub(super) fn new(times: Vec<f32>, values: Vec<f32>, width: usize, between: Between) -> Option<Track> {
        let each = if between == Between::Cubic { 3 } else { 1 };
        let fits = times.len().checked_mul(width)?.checked_mul(each)? == values.len();
        let ordered = times.iter().all(|time| time.is_finite() && *time >= 0.0) && times.is_sorted();
        (fits && ordered && !times.is_empty() && width > 0).then_some(Track { times, values, width, between })
    }

    pub(super) fn width(&self) -> usize {
        self.width
    }

    /// The value where it is the same at all times.
    pub(super) fn constant(&self) -> Option<&[f32]> {
        let first = self.slice(0, 1);
        let still = (0..self.times.len()).all(|key| {
            let tangents =
                self.between != Between::Cubic || [0, 2].iter().all(|&part| self.slice(key, part).iter().all(|&value| value == 0.0));
            tangents && self.slice(key, 1) == first
        });
        still.then_some(first)
    }

    pub(super) fn place(&self, time: f64) -> Place {
        let after = self.times.partition_point(|&key| f64::from(key) <= time);
        let key = after.saturating_sub(1);
        let next = after.min(self.times.len().saturating_sub(1));
        let (from, to) = (self.time(key), self.time(next));
        let span = to - from;
        // Before the first key and after the last one the value stands still.
        let part = if span > 0.0 { ((time - from) / span).clamp(0.0, 1.0) } else { 0.0 };
        Place { key, next, part, span }
    }

    /// One of the numbers; not for rotations.
    pub(super) fn number(&self, place: Place, component: usize) -> f64 {
        let get = |key: usize, part: usize| self.slice(key, part).get(component).map_or(0.0, |&value| f64::from(value));
        let (from, to) = (get(place.key, 1), get(place.next, 1));
        match self.between {
            _ if place.part == 0.0 => from,
            Between::Step => from,
            Between::Linear => from + (to - from) * place.part,
            Between::Cubic => {
                let (s, span) = (place.part, place.span);
                let (s2, s3) = (s * s, s * s * s);
                (2.0 * s3 - 3.0 * s2 + 1.0) * from
                    + span * (s3 - 2.0 * s2 + s) * get(place.key, 2)
                    + (3.0 * s2 - 2.0 * s3) * to
                    + span * (s3 - s2) * get(place.next, 0)
            }
        }
    }

    pub(super) fn vector(&self, time: f64) -> [f64; 3] {
        let place = self.place(time);
        std::array::from_fn(|component| self.number(place, component))
    }

    /// A quaternion, not of length one. Linear ones go the shorter way around.
    pub(super) fn rotation(&self, time: f64) -> [f64; 4] {
        let place = self.place(time);
        if self.between != Between::Linear || place.part == 0.0 {
            return std::array::from_fn(|component| self.number(place, component));
        }
        let unit = |key: usize| {
            let value: [f64; 4] = std::array::from_fn(|at| self.slice(key, 1).get(at).map_or(0.0, |&value| f64::from(value)));
            let length = value.iter().map(|value| value * value).sum::<f64>().sqrt();
            if length.is_finite() && length > 0.0 { value.map(|value| value / length) } else { [0.0, 0.0, 0.0, 1.0] }
        };
        let (from, to) = (unit(place.key), unit(place.next));
        let cosine: f64 = from.iter().zip(to).map(|(a, b)| a * b).sum();
        let (to, cosine) = if cosine < 0.0 { (to.map(|value| -value), -cosine) } else { (to, cosine) };
        // So near each other sine and angle are the same but for rounding, and zero by zero must not be.
        let (a, b) = if cosine > 1.0 - 1e-9 {
            (1.0 - place.part, place.part)
        } else {
            let angle = cosine.clamp(-1.0, 1.0).acos();
            (((1.0 - place.part) * angle).sin() / angle.sin(), (place.part * angle).sin() / angle.sin())
        };
        std::array::from_fn(|at| from[at] * a + to[at] * b)
    }

    fn time(&self, key: usize) -> f64 {
        self.times.get(key).map_or(0.0, |&time| f64::from(time))
    }

    /// The numbers of a key; `part` is 0, 1, 2 for incoming tangent, value, outgoing tangent.
    fn slice(&self, key: usize, part: usize) -> &[f32] {
        let at = if self.between == Between::Cubic { 3 * key + part } else { key };
        self.values.get(at * self.width..(at + 1) * self.width).unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(times: [f32; 2], between: Between, time: f64) -> Option<f64> {
        let track = Track::new(times.to_vec(), vec![10.0, 20.0], 1, between)?;
        Some(track.number(track.place(time), 0))
    }

    #[test]
    fn keys_hold_before_the_first_and_after_the_last() {
        let values = [0.0, 1.0, 2.0, 3.0, 9.0].map(|time| at([1.0, 3.0], Between::Linear, time));
        assert_eq!(values, [10.0, 10.0, 15.0, 20.0, 20.0].map(Some));
        assert!(at([1.0, 3.0], Between::Linear, f64::NAN).is_some_and(f64::is_finite));
    }

    #[test]
    fn steps_hold_until_the_next_key() {
        let values = [0.0, 0.999, 1.0].map(|time| at([0.0, 1.0], Between::Step, time));
        assert_eq!(values, [10.0, 10.0, 20.0].map(Some));
    }

    #[test]
    fn times_that_go_back_or_do_not_fit_are_refused() {
        assert!(Track::new(vec![1.0, 0.0], vec![0.0; 2], 1, Between::Step).is_none());
        assert!(Track::new(vec![f32::NAN], vec![0.0], 1, Between::Step).is_none());
        assert!(Track::new(vec![0.0], vec![0.0], 1, Between::Cubic).is_none());
        assert!(Track::new(vec![], vec![], 1, Between::Step).is_none());
    }
}
