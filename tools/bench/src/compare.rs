//! What changed since an earlier run.

use crate::report::{Comparison, Report, SceneReport, Times};
use crate::table::{columns, head, number};

/// Factor by which a figure changed, and by which it may have changed by chance.
#[derive(Clone, Debug, PartialEq)]
struct Change {
    /// Above 1: faster than before.
    factor: f64,
    /// The factor that the spread of the runs of both explains.
    noise: f64,
    /// The first rival that both runs had, and that the change is measured by: this takes out what the machine was doing besides.
    by: Option<String>,
}

impl Change {
    fn of(old: &Comparison, new: &Comparison) -> Option<Change> {
        let common = old.common(new);
        let ratios = common.and_then(|(old, new)| Some((old.ratio.filter(|ratio| *ratio > 0.0)?, new.ratio?)));
        let by = common.filter(|_| ratios.is_some());
        let factor = match ratios {
            Some((old, new)) => new / old,
            None => old.ours.median_ms / new.ours.median_ms,
        };
        let spread = |times: &Times| times.median_ms / times.best_ms;
        let rivals = by.map_or(1.0, |(old, new)| spread(&old.times) * spread(&new.times));
        let noise = spread(&old.ours) * spread(&new.ours) * rivals;
        let by = by.map(|(against, _)| against.rival.clone());
        (factor.is_finite() && noise.is_finite()).then_some(Change { factor, noise, by })
    }

    fn verdict(&self) -> &'static str {
        if self.factor > self.noise {
            "faster"
        } else if self.factor * self.noise < 1.0 {
            "slower"
        } else {
            "within the noise"
        }
    }
}

/// A row for each figure that both runs have. The noise is the product of how far each median lies above its best run.
pub fn changes(old: &Report, new: &Report) -> String {
    let mut rows = vec![head(&["scene", "", "before ms", "now", "change", "noise", "measured by", "verdict"])];
    for scene in &new.scenes {
        let is_same =
            |before: &&SceneReport| before.scene == scene.scene && before.triangles == scene.triangles && before.view == scene.view;
        let Some(before) = old.scenes.iter().find(is_same) else { continue };
        for (name, now) in scene.figures() {
            let found = before.figures().find(|(other, _)| *other == name);
            let Some((then, change)) = found.and_then(|(_, then)| Some((then, Change::of(then, now)?))) else { continue };
            rows.push(vec![
                scene.scene.clone(),
                name.to_owned(),
                number(Some(then.ours.median_ms)),
                number(Some(now.ours.median_ms)),
                number(Some(change.factor)),
                number(Some(change.noise)),
                change.by.as_deref().unwrap_or("time").to_owned(),
                change.verdict().to_owned(),
            ]);
        }
    }
    let (then, now) = (&old.setup, &new.setup);
    let mut note = String::new();
    if (&then.device, &then.driver) != (&now.device, &now.driver) {
        note += &format!("before: {} ({})\n", then.device, then.driver);
    }
    if then.size != now.size {
        note += &format!("before: {0} x {0} camera rays\n", then.size);
    }
    if rows.len() == 1 {
        format!("\nnothing to compare: no scene is in both, with as many triangles and seen alike\n{note}")
    } else {
        format!("\n{note}{}", columns(&rows))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::tests::comparison;

    #[test]
    fn a_change_counts_beyond_the_noise_alone() {
        let of = |ms: &[f64]| comparison(ms, "Embree", &[10.0; 3]);
        let change = |old: &[f64], new: &[f64]| Change::of(&of(old), &of(new)).map(|change| change.verdict());
        assert_eq!(change(&[20.0, 20.0, 20.0], &[10.0, 10.0, 10.0]), Some("faster"));
        assert_eq!(change(&[10.0, 10.0, 10.0], &[20.0, 20.0, 20.0]), Some("slower"));
        assert_eq!(change(&[10.0, 20.0, 20.0], &[15.0, 15.0, 15.0]), Some("within the noise"));
        // A machine that is busy slows both.
        let busy = comparison(&[40.0; 3], "Embree", &[20.0; 3]);
        let change = Change::of(&of(&[20.0; 3]), &busy);
        assert_eq!(change, Some(Change { factor: 1.0, noise: 1.0, by: Some("Embree".to_owned()) }));
        let other = Change::of(&comparison(&[20.0; 3], "another", &[10.0; 3]), &busy);
        assert_eq!(other, Some(Change { factor: 0.5, noise: 1.0, by: None }));
    }
}
