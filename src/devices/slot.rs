//! Holds one device: opens it on a separate thread, passes it to the real-time thread, and reopens it when it is lost.
//!
//! The real-time thread never waits: an opened device arrives through a queue, and a lost one leaves through another,
//! so that closing happens on the slot's thread too. A device that returns is *connected*, never engaged; the loop
//! decides about engagement.

use std::{
    sync::{
        Arc, Mutex, PoisonError,
        atomic::{AtomicBool, Ordering},
    },
    thread::{Builder, JoinHandle},
    time::Duration,
};

use rtrb::{Consumer, Producer, PushError, RingBuffer};
use tracing::{info, warn};

use super::{ConnectionState, Device, DeviceError, DeviceIdentity, Health, TimedReading, health::Outages};

/// State of a slot for threads other than the real-time thread.
#[derive(Clone, Debug, Default)]
pub struct SlotReport {
    /// Identity that the device reported when it was opened.
    pub identity: Option<DeviceIdentity>,
    /// Reason why the last attempt to open the device failed; `None` once it is open.
    pub trouble: Option<DeviceError>,
    /// Number of times that the device has been opened.
    pub opened: u64,
}

/// Time between two attempts to open the device, so that a device that is absent does not keep the bus busy.
const RETRY: Duration = Duration::from_millis(500);
/// Interval at which the thread checks whether to open, close or end; waking it would cost the loop time. A person
/// hardly notices the delay, and the slots of a whole rig cost nothing.
const NAP: Duration = Duration::from_millis(20);

/// The slot of one device. Dropping it closes the device and ends its thread.
pub struct DeviceSlot<D: Device> {
    device: Option<D>,
    health: Health,
    outages: Outages,
    opened: Consumer<D>,
    lost: Producer<D>,
    shared: SlotShared,
    thread: Option<JoinHandle<()>>,
}

impl<D: Device + 'static> DeviceSlot<D> {
    /// Creates a slot. `open` is called on a separate thread, repeatedly while the device is wanted and not open.
    ///
    /// # Errors
    /// If the operating system cannot create the thread.
    pub fn start(name: &str, open: impl FnMut() -> Result<D, DeviceError> + Send + 'static) -> std::io::Result<Self> {
        // Room for one device: there is never more than one, and a full queue cannot block the real-time thread.
        let (give, opened) = RingBuffer::new(1);
        let (lost, take) = RingBuffer::new(1);
        let shared = SlotShared::default();
        shared.wanted.store(true, Ordering::Release);
        let keeper = SlotWorker { name: name.to_owned(), give, take, shared: shared.clone() };
        let thread = Builder::new().name(format!("open {name}")).spawn(move || keeper.run(open))?;
        let health = Health::opening();
        Ok(Self { device: None, health, outages: Outages::default(), opened, lost, shared, thread: Some(thread) })
    }

    /// Polls the device if it is open. Also accepts a device that was just opened, and returns a lost or unwanted
    /// device to the thread.
    pub fn poll(&mut self, now_s: f64) -> Option<TimedReading<D::Reading>> {
        let reading = self.poll_device(now_s);
        self.outages.follow(&mut self.health, now_s);
        reading
    }

    fn poll_device(&mut self, now_s: f64) -> Option<TimedReading<D::Reading>> {
        if self.device.is_none() {
            self.device = self.opened.pop().ok();
        }
        let wanted = self.shared.wanted.load(Ordering::Acquire);
        let Some(device) = self.device.as_mut() else {
            // A device that is not open can also be disconnected and connected.
            match (wanted, self.health.standing) {
                (false, _) => self.health.standing = ConnectionState::Closed,
                (true, ConnectionState::Closed) => self.health.standing = ConnectionState::Opening,
                (true, _) => {}
            }
            return None;
        };
        let reading = device.poll(now_s);
        self.health = *device.health();
        if !wanted || matches!(self.health.standing, ConnectionState::Lost(_)) {
            if let Some(Err(PushError::Full(device))) = self.device.take().map(|device| self.lost.push(device)) {
                // The thread has not taken the previous device yet; try again in the next poll.
                self.device = Some(device);
            }
            if !wanted {
                self.health.standing = ConnectionState::Closed;
            }
            return None;
        }
        reading
    }

    /// Returns the device while it is connected, for commands.
    pub const fn device(&mut self) -> Option<&mut D> {
        self.device.as_mut()
    }

    /// Returns the health of the device; without a device, the health of the last one.
    pub const fn health(&self) -> &Health {
        &self.health
    }

    pub fn want(&self, connected: bool) {
        self.shared.wanted.store(connected, Ordering::Release);
    }

    pub fn view(&self) -> SlotView {
        SlotView { shared: self.shared.clone() }
    }
}

impl<D: Device> std::fmt::Debug for DeviceSlot<D> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Slot").field("health", &self.health).finish_non_exhaustive()
    }
}

impl<D: Device> DeviceSlot<D> {
    /// Ends the slot: its thread closes the device. To end several slots, call this for all of them before dropping the
    /// first: an arm that is not served while another one brakes would report a fault.
    pub fn retire(&mut self) {
        if let Some(device) = self.device.take() {
            // While an older device is still being closed, close this one here.
            self.lost.push(device).ok();
        }
        self.shared.stop.store(true, Ordering::Release);
        if let Some(thread) = &self.thread {
            // Otherwise ending would wait for the rest of the pause.
            thread.thread().unpark();
        }
    }
}

impl<D: Device> Drop for DeviceSlot<D> {
    fn drop(&mut self) {
        self.retire();
        if let Some(thread) = self.thread.take() {
            thread.join().ok();
        }
    }
}

#[derive(Clone, Debug, Default)]
struct SlotShared {
    report: Arc<Mutex<SlotReport>>,
    wanted: Arc<AtomicBool>,
    stop: Arc<AtomicBool>,
}

/// Reads the state of a slot, and connects or disconnects its device, from other threads. The default belongs to a slot
/// that never opens.
#[derive(Clone, Debug, Default)]
pub struct SlotView {
    shared: SlotShared,
}

impl SlotView {
    pub fn report(&self) -> SlotReport {
        self.shared.report.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    pub fn want(&self, connected: bool) {
        self.shared.wanted.store(connected, Ordering::Release);
    }
}

struct SlotWorker<D> {
    name: String,
    give: Producer<D>,
    take: Consumer<D>,
    shared: SlotShared,
}

impl<D: Device> SlotWorker<D> {
    fn run(mut self, mut open: impl FnMut() -> Result<D, DeviceError>) {
        let mut out = false;
        let mut report = None;
        while !self.shared.stop.load(Ordering::Acquire) {
            if let Ok(lost) = self.take.pop() {
                warn!(device = self.name, standing = ?lost.health().standing, "closed");
                drop(lost);
                out = false;
                self.nap(NAP);
            }
            if out || !self.shared.wanted.load(Ordering::Acquire) {
                self.nap(NAP);
                continue;
            }
            match open() {
                Ok(device) => {
                    info!(device = self.name, "open");
                    report = None;
                    self.report(|report| {
                        report.identity = Some(device.identity().clone());
                        report.trouble = None;
                        report.opened += 1;
                    });
                    // If the slot has ended in the meantime, the device is closed here.
                    out = self.give.push(device).is_ok();
                }
                Err(trouble) => {
                    // Log the same error, which recurs twice a second, only once.
                    if report.as_ref() != Some(&trouble) {
                        warn!(device = self.name, %trouble, "not open");
                        report = Some(trouble.clone());
                    }
                    self.report(|report| report.trouble = Some(trouble));
                    self.nap(RETRY);
                }
            }
        }
        // A device that was lost at the last moment is closed on this thread, too.
        while let Ok(lost) = self.take.pop() {
            drop(lost);
        }
    }

    fn report(&self, change: impl FnOnce(&mut SlotReport)) {
        change(&mut self.shared.report.lock().unwrap_or_else(PoisonError::into_inner));
    }

    /// Waits; the wait ends early when the slot ends.
    fn nap(&self, length: Duration) {
        if !self.shared.stop.load(Ordering::Acquire) {
            std::thread::park_timeout(length);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::{sync::atomic::AtomicU64, time::Instant};

    use nima_testing::real_time::judged;

    use super::*;
    use crate::Loss;

    struct Flaky {
        health: Health,
        identity: DeviceIdentity,
        left: u32,
    }

    impl Device for Flaky {
        type Reading = u32;

        fn poll(&mut self, now_s: f64) -> Option<TimedReading<u32>> {
            if self.left == 0 {
                self.health.lose(Loss::Silent);
                return None;
            }
            self.left -= 1;
            self.health.accept(now_s);
            Some(TimedReading { device_s: None, arrival_s: now_s, value: self.left })
        }

        fn about(&self) -> (&Health, &DeviceIdentity) {
            (&self.health, &self.identity)
        }
    }

    fn until(
        slot: &mut DeviceSlot<Flaky>,
        good: impl Fn(&DeviceSlot<Flaky>, Option<TimedReading<u32>>) -> bool,
    ) -> bool {
        let begin = Instant::now();
        while begin.elapsed() < Duration::from_secs(5) {
            let reading = slot.poll(begin.elapsed().as_secs_f64());
            if good(slot, reading) {
                return true;
            }
            std::thread::sleep(Duration::from_millis(1));
        }
        false
    }

    /// A device that can be closed only while another one is being closed.
    struct Slow(Flaky, Arc<AtomicU64>, Arc<AtomicU64>);

    impl Device for Slow {
        type Reading = u32;

        fn poll(&mut self, now_s: f64) -> Option<TimedReading<u32>> {
            self.0.poll(now_s)
        }

        fn about(&self) -> (&Health, &DeviceIdentity) {
            self.0.about()
        }
    }

    impl Drop for Slow {
        fn drop(&mut self) {
            let begin = Instant::now();
            let Self(_, closing, together) = self;
            closing.fetch_add(1, Ordering::AcqRel);
            while closing.load(Ordering::Acquire) < 2 && begin.elapsed() < Duration::from_secs(5) {
                std::thread::sleep(Duration::from_millis(1));
            }
            together.fetch_add(u64::from(closing.load(Ordering::Acquire) == 2), Ordering::AcqRel);
        }
    }

    #[test]
    fn slots_that_retire_together_close_their_devices_at_once() {
        judged(|| {
            let [closing, together] = [(); 2].map(|()| Arc::new(AtomicU64::new(0)));
            let mut slots = [(); 2].map(|()| {
                let closing = Arc::clone(&closing);
                let together = Arc::clone(&together);
                let flaky = || Flaky { health: Health::default(), identity: DeviceIdentity::default(), left: u32::MAX };
                DeviceSlot::start("slow", move || Ok(Slow(flaky(), Arc::clone(&closing), Arc::clone(&together))))
                    .unwrap()
            });
            let begin = Instant::now();
            while !slots.iter_mut().all(|slot| slot.device().is_some()) && begin.elapsed() < Duration::from_secs(5) {
                for slot in &mut slots {
                    slot.poll(0.0);
                }
                std::thread::sleep(Duration::from_millis(1));
            }
            slots.iter_mut().for_each(DeviceSlot::retire);
            drop(slots);
            assert_eq!(together.load(Ordering::Acquire), 2, "one after the other: the second arm would miss its cycle");
        });
    }

    #[test]
    fn a_lost_device_comes_back_and_trouble_is_told() {
        judged(|| {
            let attempts = Arc::new(AtomicU64::new(0));
            let count = Arc::clone(&attempts);
            let mut slot = DeviceSlot::start("flaky", move || match count.fetch_add(1, Ordering::Relaxed) {
                0 => Err(DeviceError::Absent { place: "/dev/ttyX".to_owned() }),
                _ => Ok(Flaky { health: Health::default(), identity: DeviceIdentity::default(), left: 3 }),
            })
            .unwrap();
            let view = slot.view();
            assert_eq!(slot.health().standing, ConnectionState::Opening);
            assert!(until(&mut slot, |_, reading| reading.is_some()));
            assert!(until(&mut slot, |slot, _| slot.health().standing == ConnectionState::Lost(Loss::Silent)));
            assert!(until(&mut slot, |_, _| view.report().opened >= 2), "it is opened again");
            assert!(until(&mut slot, |_, reading| reading.is_some()), "and delivers");
            assert!(view.report().trouble.is_none());
            assert!(slot.health().outages >= 1 && slot.health().longest_outage_s > 0.0, "an outage is not forgotten");
            let outages = slot.health().outages;
            assert!(until(&mut slot, |slot, _| slot.health().outages > outages), "the next one is counted");
            // The device is absent at this moment; disconnecting it counts as closed, not lost.
            view.want(false);
            assert!(until(&mut slot, |slot, _| slot.health().standing == ConnectionState::Closed));
            let opened = view.report().opened;
            std::thread::sleep(Duration::from_millis(50));
            assert_eq!(view.report().opened, opened, "not wanted, not opened");
        });
    }
}
