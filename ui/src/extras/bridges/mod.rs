//! The bridges to other programs: `OpenIGTLink`, and marks over the Lab Streaming Layer.

mod bridge_text;

use std::{net::SocketAddr, path::Path, time::Duration};

use nima_bridges::{
    igtl::{self, Image, ImageProvider, LoopOutline},
    lsl::{self, CONTACT_N, MarkStream},
};
use nima_endoscope::{CompressedFrame, FrameQueue, LatestFrame, jpeg};
use nima_machine::{messages::Fault, rig::Side};
use nima_score::TaskFile;
use nima_screen::{recording::PROGRAM, stderr::print_line};
use nima_session::sinks::Audience;
use nima_simulation::SimulationPlan;
use nima_words::report_text::Remedy as _;
use nima_words::text::current_session::WatchStatus;

use super::Extra;
use crate::watching::{INSTALLED, Show, WatchServer};
use bridge_text::trouble_of;

pub(super) struct Bridges;

impl Extra for Bridges {
    fn server(&self, show: Show, at: SocketAddr) -> Option<anyhow::Result<Box<dyn WatchServer>>> {
        (show == Show::Igtl).then(|| igtl_at(at))
    }

    fn marks(&self, library: &Path) -> Option<anyhow::Result<Box<dyn WatchServer>>> {
        Some(marks_by(library))
    }
}

/// Passes the newest image of a queue to a bridge, as pixels.
#[derive(Debug)]
struct OfReel(LatestFrame);

impl ImageProvider for OfReel {
    fn newest(&mut self, is_wanted: bool) -> Option<(Image, Duration)> {
        let CompressedFrame { bytes, arrived, .. } = self.0.take(is_wanted).filter(|_| is_wanted)?;
        // A damaged image is skipped; the next one arrives soon.
        let jpeg::DecodedImage { size_px, rgba } = jpeg::decode(&bytes).ok()?;
        let [width, height] = size_px.map(u16::try_from);
        let pixels = rgba.chunks_exact(4).flat_map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect();
        Some((Image { size_px: [width.ok()?, height.ok()?], colours: 3, pixels }, arrived.elapsed()))
    }
}

impl WatchServer for igtl::IgtlServer {
    fn audience(&self, plan: &SimulationPlan, reel: &FrameQueue) -> Box<dyn Audience> {
        let images = plan.rig.endoscope.as_ref().map(|_| Box::new(OfReel(reel.glimpse())) as Box<dyn ImageProvider>);
        self.show(images);
        self.audience(outline(plan))
    }

    /// Shows nothing: the rendered forces would reveal the condition. The images of the previous session end too.
    fn blind_audience(&self, _plan: &SimulationPlan, _trial: &str) -> Option<Box<dyn Audience>> {
        self.show(None);
        None
    }

    fn shows_images(&self) -> bool {
        true
    }

    fn shown(&self) -> WatchStatus {
        WatchStatus { at: format!("igtl://{}", self.address()), watchers: self.clients() }
    }
}

fn outline(plan: &SimulationPlan) -> LoopOutline {
    let trocar = |side| plan.scene.of_side(side).filter(|_| plan.has(side)).map(|scene| scene.trocar_m);
    LoopOutline { trocars_m: Side::ALL.map(trocar) }
}

fn igtl_at(address: SocketAddr) -> anyhow::Result<Box<dyn WatchServer>> {
    let server = igtl::IgtlServer::start(address, trouble_of)?;
    let at = server.address();
    print_line(format_args!("nima: OpenIGTLink at {at}: connect 3D Slicer (OpenIGTLinkIF, client) or pyigtl to it"));
    if !at.ip().is_loopback() {
        print_line(
            "nima: OpenIGTLink: anyone who can reach this address can read poses, forces and images, without a \
         password",
        );
    }
    Ok(Box::new(server))
}

impl WatchServer for MarkStream {
    fn audience(&self, plan: &SimulationPlan, _: &FrameQueue) -> Box<dyn Audience> {
        self.audience(marked(plan, None))
    }

    fn blind_audience(&self, plan: &SimulationPlan, trial: &str) -> Option<Box<dyn Audience>> {
        Some(self.audience(marked(plan, Some(trial.to_owned()))))
    }

    fn shown(&self) -> WatchStatus {
        WatchStatus { at: format!("LSL stream {}", lsl::STREAM), watchers: usize::from(self.is_received()) }
    }
}

fn marked(plan: &SimulationPlan, trial: Option<String>) -> lsl::MarkContext {
    let contact_n =
        plan.scene.task.as_ref().and_then(|task| TaskFile::of(task).ok()).map_or(CONTACT_N, |task| task.contact_n);
    let cause: fn(Fault) -> &'static str = Fault::cause;
    let words = trial.is_none().then_some(cause);
    lsl::MarkContext { contact_n, trial, words }
}

fn marks_by(library: &Path) -> anyhow::Result<Box<dyn WatchServer>> {
    let named = (library != Path::new(INSTALLED)).then_some(library);
    let marker = MarkStream::start(named, PROGRAM, &machine())?;
    print_line(format_args!(
        "nima: marks over the Lab Streaming Layer: stream {}, type {}",
        lsl::STREAM,
        lsl::STREAM_TYPE
    ));
    Ok(Box::new(marker))
}

/// Returns the name of this computer, or a default if the system does not report one.
fn machine() -> String {
    let by_kernel = std::fs::read_to_string("/proc/sys/kernel/hostname").ok();
    let name = by_kernel.or_else(|| std::env::var("COMPUTERNAME").ok()).unwrap_or_default();
    name.trim().to_owned()
}

#[cfg(test)]
mod tests {
    use std::sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    };

    use nima_machine::config::RigConfig;
    use nima_simulation::scene::Scene;

    use super::*;

    /// A source of images that reports its removal.
    #[derive(Debug)]
    struct RemovableSource(Arc<AtomicBool>);

    impl ImageProvider for RemovableSource {
        fn newest(&mut self, _is_wanted: bool) -> Option<(Image, Duration)> {
            None
        }
    }

    impl Drop for RemovableSource {
        fn drop(&mut self) {
            self.0.store(true, Ordering::Relaxed);
        }
    }

    fn plan_of(scene: &str) -> SimulationPlan {
        let rig = RigConfig::load("simulated").unwrap();
        let scene = Scene::load(scene).unwrap();
        SimulationPlan { rig, scene, calibrations: Default::default(), engage: false }
    }

    #[test]
    fn openigtlink_shows_neither_data_nor_images_of_a_blind_trial() {
        let server = igtl::IgtlServer::start("127.0.0.1:0".parse().unwrap(), trouble_of).unwrap();
        let is_removed = Arc::new(AtomicBool::new(false));
        server.show(Some(Box::new(RemovableSource(Arc::clone(&is_removed)))));
        assert!(WatchServer::blind_audience(&server, &plan_of("rings"), "P03 4").is_none());
        assert!(is_removed.load(Ordering::Relaxed));
    }

    #[test]
    fn marks_of_a_trial_have_no_cause_of_a_fault() {
        let plan = plan_of("rings");
        assert!(marked(&plan, Some("P03 4".to_owned())).words.is_none());
        assert!(marked(&plan, None).words.is_some());
    }

    #[test]
    fn the_shaft_of_each_arm_goes_through_the_trocar_that_the_screen_shows() {
        for (scene, arms) in [("peg_transfer", 1), ("bimanual", 2)] {
            let rig = RigConfig::load("simulated").unwrap();
            let scene = Scene::load(scene).unwrap();
            let plan = SimulationPlan { rig, scene: scene.clone(), calibrations: Default::default(), engage: false };
            let known = outline(&plan).trocars_m;
            assert_eq!(known.iter().flatten().count(), arms);
            assert_eq!(known[0], Some(scene.trocar_m));
        }
    }

    #[test]
    fn a_mark_of_contact_begins_where_the_task_counts_contact() {
        let rig = RigConfig::load("simulated").unwrap();
        let scene = Scene::load("rings").unwrap();
        let contact_n = TaskFile::of(scene.task.as_ref().unwrap()).unwrap().contact_n;
        let plan = SimulationPlan { rig, scene, calibrations: Default::default(), engage: false };
        let marked_n = marked(&plan, Some("P03 4".to_owned())).contact_n;
        assert_eq!(marked_n.to_bits(), contact_n.to_bits());
    }
}
