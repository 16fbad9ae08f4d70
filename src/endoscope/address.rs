//! Address of an image source, as given in a rig file.

use std::{fmt, path::PathBuf, str::FromStr};

use nima_files::public_address;
use percent_encoding::percent_decode_str;

/// Maximum length of an address.
const LENGTH_MAX: usize = 2000;

/// Address of an image source.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Address {
    /// Motion JPEG over HTTP.
    Http(Endpoint),
    /// H.264 over RTSP.
    Rtsp(Endpoint),
    /// A camera or capture card of this computer.
    Camera {
        /// Device file.
        path: PathBuf,
        /// Camera settings.
        capture: Capture,
    },
    /// A `.mjpeg` or `.h264` file, a folder of JPEGs, or one JPEG.
    File(PathBuf),
}

/// A camera on the network. `Debug` hides path and password, which may give access.
#[derive(Clone, PartialEq, Eq)]
pub struct Endpoint {
    /// Name or number.
    pub host: String,
    /// TCP port.
    pub port: u16,
    /// Requested path with its query, starting with a slash.
    pub path: String,
    /// User and password, if the address contains them.
    pub login: Option<Login>,
}

/// A user and a password. `Debug` hides the password.
#[derive(Clone, PartialEq, Eq)]
pub struct Login {
    /// Name of the user.
    pub user: String,
    /// The password; empty if the address has none.
    pub password: String,
}

impl fmt::Debug for Login {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Login").field("user", &self.user).finish_non_exhaustive()
    }
}

impl fmt::Debug for Endpoint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // Not its path, which may contain a password.
        f.debug_struct("Endpoint").field("place", &self.place()).field("login", &self.login).finish_non_exhaustive()
    }
}

/// Settings of a local camera. An omitted setting is left unchanged in the camera.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Capture {
    /// Width and height, px.
    pub size_px: Option<[usize; 2]>,
    /// Frames per second.
    pub rate_hz: Option<u32>,
    /// Pixel format; if omitted, the best one that the camera supports.
    pub pixels: Option<Pixels>,
}

/// A pixel format of a camera of this computer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pixels {
    Mjpeg,
    Yuyv,
    Nv12,
}

impl Pixels {
    const ALL: [Self; 3] = [Self::Mjpeg, Self::Yuyv, Self::Nv12];

    const fn name(self) -> &'static str {
        match self {
            Self::Mjpeg => "mjpeg",
            Self::Yuyv => "yuyv",
            Self::Nv12 => "nv12",
        }
    }
}

/// An address that cannot be used.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("\"{address}\" is not a valid image source: {why}")]
pub struct AddressError {
    pub address: String,
    /// The invalid value, and the permitted values.
    pub why: &'static str,
}

impl FromStr for Address {
    type Err = AddressError;

    fn from_str(text: &str) -> Result<Self, AddressError> {
        // Keep the message to one short line that never shows a password.
        let open = public_address(text);
        let public = open.rsplit_once('@').map_or(open.as_str(), |(_, place)| place);
        let shown = || public.chars().take(80).filter(|c| !c.is_control()).collect();
        let wrong = |why| Err(AddressError { address: shown(), why });
        if text.is_empty() {
            return wrong("use http://HOST:PORT/PATH, rtsp://HOST/PATH, /dev/video0, or the path of a file or folder");
        }
        if text.len() > LENGTH_MAX || text.chars().any(char::is_control) {
            return wrong("it is too long, or has characters that no address has");
        }
        if let Some(rest) = text.strip_prefix("v4l2:") {
            return camera(rest.strip_prefix("//").unwrap_or(rest)).or_else(wrong);
        }
        if text.starts_with("/dev/") {
            return camera(text).or_else(wrong);
        }
        let Some((scheme, rest)) = text.split_once("://") else {
            // A user and a password without `http://`: as a path, it would be shown.
            let has_login = open.len() < text.len() && text.contains('@');
            return if has_login { wrong("begin it with http:// or rtsp://") } else { Ok(Self::File(text.into())) };
        };
        match scheme.to_ascii_lowercase().as_str() {
            "http" => endpoint(rest, 80).map(Self::Http).or_else(wrong),
            "rtsp" => endpoint(rest, 554).map(Self::Rtsp).or_else(wrong),
            "file" => Ok(Self::File(rest.into())),
            _ => wrong("only http://, rtsp://, cameras (/dev/video0) and files are supported"),
        }
    }
}

/// Parses a device file, with settings after a question mark.
fn camera(text: &str) -> Result<Address, &'static str> {
    let (path, settings) = text.split_once('?').unwrap_or((text, ""));
    if !path.starts_with("/dev/") {
        return Err("write the camera as /dev/video0 or v4l2:/dev/video0?size=1280x720&rate=30");
    }
    let mut capture = Capture::default();
    for setting in settings.split('&').filter(|setting| !setting.is_empty()) {
        match setting.split_once('=') {
            Some(("size", size)) => {
                let sides = size.split_once('x').and_then(|(a, b)| Some([a.parse().ok()?, b.parse().ok()?]));
                let sides = sides.filter(|sides: &[usize; 2]| sides.iter().all(|side| (16..=4096).contains(side)));
                capture.size_px = Some(sides.ok_or("size must be WIDTHxHEIGHT, 16 to 4096 pixels each")?);
            }
            Some(("rate", rate)) => {
                let rate = rate.parse().ok().filter(|rate| (1..=240).contains(rate));
                capture.rate_hz = Some(rate.ok_or("rate must be 1 to 240 frames per second")?);
            }
            Some(("format", name)) => {
                let pixels = Pixels::ALL.into_iter().find(|pixels| pixels.name() == name);
                capture.pixels = Some(pixels.ok_or("format must be mjpeg, yuyv or nv12")?);
            }
            _ => return Err("the settings of a camera are size, rate and format"),
        }
    }
    Ok(Address::Camera { path: path.into(), capture })
}

/// `USER:PASSWORD@HOST:PORT/PATH`; only the host is required.
fn endpoint(rest: &str, usual_port: u16) -> Result<Endpoint, &'static str> {
    let (authority, path) = rest.find(['/', '?']).map_or((rest, "/"), |at| rest.split_at(at));
    let (login, authority) = match authority.rsplit_once('@') {
        Some((login, authority)) => (Some(self::login(login)?), authority),
        None => (None, authority),
    };
    let bad_port = "the port must be 1 to 65535";
    let (host, port) = match authority.strip_prefix('[').and_then(|rest| rest.split_once(']')) {
        Some((host, port)) => (host, port.strip_prefix(':')),
        None => authority.split_once(':').map_or((authority, None), |(host, port)| (host, Some(port))),
    };
    let port = port.map_or(Ok(usual_port), |port| port.parse().map_err(|_| bad_port))?;
    if port == 0 {
        return Err(bad_port);
    }
    let sound = |text: &str| text.chars().all(|c| c.is_ascii_graphic());
    if host.is_empty() || !sound(host) || !sound(path) {
        return Err("use HOST:PORT/PATH, without spaces");
    }
    let path = if path.starts_with('/') { path.to_owned() } else { format!("/{path}") };
    Ok(Endpoint { host: host.to_owned(), port, path, login })
}

/// `USER:PASSWORD`, with percent-encoding for characters that an address cannot contain.
fn login(text: &str) -> Result<Login, &'static str> {
    let (user, password) = text.split_once(':').unwrap_or((text, ""));
    let decoded = |text: &str| {
        let text = percent_decode_str(text).decode_utf8().ok()?;
        (!text.chars().any(char::is_control)).then(|| text.into_owned())
    };
    let login = decoded(user).zip(decoded(password));
    let (user, password) = login.ok_or("the user or the password contains characters that cannot be sent")?;
    Ok(Login { user, password })
}

impl Endpoint {
    /// Returns host and port, as in a request and in messages: `HOST:PORT`.
    pub(crate) fn place(&self) -> String {
        let (open, close) = if self.host.contains(':') { ("[", "]") } else { ("", "") };
        format!("{open}{}{close}:{}", self.host, self.port)
    }

    /// Returns the address for a request: without user and password, but with all settings, also those that give
    /// access.
    pub(crate) fn url(&self, scheme: &str) -> String {
        format!("{scheme}://{}{}", self.place(), self.path)
    }
}

/// Without user and password, and without settings that give access.
impl fmt::Display for Address {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Http(endpoint) => f.write_str(&public_address(&endpoint.url("http"))),
            Self::Rtsp(endpoint) => f.write_str(&public_address(&endpoint.url("rtsp"))),
            Self::Camera { path, capture: Capture { size_px, rate_hz, pixels } } => {
                write!(f, "v4l2:{}", path.display())?;
                let mut sign = '?';
                let mut setting = |f: &mut fmt::Formatter<'_>, name: &str, value: &dyn fmt::Display| {
                    write!(f, "{}{name}={value}", std::mem::replace(&mut sign, '&'))
                };
                if let Some([width, height]) = size_px {
                    setting(f, "size", &format_args!("{width}x{height}"))?;
                }
                if let Some(rate_hz) = rate_hz {
                    setting(f, "rate", rate_hz)?;
                }
                if let Some(pixels) = pixels {
                    setting(f, "format", &pixels.name())?;
                }
                Ok(())
            }
            Self::File(path) => write!(f, "{}", path.display()),
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn http_of(text: &str) -> (String, u16, String) {
        match text.parse().unwrap() {
            Address::Http(Endpoint { host, port, path, login: None }) => (host, port, path),
            other => panic!("{other}"),
        }
    }

    #[test]
    fn a_password_is_read_and_never_shown() {
        let login_of = |text: &str| match text.parse().unwrap() {
            address @ (Address::Http(_) | Address::Rtsp(_)) => {
                let shown = format!("{address} {address:?}");
                assert!(!shown.contains("secret") && shown.contains("://cam:81/"), "{shown}");
                let (Address::Http(endpoint) | Address::Rtsp(endpoint)) = address else { unreachable!() };
                endpoint.login.map(|login| [login.user, login.password])
            }
            other => panic!("{other}"),
        };
        let expected = |user: &str, password: &str| Some([user.to_owned(), password.to_owned()]);
        assert_eq!(login_of("http://eva:secret:a@b@cam:81/"), expected("eva", "secret:a@b"));
        assert_eq!(login_of("rtsp://eva:secret%2F%3F@cam:81/"), expected("eva", "secret/?"));
        assert_eq!(login_of("http://eva@cam:81"), expected("eva", ""));
        let refused = "http://eva:secret@cam:0/".parse::<Address>().unwrap_err().to_string();
        assert!(!refused.contains("secret"), "{refused}");
    }

    #[test]
    fn a_password_in_the_settings_of_an_address_is_sent_and_never_shown() {
        let mistyped = "eva:secret@cam/video".parse::<Address>().unwrap_err().to_string();
        assert!(!mistyped.contains("secret") && mistyped.contains("http://"), "{mistyped}");
        for (text, shown) in [
            ("http://cam/video?pwd=secret&user=eva", "http://cam:80/video?pwd=&user=eva"),
            ("http://cam:81/?user=eva&password=secret", "http://cam:81/?user=eva&password="),
            ("http://cam/v.cgi?loginuse=eva&loginpas=secret", "http://cam:80/v.cgi?loginuse=eva&loginpas="),
            ("rtsp://cam/user=eva&password=secret&channel=1", "rtsp://cam:554/user=eva&password=&channel=1"),
        ] {
            let address: Address = text.parse().unwrap();
            assert_eq!(address.to_string(), shown);
            assert!(!format!("{address:?}").contains("secret"), "{address:?}");
            let (Address::Http(endpoint) | Address::Rtsp(endpoint)) = address else { panic!("{text}") };
            assert!(endpoint.path.contains("secret") && endpoint.url("http").ends_with(&endpoint.path), "{text}");
        }
        for text in ["http://cam:0/?pwd=secret", "http://cam:0/?pwd=a@secret", "http://eva:secret/@cam/?key=secret"] {
            let refused = text.parse::<Address>().unwrap_err().to_string();
            assert!(!refused.contains("secret") && refused.contains("cam"), "{refused}");
        }
    }

    #[test]
    fn what_people_write_is_understood() {
        assert_eq!(http_of("http://10.0.0.7/stream"), ("10.0.0.7".to_owned(), 80, "/stream".to_owned()));
        assert_eq!(http_of("HTTP://cam:8080"), ("cam".to_owned(), 8080, "/".to_owned()));
        assert_eq!(http_of("http://cam:8080?action=stream").2, "/?action=stream");
        assert_eq!(http_of("http://[::1]:81/a?b=c"), ("::1".to_owned(), 81, "/a?b=c".to_owned()));
        for path in ["/data/case.mjpeg", "pictures", "file:///data/case.mjpeg"] {
            assert!(matches!(path.parse(), Ok(Address::File(_))), "{path}");
        }
    }

    #[test]
    fn what_cannot_be_used_is_told_in_one_line() {
        for (text, word) in [
            ("", "use http"),
            ("rtmp://cam/stream", "only http"),
            ("rtsp://", "HOST"),
            ("v4l2:video0", "/dev/video0"),
            ("/dev/video0?size=1280", "WIDTHxHEIGHT"),
            ("/dev/video0?size=0x720", "16 to 4096"),
            ("/dev/video0?rate=fast", "1 to 240"),
            ("/dev/video0?format=rgb", "mjpeg, yuyv or nv12"),
            ("/dev/video0?brightness=3", "size, rate and format"),
            ("https://cam/", "only http"),
            ("http://user:secret%0A@cam/", "password"),
            ("http://user:secret@", "HOST"),
            ("http://cam:0/", "1 to 65535"),
            ("http://cam:70000/", "1 to 65535"),
            ("http:///stream", "HOST"),
            ("http://cam/a b", "spaces"),
            ("http://cam/a\r\nX: y", "characters"),
        ] {
            let report = text.parse::<Address>().unwrap_err().to_string();
            assert!(report.contains(word) && !report.contains('\n'), "{text}: {report}");
        }
    }

    #[test]
    fn a_camera_of_this_computer_is_named_by_its_device_with_settings() {
        let read = |text: &str| match text.parse().unwrap() {
            Address::Camera { path, capture } => (path, capture),
            other => panic!("{other}"),
        };
        assert_eq!(read("/dev/video0"), ("/dev/video0".into(), Capture::default()));
        let (path, capture) = read("v4l2:/dev/v4l/by-id/usb-x?size=1280x720&rate=30&format=nv12");
        assert_eq!(path, PathBuf::from("/dev/v4l/by-id/usb-x"));
        assert_eq!((capture.size_px, capture.rate_hz), (Some([1280, 720]), Some(30)));
        assert_eq!(capture.pixels, Some(Pixels::Nv12));
        let rtsp: Address = "rtsp://cam/stream".parse().unwrap();
        assert_eq!(rtsp.to_string(), "rtsp://cam:554/stream");
    }

    proptest! {
        #[test]
        fn any_text_is_an_address_or_an_error_and_an_address_reads_as_itself(
            text in "(http://|rtsp://|v4l2:/dev/|/dev/v(.size=[0-9x]{1,9}&rate=[0-9]{1,3}.format=nv12)?)?.{0,40}",
        ) {
            let Ok(mut address) = text.parse::<Address>() else { return Ok(()) };
            let sent = |endpoint: &mut Endpoint, scheme: &str| {
                endpoint.login = None;
                endpoint.url(scheme)
            };
            let again = match &mut address {
                Address::File(_) => return Ok(()),
                Address::Http(endpoint) => sent(endpoint, "http"),
                Address::Rtsp(endpoint) => sent(endpoint, "rtsp"),
                Address::Camera { .. } => address.to_string(),
            };
            prop_assert_eq!(again.parse::<Address>(), Ok(address));
        }
    }
}
