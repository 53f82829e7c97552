//! Who is measured besides, on this machine.

use anyhow::{Context as _, Result};

use crate::arguments::{Common, Quality};
use crate::contender::Contender;
use crate::embree::{self, Embree};
use crate::host::HostRival;
use crate::report::Rival;

/// The rivals that are there.
pub struct Rivals {
    embree: Option<(Embree, Quality)>,
}

impl Rivals {
    /// Looks for them.
    ///
    /// # Errors
    /// One that was named cannot be had.
    pub fn open(common: &Common, threads: u32, quality: Quality) -> Result<Rivals> {
        let embree = if common.no_embree { None } else { Embree::load(common.embree.as_deref(), threads)? };
        if embree.is_none() && !common.no_embree {
            eprintln!(
                "gridwalk-bench: Embree is not installed (Debian: apt-get install libembree3-3 or libembree4-4): measuring without it"
            );
        }
        Ok(Rivals { embree: embree.map(|embree| (embree, quality)) })
    }

    /// Their names and how they are used.
    pub fn list(&self) -> Vec<Rival> {
        let embree = self.embree.iter().map(|(embree, quality)| Rival {
            name: embree::NAME.to_owned(),
            version: format!("{} ({})", embree.version(), embree.path().display()),
            threads: Some(embree.threads()),
            rebuild: "Morton rebuild".to_owned(),
            tree: match quality {
                Quality::Medium => "single, tree by surface area".to_owned(),
                Quality::High => "single, tree by surface area with spatial splits".to_owned(),
            },
        });
        embree.collect()
    }

    /// Each of them with these triangles, in the order of the list.
    ///
    /// # Errors
    /// What they report.
    pub fn contenders(&self, positions: &[[f32; 3]], indices: &[[u32; 3]]) -> Result<Vec<Box<dyn Contender>>> {
        let mut contenders: Vec<Box<dyn Contender>> = Vec::new();
        if let Some((embree, quality)) = &self.embree {
            let mesh = embree::Mesh::new(positions, indices).context("an index that leads nowhere")?;
            contenders.push(Box::new(HostRival::new(embree::Meshed { embree: embree.clone(), mesh, quality: *quality })));
        }
        Ok(contenders)
    }
}
