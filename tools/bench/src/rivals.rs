//! Who is measured besides, on this machine.

use std::rc::Rc;
use std::sync::Arc;

use anyhow::{Context as _, Result, bail};

use gridwalk::Geometry;
use gridwalk_render::Context;
use rayon::ThreadPool;

use crate::arguments::{Common, Quality, Who};
use crate::bvh;
use crate::contender::Contender;
use crate::driver::{self, Driver, DriverRival};
use crate::embree::{self, Embree};
use crate::host::HostRival;
use crate::report::Rival;

/// The rivals that are there.
pub struct Rivals {
    embree: Option<(Embree, Quality)>,
    /// Threads of its builds.
    obvhs: Option<Arc<ThreadPool>>,
    driver: Option<Rc<Driver>>,
}

/// A rival that is not there is told, and an error if it was named.
fn missing(is_missing: bool, is_named: bool, why: &str) -> Result<()> {
    if is_missing && is_named {
        bail!("{why}");
    }
    if is_missing {
        eprintln!("gridwalk-bench: {why}: measuring without it");
    }
    Ok(())
}

impl Rivals {
    /// Looks for them.
    ///
    /// # Errors
    /// One that was named is not there.
    pub fn open(common: &Common, context: &Context, threads: u32, quality: Quality) -> Result<Rivals> {
        let mut rivals = Rivals { embree: None, obvhs: None, driver: None };
        if let (true, is_named) = common.wants(Who::Embree) {
            let embree = Embree::load(common.embree.as_deref(), threads)?;
            missing(embree.is_none(), is_named, "Embree is not installed (Debian: apt-get install libembree3-3 or libembree4-4)")?;
            rivals.embree = embree.map(|embree| (embree, quality));
        }
        if let (true, _) = common.wants(Who::Obvhs) {
            rivals.obvhs = Some(bvh::pool(threads)?);
        }
        if let (true, is_named) = common.wants(Who::Driver) {
            rivals.driver = Driver::open(context)?.map(Rc::new);
            missing(rivals.driver.is_none(), is_named, "this device has no ray queries of its own")?;
        }
        Ok(rivals)
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
        let driver = self.driver.iter().map(|_| Rival {
            name: driver::NAME.to_owned(),
            version: "VK_KHR_acceleration_structure, on the same device".to_owned(),
            threads: None,
            rebuild: "fast build of both levels".to_owned(),
            tree: "ray queries, through a structure for fast traces".to_owned(),
        });
        let vectors = if cfg!(target_feature = "avx2") { "AVX2" } else { "the target's least vectors" };
        let obvhs = self.obvhs.iter().map(|pool| Rival {
            name: bvh::NAME.to_owned(),
            version: format!("0.4, compiled for {vectors}"),
            threads: u32::try_from(pool.current_num_threads()).ok(),
            rebuild: "fastest build".to_owned(),
            tree: "single, eight-way tree of its very slow build".to_owned(),
        });
        embree.chain(obvhs).chain(driver).collect()
    }

    /// Each of them with these triangles, in the order of the list: in device memory, and the same on the host.
    ///
    /// # Errors
    /// What they report.
    pub fn contenders(&self, geometry: Geometry, positions: &[[f32; 3]], indices: &[[u32; 3]]) -> Result<Vec<Box<dyn Contender>>> {
        let mut contenders: Vec<Box<dyn Contender>> = Vec::new();
        if let Some((embree, quality)) = &self.embree {
            let mesh = embree::Mesh::new(positions, indices).context("an index that leads nowhere")?;
            contenders.push(Box::new(HostRival::new(embree::Meshed { embree: embree.clone(), mesh, quality: *quality })));
        }
        if let Some(pool) = &self.obvhs {
            let meshed = bvh::Meshed::new(pool, positions, indices).context("an index that leads nowhere")?;
            contenders.push(Box::new(HostRival::new(meshed)));
        }
        if let Some(driver) = &self.driver {
            contenders.push(Box::new(DriverRival::new(driver, geometry)));
        }
        Ok(contenders)
    }
}
