//! Watches the system calls of one thread (Linux, `PR_SET_SYSCALL_USER_DISPATCH`): each one is stopped by the kernel, looked at
//! and then carried out.
#![expect(unsafe_code, reason = "a signal handler that carries out system calls")]

use std::{
    arch::{asm, global_asm},
    collections::BTreeMap,
    sync::atomic::{AtomicBool, AtomicU8, AtomicU64, Ordering::SeqCst},
};

use libc::{c_int, c_long, c_ulong, c_void};

/// Numbers of system calls are below this.
const NUMBERS: usize = 512;
/// From `linux/prctl.h`.
const PR_SET_SYSCALL_USER_DISPATCH: c_int = 59;
const PR_SYS_DISPATCH_ON: c_ulong = 1;
/// Values of the byte that the kernel reads before each system call of the watched thread.
const ALLOW: u8 = 0;
const BLOCK: u8 = 1;
/// The kernel never stops the system call within this length of `nima_signal_return`.
const RETURN_BYTES: c_ulong = 8;

// The return from the handler is a system call too, and must not be stopped. The C library's own cannot be found.
global_asm!(".globl nima_signal_return", "nima_signal_return:", "mov eax, 15", "syscall", "ud2");

unsafe extern "C" {
    fn nima_signal_return();
}

static SELECTOR: AtomicU8 = AtomicU8::new(ALLOW);
static WATCHES: AtomicBool = AtomicBool::new(false);
static ALL: AtomicU64 = AtomicU64::new(0);
/// Calls that may wait, by their numbers.
static WAITS: [AtomicU64; NUMBERS] = [const { AtomicU64::new(0) }; NUMBERS];

/// As the kernel expects it.
#[repr(C)]
struct KernelAction {
    handler: extern "C" fn(c_int, *mut c_void, *mut libc::ucontext_t),
    flags: c_ulong,
    restorer: unsafe extern "C" fn(),
    mask: u64,
}

/// A stopped system call.
struct StoppedCall {
    number: c_long,
    arguments: [c_long; 6],
}

impl StoppedCall {
    fn run(&self) -> c_long {
        let Self { number, arguments: [a, b, c, d, e, f] } = *self;
        let mut result = number;
        // SAFETY: the call that the program was about to make.
        unsafe {
            asm!(
                "syscall", inlateout("rax") result, in("rdi") a, in("rsi") b, in("rdx") c, in("r10") d, in("r8") e,
                in("r9") f, lateout("rcx") _, lateout("r11") _, options(nostack)
            );
        }
        result
    }

    /// Returns whether it can wait for something: for time, data, a device or another thread.
    fn may_wait(&self) -> bool {
        let [first, second, third, fourth, ..] = self.arguments;
        let never_waits = |flags: c_long| {
            let status = Self { number: libc::SYS_fcntl, arguments: [first, libc::F_GETFL.into(), 0, 0, 0, 0] }.run();
            status & c_long::from(libc::O_NONBLOCK) != 0 || flags & c_long::from(libc::MSG_DONTWAIT) != 0
        };
        match self.number {
            libc::SYS_clock_gettime => false,
            libc::SYS_read | libc::SYS_write | libc::SYS_readv | libc::SYS_writev => !never_waits(0),
            libc::SYS_recvfrom | libc::SYS_sendto => !never_waits(fourth),
            libc::SYS_recvmsg | libc::SYS_sendmsg => !never_waits(third),
            libc::SYS_poll => third != 0,
            // Waking another thread does not wait for it.
            libc::SYS_futex => second & 0x7f != c_long::from(libc::FUTEX_WAKE),
            _ => true,
        }
    }
}

extern "C" fn look(_: c_int, _: *mut c_void, context: *mut libc::ucontext_t) {
    SELECTOR.store(ALLOW, SeqCst);
    // SAFETY: the kernel passes the registers of the interrupted thread.
    let registers = unsafe { &mut (*context).uc_mcontext.gregs };
    let of = |register: c_int| registers[register as usize];
    let arguments = [libc::REG_RDI, libc::REG_RSI, libc::REG_RDX, libc::REG_R10, libc::REG_R8, libc::REG_R9].map(of);
    let call = StoppedCall { number: of(libc::REG_RAX), arguments };
    ALL.fetch_add(1, SeqCst);
    if call.may_wait() {
        let number = usize::try_from(call.number).unwrap_or_default().min(NUMBERS - 1);
        WAITS[number].fetch_add(1, SeqCst);
    }
    registers[libc::REG_RAX as usize] = call.run();
    if WATCHES.load(SeqCst) {
        SELECTOR.store(BLOCK, SeqCst);
    }
}

/// Prepares the calling thread, the only one that can be watched; false if this kernel cannot watch it.
pub(crate) fn prepare() -> bool {
    const SA_RESTORER: c_ulong = 0x0400_0000;
    let action = KernelAction {
        handler: look,
        flags: SA_RESTORER | libc::SA_SIGINFO as c_ulong | libc::SA_NODEFER as c_ulong,
        restorer: nima_signal_return,
        mask: 0,
    };
    // SAFETY: the action and the byte live as long as the process needs them.
    unsafe {
        let none: *mut c_void = std::ptr::null_mut();
        libc::syscall(libc::SYS_rt_sigaction, libc::SIGSYS, &raw const action, none, size_of::<u64>()) == 0
            && libc::prctl(
                PR_SET_SYSCALL_USER_DISPATCH,
                PR_SYS_DISPATCH_ON,
                nima_signal_return as *const () as c_ulong,
                RETURN_BYTES,
                SELECTOR.as_ptr(),
            ) == 0
    }
}

/// Watches the prepared thread from now on, or no longer. To be called by that thread.
pub(crate) fn watch(watches: bool) {
    WATCHES.store(watches, SeqCst);
    SELECTOR.store(if watches { BLOCK } else { ALLOW }, SeqCst);
}

/// Returns the number of all calls since the last time, and of each that may wait, by its number in the kernel.
pub(crate) fn taken() -> (u64, BTreeMap<usize, u64>) {
    let waits = WAITS.iter().map(|count| count.swap(0, SeqCst)).enumerate().filter(|(_, count)| *count > 0);
    (ALL.swap(0, SeqCst), waits.collect())
}
