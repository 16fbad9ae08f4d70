//! Loads and calls liblsl. The only unsafe code of this crate.
//!
//! The library is never unloaded, because its threads may still be running.
#![expect(unsafe_code, reason = "a C library that is loaded while running")]

use std::{
    env,
    ffi::{CStr, CString, c_char, c_void},
    path::{Path, PathBuf},
    ptr::NonNull,
};

use libloading::Library;

use super::LslError;

/// The oldest version (100 times the major number plus the minor one) with the required functions and protocol.
const VERSION_MIN: i32 = 113;
/// The value of C's `cft_string`, and the rate of an irregular stream. Both are from the library's C header, which is
/// not needed to build this program, because the library is loaded at run time.
const STRINGS: i32 = 3;
const IRREGULAR: f64 = 0.0;
/// Seconds buffered for a listener that was disconnected. The default of liblsl.
const BUFFER_S: i32 = 360;
const PUSH_THROUGH: i32 = 1;

/// Names for the system's search.
#[cfg(target_os = "windows")]
const NAMES: &[&str] = &["lsl.dll", "liblsl64.dll"];
#[cfg(target_os = "macos")]
const NAMES: &[&str] = &["liblsl.2.dylib", "liblsl.dylib", "/opt/homebrew/lib/liblsl.dylib"];
#[cfg(not(any(target_os = "windows", target_os = "macos")))]
const NAMES: &[&str] = &["liblsl.so.2", "liblsl.so", "liblsl64.so", "/usr/local/lib/liblsl.so"];
/// The environment variable that Python's `pylsl` uses too.
const VARIABLE: &str = "PYLSL_LIB";

macro_rules! library {
    ($($field:ident = $symbol:literal: fn($($argument:ty),*) $(-> $result:ty)?;)*) => {
        /// The functions of the library that are used, with the types of its C header.
        #[derive(Clone, Copy, Debug)]
        pub(super) struct Lsl {
            $($field: unsafe extern "C" fn($($argument),*) $(-> $result)?,)*
        }

        impl Lsl {
            /// Looks up all functions; the error is the name of the missing one.
            fn of(library: &Library) -> Result<Self, &'static str> {
                Ok(Self {
                    $(
                        // SAFETY: the type matches the symbol's declaration in the library's header; the library is never
                        // unloaded, so the pointer stays valid.
                        $field: unsafe { *library.get($symbol).map_err(|_| $symbol)? },
                    )*
                })
            }
        }
    };
}

library! {
    library_version = "lsl_library_version": fn() -> i32;
    local_clock = "lsl_local_clock": fn() -> f64;
    create_streaminfo = "lsl_create_streaminfo": fn(*const c_char, *const c_char, i32, f64, i32, *const c_char) -> *mut c_void;
    destroy_streaminfo = "lsl_destroy_streaminfo": fn(*mut c_void);
    get_desc = "lsl_get_desc": fn(*mut c_void) -> *mut c_void;
    append_child_value = "lsl_append_child_value": fn(*mut c_void, *const c_char, *const c_char) -> *mut c_void;
    create_outlet = "lsl_create_outlet": fn(*mut c_void, i32, i32) -> *mut c_void;
    destroy_outlet = "lsl_destroy_outlet": fn(*mut c_void);
    have_consumers = "lsl_have_consumers": fn(*mut c_void) -> i32;
    push_sample_strtp = "lsl_push_sample_strtp": fn(*mut c_void, *const *const c_char, f64, i32) -> i32;
    last_error = "lsl_last_error": fn() -> *const c_char;
}

/// Description of a stream.
pub(super) struct Info<'a> {
    pub(super) name: &'a str,
    pub(super) kind: &'a str,
    /// Identifier that stays the same after a restart, so that a listener recovers the stream.
    pub(super) source: &'a str,
    pub(super) about: &'a [(&'a str, &'a str)],
}

impl Lsl {
    /// Loads this file, or the installed library.
    pub(super) fn open(named: Option<&Path>) -> Result<Self, LslError> {
        if let Some(path) = named {
            return if path.is_file() { Self::load(path) } else { Err(missing(&path.display().to_string())) };
        }
        let by_variable = env::var_os(VARIABLE).map(PathBuf::from).filter(|path| path.is_file());
        let names = by_variable.into_iter().chain(NAMES.iter().map(PathBuf::from));
        for name in names {
            match Self::load(&name) {
                // The system's loader did not find the name.
                Err(LslError::Unusable { reason, .. }) if reason.starts_with(&*name.to_string_lossy()) => {}
                found => return found,
            }
        }
        Err(missing(&format!("the file that {VARIABLE} names, {}", NAMES.join(", "))))
    }

    fn load(path: &Path) -> Result<Self, LslError> {
        let unusable = |reason| LslError::Unusable { path: path.to_owned(), reason };
        // SAFETY: loading runs the library's initialisation. The user has named or installed this library.
        let library = unsafe { Library::new(path) }.map_err(|error| {
            let source = std::error::Error::source(&error).map(ToString::to_string);
            unusable(source.unwrap_or_else(|| error.to_string()))
        })?;
        let lsl = Self::of(&library).map_err(|symbol| unusable(format!("it has no function {symbol}")))?;
        // SAFETY: no arguments.
        let version = unsafe { (lsl.library_version)() };
        if version < VERSION_MIN {
            return Err(unusable(format!("its version {}.{} is too old", version / 100, version % 100)));
        }
        // Leaked on purpose, so that it is never unloaded.
        std::mem::forget(library);
        Ok(lsl)
    }

    /// Returns the LSL time, s.
    pub(super) fn local_clock(&self) -> f64 {
        // SAFETY: no arguments.
        unsafe { (self.local_clock)() }
    }

    /// Creates a stream of texts.
    pub(super) fn stream(&self, info: &Info<'_>) -> Result<LslStream, LslError> {
        let [name, kind, source] = [info.name, info.kind, info.source].map(text);
        // SAFETY: C strings that outlive the call, which copies them.
        let described =
            unsafe { (self.create_streaminfo)(name.as_ptr(), kind.as_ptr(), 1, IRREGULAR, STRINGS, source.as_ptr()) };
        if described.is_null() {
            return Err(self.refused());
        }
        for (name, value) in info.about {
            let [name, value] = [name, value].map(|of| text(of));
            // SAFETY: the description is valid until it is destroyed below; the strings outlive the call.
            unsafe { (self.append_child_value)((self.get_desc)(described), name.as_ptr(), value.as_ptr()) };
        }
        // SAFETY: the description is valid; the outlet keeps a copy of it.
        let outlet = unsafe {
            let outlet = (self.create_outlet)(described, 0, BUFFER_S);
            (self.destroy_streaminfo)(described);
            outlet
        };
        NonNull::new(outlet).map(|outlet| LslStream { lsl: *self, outlet }).ok_or_else(|| self.refused())
    }

    fn refused(&self) -> LslError {
        // SAFETY: the library returns null or a string that is valid until the next call on this thread.
        let reason = unsafe {
            let reason = (self.last_error)();
            if reason.is_null() { String::new() } else { CStr::from_ptr(reason).to_string_lossy().into_owned() }
        };
        let reason = if reason.is_empty() { "the library gives no reason".to_owned() } else { reason };
        LslError::Stream { reason }
    }
}

fn missing(searched: &str) -> LslError {
    LslError::Missing { searched: searched.to_owned() }
}

/// Returns a C string; a text with a zero in it ends there.
fn text(of: &str) -> CString {
    CString::new(of.split('\0').next().unwrap_or_default()).unwrap_or_default()
}

/// A stream, which ends when it is dropped.
#[derive(Debug)]
pub(super) struct LslStream {
    lsl: Lsl,
    outlet: NonNull<c_void>,
}

// SAFETY: an outlet may be used from any thread; this one is used by one thread at a time.
unsafe impl Send for LslStream {}

impl LslStream {
    /// Sends this text with this time stamp, s.
    pub(super) fn push(&self, what: &str, at_s: f64) {
        let what = text(what);
        let sample = [what.as_ptr()];
        // SAFETY: the outlet is valid; the C string for its only channel outlives the call, which copies it. The
        // call fails only for a wrong number of channels.
        unsafe { (self.lsl.push_sample_strtp)(self.outlet.as_ptr(), sample.as_ptr(), at_s, PUSH_THROUGH) };
    }

    /// Returns whether a listener is connected.
    pub(super) fn is_received(&self) -> bool {
        // SAFETY: the outlet is valid.
        unsafe { (self.lsl.have_consumers)(self.outlet.as_ptr()) != 0 }
    }
}

impl Drop for LslStream {
    fn drop(&mut self) {
        // SAFETY: the outlet is valid, and nothing uses it after this.
        unsafe { (self.lsl.destroy_outlet)(self.outlet.as_ptr()) };
    }
}
