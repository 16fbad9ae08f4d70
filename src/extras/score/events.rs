//! Counts of events.

use std::collections::BTreeSet;

use nima_core::{SIDES, Side, task::TaskEvent};

/// Maximum number of times stored for the paths between them, and of lumps distinguished; more indicate faulty input.
const MAX: usize = 10_000;

/// Counts of one trial; times in s from its beginning.
#[derive(Clone, Debug, Default)]
pub(crate) struct Events {
    pub first_grasp_s: Option<f64>,
    pub lifts: u32,
    pub transfers: u32,
    pub placed: u32,
    pub dropped_in_view: u32,
    pub dropped_out_of_view: u32,
    pub knocked_off: u32,
    pub false_marks: u32,
    pub touches: u32,
    found: BTreeSet<usize>,
    /// When each hand grasped or released a ring.
    handled_s: [Vec<f64>; SIDES],
    /// When each hand correctly marked a lump.
    marked_s: [Vec<f64>; SIDES],
    touching_since_s: [Option<f64>; SIDES],
    touched_s: f64,
}

impl Events {
    /// Counts an event at `t_s`; the scorer handles those that begin and end the trial.
    pub(crate) fn take(&mut self, t_s: f64, event: TaskEvent) {
        match event {
            TaskEvent::Begun | TaskEvent::Ended | TaskEvent::Aborted => {}
            TaskEvent::RingGrasped { side, .. } => {
                self.first_grasp_s = Some(self.first_grasp_s.map_or(t_s, |first_s| first_s.min(t_s)));
                self.handle(t_s, side);
            }
            TaskEvent::RingLifted { .. } => self.lifts = self.lifts.saturating_add(1),
            TaskEvent::RingTransferred { .. } => {
                self.transfers = self.transfers.saturating_add(1);
                for side in Side::ALL {
                    self.handle(t_s, side);
                }
            }
            TaskEvent::RingPlaced { side, .. } => {
                self.placed = self.placed.saturating_add(1);
                self.handle(t_s, side);
            }
            TaskEvent::RingDropped { side, in_view, .. } => {
                let drops = if in_view { &mut self.dropped_in_view } else { &mut self.dropped_out_of_view };
                *drops = drops.saturating_add(1);
                self.handle(t_s, side);
            }
            TaskEvent::RingKnockedOff { .. } => self.knocked_off = self.knocked_off.saturating_add(1),
            TaskEvent::LumpMarked { side, lump: Some(lump) } => self.mark(t_s, side, lump),
            TaskEvent::LumpMarked { lump: None, .. } => self.false_marks = self.false_marks.saturating_add(1),
            TaskEvent::WireTouched { side } => self.touch(t_s, side),
            TaskEvent::WireLeft { side } => self.leave(t_s, side),
        }
    }

    fn handle(&mut self, t_s: f64, side: Side) {
        let times_s = &mut self.handled_s[side.index()];
        if times_s.len() < MAX {
            times_s.push(t_s);
        }
    }

    fn mark(&mut self, t_s: f64, side: Side, lump: usize) {
        if self.found.len() < MAX {
            self.found.insert(lump);
        }
        let times_s = &mut self.marked_s[side.index()];
        if times_s.len() < MAX {
            times_s.push(t_s);
        }
    }

    /// A second touch without an end in between is the same one.
    fn touch(&mut self, t_s: f64, side: Side) {
        let since = &mut self.touching_since_s[side.index()];
        self.touches = self.touches.saturating_add(u32::from(since.is_none()));
        since.get_or_insert(t_s);
    }

    fn leave(&mut self, t_s: f64, side: Side) {
        if let Some(since_s) = self.touching_since_s[side.index()].take() {
            self.touched_s += (t_s - since_s).max(0.0);
        }
    }

    /// Returns the number of different lumps that were marked.
    pub(crate) fn found(&self) -> usize {
        self.found.len()
    }

    /// Returns the times at which this hand grasped or released a ring, in order, s.
    pub(crate) fn handled_s(&self, side: Side) -> Vec<f64> {
        let mut times_s = self.handled_s[side.index()].clone();
        times_s.sort_by(f64::total_cmp);
        times_s
    }

    pub(crate) fn marked_s(&self, side: Side) -> &[f64] {
        &self.marked_s[side.index()]
    }

    /// Returns the contact time with the wire until the end of the trial, s.
    pub(crate) fn touched_s(&self, end_s: f64) -> f64 {
        let open = self.touching_since_s.iter().flatten().map(|since_s| (end_s - since_s).max(0.0));
        self.touched_s + open.sum::<f64>()
    }
}
