//! Addresses without passwords, for sessions and reports, which people pass on.

/// Parts of the names of settings in an address that give access.
const SECRET_WORDS: [&str; 6] = ["pass", "pwd", "token", "key", "secret", "auth"];

/// Returns an address without user and password, and without settings that give access.
pub fn public_address(url: &str) -> String {
    let Some((scheme, rest)) = url.split_once("://") else { return url.to_owned() };
    let (authority, path) = rest.find(['/', '?', '#']).map_or((rest, ""), |at| rest.split_at(at));
    let host = authority.rsplit_once('@').map_or(authority, |(_, host)| host);
    let Some((path, query)) = path.split_once('?') else { return format!("{scheme}://{host}{path}") };
    let setting = |setting: &str| match setting.split_once('=') {
        Some((name, _)) if SECRET_WORDS.iter().any(|word| name.to_ascii_lowercase().contains(word)) => {
            format!("{name}=")
        }
        _ => setting.to_owned(),
    };
    let query: Vec<String> = query.split('&').map(setting).collect();
    format!("{scheme}://{host}{path}?{}", query.join("&"))
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
            ("http://cam/v?accessToken=s3cret", "http://cam/v?accessToken="),
            ("http://127.0.0.1:47160/", "http://127.0.0.1:47160/"),
            ("/dev/video0?size=640x480", "/dev/video0?size=640x480"),
        ] {
            assert_eq!(public_address(given), open);
        }
    }
}
