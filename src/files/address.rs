//! Addresses without passwords, for messages, sessions and reports, which people pass on.

/// Parts of the names of settings that give access, such as `pwd`, `loginpas`, `psw` and `accessToken`.
const SECRET_WORDS: [&str; 7] = ["pas", "pw", "psw", "token", "key", "secret", "auth"];

/// Returns an address without user and password, and without the values of settings that give access.
pub fn public_address(address: &str) -> String {
    let Some((scheme, rest)) = address.split_once("://") else {
        // A scheme that was forgotten or mistyped; a path has no login.
        let login = address.rsplit_once('@').filter(|(login, _)| login.contains(':') && !login.starts_with(['/', '.']));
        return without_secrets(login.map_or(address, |(_, rest)| rest));
    };
    let (authority, path) = parts(rest);
    let (host, path) = match (authority.rsplit_once('@'), path.rsplit_once('@')) {
        (Some((_, host)), _) => (host, path),
        // A `/`, `?` or `#` in a password must be encoded; otherwise it ends the authority within the password.
        (None, Some((_, rest))) if !is_host(authority) => parts(rest),
        _ => (authority, path),
    };
    format!("{scheme}://{host}{}", without_secrets(path))
}

/// Returns the authority of an address without its scheme, and the path with the query.
fn parts(rest: &str) -> (&str, &str) {
    rest.find(['/', '?', '#']).map_or((rest, ""), |at| rest.split_at(at))
}

/// Returns whether this can be a host, with or without a port.
fn is_host(authority: &str) -> bool {
    let port = authority.rsplit_once(':').map_or("", |(_, port)| port);
    port.ends_with(']') || port.bytes().all(|byte| byte.is_ascii_digit())
}

/// Removes the values of settings that give access, of a path with its query. A value extends to the next `&` or `;`: some
/// cameras have their settings in the path, `rtsp://HOST/user=NAME&password=PASSWORD&channel=1`, with any password.
fn without_secrets(path: &str) -> String {
    const ENDS: [char; 2] = ['&', ';'];
    let mut open = String::new();
    for setting in path.split_inclusive(ENDS) {
        match secret_at(setting) {
            Some(at) => {
                open += &setting[..at];
                open += &setting[setting.trim_end_matches(ENDS).len()..];
            }
            None => open += setting,
        }
    }
    open
}

/// Returns the position of a value that gives access.
fn secret_at(setting: &str) -> Option<usize> {
    let mut begin = 0;
    setting.match_indices('=').map(|(at, _)| at + 1).find(|end| {
        let name = setting[begin..*end].rsplit(['/', '?']).next().unwrap_or_default().to_ascii_lowercase();
        begin = *end;
        SECRET_WORDS.iter().any(|word| name.contains(word))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_password_is_left_and_everything_else_stays() {
        for (given, open) in [
            ("http://eva:s3cret@cam:81/video?size=2", "http://cam:81/video?size=2"),
            ("rtsp://eva:a@b@cam/h264", "rtsp://cam/h264"),
            ("http://cam/video?user=eva&pwd=s3cret&fps=30", "http://cam/video?user=eva&pwd=&fps=30"),
            ("http://cam/video?password=a/b=c@d&user=eva", "http://cam/video?password=&user=eva"),
            (
                "http://cam/videostream.cgi?loginuse=eva&loginpas=s3cret",
                "http://cam/videostream.cgi?loginuse=eva&loginpas=",
            ),
            ("http://cam?usr=eva;PW=s3cret;x=1", "http://cam?usr=eva;PW=;x=1"),
            ("http://cam/v?accessToken=s3cret", "http://cam/v?accessToken="),
            (
                "rtsp://cam/user=eva&password=s3cret&channel=1/a.sdp?x",
                "rtsp://cam/user=eva&password=&channel=1/a.sdp?x",
            ),
            ("rtsp://cam/user=eva_password=s3_cret_channel=1.sdp", "rtsp://cam/user=eva_password="),
            ("http://eva:s3/cr?et@cam:81/video", "http://cam:81/video"),
            ("rtsp://cam/user=eva&password=a/b?c&channel=1", "rtsp://cam/user=eva&password=&channel=1"),
            ("http://cam/keys/video?size=2", "http://cam/keys/video?size=2"),
            ("eva:s3cret@cam/video", "cam/video"),
            ("http:/eva:s3cret@cam/video?pw=x", "cam/video?pw="),
            ("/other?pwd=s3cret&size=2", "/other?pwd=&size=2"),
            ("/dev/v4l/by-path/pci-0:1:a@b", "/dev/v4l/by-path/pci-0:1:a@b"),
            ("http://127.0.0.1:47160/", "http://127.0.0.1:47160/"),
            ("http://[::1]/a@b", "http://[::1]/a@b"),
            ("http://cam:81/a@b?c=d", "http://cam:81/a@b?c=d"),
            ("/dev/video0?size=640x480", "/dev/video0?size=640x480"),
        ] {
            assert_eq!(public_address(given), open);
        }
    }
}
