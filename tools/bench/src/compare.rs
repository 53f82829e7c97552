//! What changed since an earlier run.

use crate::report::{Comparison, Report, SceneReport, Spread, Times};
use crate::table::{columns, head, number};

/// Factor by which a figure changed, and by which it may have changed by chance.
#[derive(Clone, Debug, PartialEq)]
struct Change {
    /// Above 1: faster than before.
    factor: f64,
    /// How far apart the turns of one run are: the wider of both.
    noise: f64,
    /// What all turns say.
    verdict: &'static str,
    /// What the change is measured by.
    by: String,
}

impl Change {
    /// By the ratio to the first rival that both runs had, which takes out what the machine was doing besides; of processor time on a CPU,
    /// since it takes out more; else by our time. The change counts only if every turn of one run lies beyond every turn of the other, which
    /// chance does once in 126 times with five turns each, and if it is larger than what lies between the turns of one run.
    fn of(old: &Comparison, new: &Comparison) -> Option<Change> {
        let common = old.common(new);
        let processor = common.and_then(|(old, new)| {
            let by = format!("{}, processor", old.rival);
            Some((new.processor_ratio? / old.processor_ratio?, old.processor_turns?, new.processor_turns?, by))
        });
        let turns = common.and_then(|(old, new)| Some((new.ratio? / old.ratio?, old.turns?, new.turns?, old.rival.clone())));
        let times = || {
            // As speeds: greater is faster.
            let speeds = |times: &Times| Spread::of([times.worst_ms, times.best_ms].into_iter().map(f64::recip));
            let factor = old.ours.median_ms / new.ours.median_ms;
            Some((factor, speeds(&old.ours)?, speeds(&new.ours)?, "time".to_owned()))
        };
        let (factor, before, now, by) = processor.or(turns).or_else(times)?;
        let noise = before.factor().max(now.factor());
        let verdict = if now.least > before.greatest && factor > noise {
            "faster"
        } else if now.greatest < before.least && factor * noise < 1.0 {
            "slower"
        } else {
            "within the noise"
        };
        factor.is_finite().then_some(Change { factor, noise, verdict, by })
    }
}

/// A row for each figure that both runs have.
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
                change.by,
                change.verdict.to_owned(),
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
    fn a_change_counts_if_all_turns_say_so() {
        let of = |ms: &[f64]| comparison(ms, "Embree", &[10.0; 3]);
        let change = |old: &[f64], new: &[f64]| Change::of(&of(old), &of(new)).map(|change| change.verdict);
        assert_eq!(change(&[20.0, 20.0, 20.0], &[10.0, 10.0, 10.0]), Some("faster"));
        assert_eq!(change(&[20.0, 20.0, 16.0], &[10.0, 15.0, 10.0]), Some("faster"));
        assert_eq!(change(&[10.0, 10.0, 10.0], &[20.0, 20.0, 20.0]), Some("slower"));
        assert_eq!(change(&[20.0, 20.0, 14.0], &[10.0, 15.0, 10.0]), Some("within the noise"));
        assert_eq!(change(&[20.0, 20.0, 16.0], &[15.5, 15.0, 11.0]), Some("within the noise"), "apart, but less than the turns of one");
        // A machine that is busy slows both.
        let busy = comparison(&[40.0; 3], "Embree", &[20.0; 3]);
        let change = Change::of(&of(&[20.0; 3]), &busy).unwrap();
        let found = (change.factor, change.noise, change.verdict, change.by.as_str());
        assert_eq!(found, (1.0, 1.0, "within the noise", "Embree, processor"));
        let change = Change::of(&comparison(&[20.0, 16.0], "another", &[10.0; 2]), &busy).unwrap();
        assert_eq!((change.factor, change.noise, change.verdict, change.by.as_str()), (0.45, 1.25, "slower", "time"));
    }
}
