//! A step allocates nothing; nor does watching.

#![expect(unsafe_code, reason = "counting what is allocated takes a global allocator, whose trait is unsafe")]

use std::{
    alloc::{GlobalAlloc, Layout, System},
    cell::Cell,
};

struct Counting;

thread_local! {
    static CALLS: Cell<u64> = const { Cell::new(0) };
}

fn count() {
    // A thread that is ending has no counter any more; its allocations do not matter.
    let _ = CALLS.try_with(|calls| calls.set(calls.get() + 1));
}

// SAFETY: every call is passed to the system's allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count();
        // SAFETY: the caller's promises are passed on.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        count();
        // SAFETY: the caller's promises are passed on.
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, new_size: usize) -> *mut u8 {
        count();
        // SAFETY: the caller's promises are passed on.
        unsafe { System.realloc(pointer, layout, new_size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

use super::{LEFT, RIGHT, at, instrument};
use crate::{Objects, Setting, Watch};

#[test]
fn a_step_allocates_nothing_from_the_first_on() {
    let mut objects = Objects::new(&Setting::default(), 1e-3);
    let mut watch = Watch::new(&objects);
    let (mut events, mut touched) = (0, 0);
    let before = CALLS.get();
    for tick in 0..4000 {
        let t_s = f64::from(tick) * 1e-3;
        let swing =
            |side: f64| at(side * 0.02 + 0.03 * libm::sin(3.0 * t_s), 0.03 * libm::sin(2.0 * t_s + side), 0.003);
        let hand = |side, sign| instrument(side, swing(sign), libm::sin(5.0 * t_s).abs());
        let loads = objects.step(&[Some(hand(LEFT, -1.0)), (tick % 700 > 5).then(|| hand(RIGHT, 1.0))]);
        watch.look(&objects);
        events += std::iter::from_fn(|| watch.next_event()).count();
        touched += loads.iter().filter(|loads| loads.touching.ring).count();
    }
    assert_eq!(CALLS.get() - before, 0);
    assert!(touched > 100, "{touched} touches, {events} events");
    drop(std::hint::black_box(vec![1_u8; 10]));
    assert_eq!(CALLS.get() - before, 2, "the counter counts");
}
