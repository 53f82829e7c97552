//! What changed since an earlier run.

use crate::report::{Comparison, Report, SceneReport, columns, head, number};

/// Factor by which a figure changed, and by which it may have changed by chance.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Change {
    /// Above 1: faster than before.
    factor: f64,
    /// The factor that the spread of the runs of both explains.
    noise: f64,
    /// Whether both runs had a rival to be measured by, which takes out what the machine was doing besides.
    by_rival: bool,
}

impl Change {
    fn of(old: &Comparison, new: &Comparison) -> Option<Change> {
        let (factor, by_rival) = match (old.ratio, new.ratio) {
            (Some(old), Some(new)) if old > 0.0 => (new / old, true),
            _ => (old.ours.median_ms / new.ours.median_ms, false),
        };
        let spread = |side: &Comparison| {
            let times = [Some(side.ours), side.embree.filter(|_| by_rival)];
            times.into_iter().flatten().map(|times| times.median_ms / times.best_ms).fold(1.0, |product, factor| product * factor)
        };
        let noise = spread(old) * spread(new);
        (factor.is_finite() && noise.is_finite()).then_some(Change { factor, noise, by_rival })
    }

    fn verdict(self) -> &'static str {
        if self.factor > self.noise {
            "faster"
        } else if self.factor * self.noise < 1.0 {
            "slower"
        } else {
            "within the noise"
        }
    }
}

fn figures(scene: &SceneReport) -> impl Iterator<Item = (&str, &Comparison)> {
    let rebuild = scene.rebuild.iter().map(|rebuild| ("rebuild", rebuild));
    rebuild.chain(scene.rays.iter().map(|rays| (rays.kind.as_str(), &rays.time)))
}

/// A row for each figure that both runs have. The noise is the product of how far each median lies above its best run.
pub fn changes(old: &Report, new: &Report) -> String {
    let mut rows = vec![head(&["scene", "", "before ms", "now", "change", "noise", "measured by", "verdict"])];
    for scene in &new.scenes {
        let Some(before) = old.scenes.iter().find(|before| before.scene == scene.scene && before.triangles == scene.triangles) else {
            continue;
        };
        for (name, now) in figures(scene) {
            let found = figures(before).find(|(other, _)| *other == name);
            let Some((then, change)) = found.and_then(|(_, then)| Some((then, Change::of(then, now)?))) else { continue };
            rows.push(vec![
                scene.scene.clone(),
                name.to_owned(),
                number(Some(then.ours.median_ms)),
                number(Some(now.ours.median_ms)),
                number(Some(change.factor)),
                number(Some(change.noise)),
                if change.by_rival { "Embree".to_owned() } else { "time".to_owned() },
                change.verdict().to_owned(),
            ]);
        }
    }
    let same = old.device == new.device && old.driver == new.driver;
    let note = if same { String::new() } else { format!("before: {} ({})\n", old.device, old.driver) };
    if rows.len() == 1 { format!("\nnothing to compare: no scene is in both\n{note}") } else { format!("\n{note}{}", columns(&rows)) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::Run;

    fn runs(ms: &[f64]) -> Vec<Run> {
        ms.iter().map(|&ms| Run { ms, processor_ms: ms }).collect()
    }

    #[test]
    fn a_change_counts_beyond_the_noise_alone() {
        let rival = runs(&[10.0, 10.0, 10.0]);
        let of = |ms: &[f64]| Comparison::of(&runs(ms), &rival, true);
        let change = |old: &[f64], new: &[f64]| Change::of(&of(old), &of(new)).map(Change::verdict);
        assert_eq!(change(&[20.0, 20.0, 20.0], &[10.0, 10.0, 10.0]), Some("faster"));
        assert_eq!(change(&[10.0, 10.0, 10.0], &[20.0, 20.0, 20.0]), Some("slower"));
        assert_eq!(change(&[10.0, 20.0, 20.0], &[15.0, 15.0, 15.0]), Some("within the noise"));
        // A machine that is busy slows both.
        let busy = Comparison::of(&runs(&[40.0; 3]), &runs(&[20.0; 3]), true);
        let change = Change::of(&of(&[20.0; 3]), &busy);
        assert_eq!(change, Some(Change { factor: 1.0, noise: 1.0, by_rival: true }));
        let alone = Change::of(&Comparison::of(&runs(&[20.0; 3]), &[], true), &busy);
        assert_eq!(alone, Some(Change { factor: 0.5, noise: 1.0, by_rival: false }));
    }
}
