use std::{fs, io::Read as _, sync::mpsc, thread, time::Duration};

use super::*;

/// Returns the result of `work`; a test that hangs fails instead.
fn soon<T: Send + 'static>(work: impl FnOnce() -> T + Send + 'static) -> T {
    let (sender, receiver) = mpsc::channel();
    thread::spawn(move || sender.send(work()));
    receiver.recv_timeout(Duration::from_mins(1)).expect("it hangs")
}

#[test]
fn what_is_no_plain_file_of_a_plausible_size_is_refused_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let place = |name: &str| folder.path().join(name);
    // A sparse file uses no disk space, but reading it would take gigabytes of memory.
    fs::File::create(place("large")).unwrap().set_len(2 << 30).unwrap();
    fs::write(place("bytes"), [0xff; 8]).unwrap();
    let none = fs::File::open(place("none")).unwrap_err().to_string();
    let cases = [
        (folder.path().to_owned(), "it is a folder"),
        (place("large"), "it is larger than the limit of 1 MiB"),
        (place("bytes"), "it is not UTF-8 text"),
        (place("none"), none.as_str()),
    ];
    for (path, words) in cases {
        let error = soon(move || read_text(&path, CONFIG_MAX)).unwrap_err().to_string();
        assert!(error.contains(words), "{words}: {error}");
    }
    let size = open_file(&place("large")).unwrap().1;
    assert_eq!(size, 2 << 30, "what is read in parts may be large");
}

#[test]
fn a_file_that_has_no_size_of_its_own_is_read_up_to_the_limit() {
    // The kernel reports a size of zero for its own files.
    let path = Path::new("/proc/self/maps");
    if path.exists() {
        assert!(read(path, CONFIG_MAX).unwrap().len() > 100);
        assert!(read(path, 100).unwrap_err().to_string().contains("larger than the limit of 100 bytes"));
    }
}

#[test]
fn a_line_without_an_end_is_refused_before_it_fills_the_memory() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("zeros.csv");
    fs::File::create(&path).unwrap().set_len(TABLE_MAX).unwrap();
    let mut taken = Vec::new();
    let error = open_table(&path).unwrap().read_to_end(&mut taken).unwrap_err().to_string();
    assert!(error.contains("a line of more than 1 MiB") && taken.len() < 8 << 20, "{} bytes, {error}", taken.len());
    fs::File::options().write(true).open(&path).unwrap().set_len(TABLE_MAX + 1).unwrap();
    assert!(open_table(&path).unwrap_err().to_string().contains("1024 MiB"));
}

#[cfg(unix)]
mod unix {
    use std::{io::Write as _, os::unix::net::UnixListener, path::PathBuf, process::Command};

    use super::*;

    fn fifo(folder: &Path) -> PathBuf {
        let path = folder.join("fifo");
        assert!(Command::new("mkfifo").arg(&path).status().unwrap().success());
        path
    }

    #[test]
    fn pipes_sockets_and_devices_are_refused_at_once() {
        let folder = tempfile::tempdir().unwrap();
        let socket = folder.path().join("socket");
        let _socket = UnixListener::bind(&socket).unwrap();
        let device = PathBuf::from("/dev/zero");
        let cases = [(fifo(folder.path()), "it is a pipe"), (device, "it is a device"), (socket, "it is a socket")];
        for (path, words) in cases {
            let error = soon(move || read_text(&path, CONFIG_MAX)).unwrap_err().to_string();
            assert!(error.contains(words), "{words}: {error}");
        }
        assert!(open_file(Path::new("/dev/zero")).unwrap_err().to_string().contains("a device"));
    }

    #[test]
    fn a_pipe_is_a_table_while_somebody_writes() {
        let folder = tempfile::tempdir().unwrap();
        let path = fifo(folder.path());
        let all = |path: PathBuf| {
            let mut text = String::new();
            open_table(&path).and_then(|mut input| input.read_to_string(&mut text)).map(|_| text)
        };
        let to = path.clone();
        assert!(soon(move || all(to)).unwrap_err().to_string().contains("no process writes"));
        // Opened for reading and writing, so that the writer does not wait for a reader.
        let mut writer = fs::OpenOptions::new().read(true).write(true).open(&path).unwrap();
        writer.write_all(b"a,b\n1,").unwrap();
        let to = path.clone();
        let reader = thread::spawn(move || all(to));
        thread::sleep(Duration::from_millis(50));
        writer.write_all(b"2\n").unwrap();
        // The reader ends once it has read everything and no process holds the other end.
        thread::sleep(Duration::from_millis(50));
        drop(writer);
        assert_eq!(soon(move || reader.join().unwrap()).unwrap(), "a,b\n1,2\n");
    }

    #[test]
    fn a_pipe_whose_writer_is_silent_is_given_up() {
        let folder = tempfile::tempdir().unwrap();
        let path = fifo(folder.path());
        let _writer = fs::OpenOptions::new().read(true).write(true).open(&path).unwrap();
        let mut input = open_table(&path).unwrap();
        input.pipe = Some(Duration::from_millis(20));
        let error = soon(move || input.read(&mut [0; 8])).unwrap_err().to_string();
        assert!(error.contains("no data arrive through"), "{error}");
    }
}
