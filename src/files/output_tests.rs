use super::*;

fn write(path: &Path, text: &str) -> io::Result<()> {
    write_atomically(path, |out| out.write_all(text.as_bytes()))
}

#[test]
fn a_failure_leaves_the_old_file_and_nothing_else() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("out.csv");
    write(&path, "old").unwrap();
    let failed = write_atomically(&path, |out| out.write_all(b"new").and_then(|()| Err(io::Error::other("full"))));
    assert!(failed.is_err());
    assert_eq!(fs::read(&path).unwrap(), b"old");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
fn a_folder_is_refused_and_an_input_is_found_however_it_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let input = folder.path().join("poses.csv");
    fs::write(&input, "x").unwrap();
    let refused = |path: &Path| check_output(path, &[&input]).unwrap_err().to_string();
    assert!(refused(folder.path()).contains("a folder exists"));
    assert!(write(folder.path(), "x").is_err());
    fs::create_dir(folder.path().join("sub")).unwrap();
    assert!(refused(&folder.path().join("sub/../poses.csv")).contains("is the input"));
    assert!(!cfg!(windows) || refused(&folder.path().join("Poses.CSV")).contains("is the input"));
    check_output(&folder.path().join("other.csv"), &[&input]).unwrap();
    check_output(&folder.path().join("no/such/folder/new"), &[&input]).unwrap_err();
    assert_eq!(fs::read_to_string(&input).unwrap(), "x");
}

#[test]
fn a_file_is_replaced_when_its_reader_has_ended() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("out.csv");
    write(&path, "old").unwrap();
    let reader = File::open(&path).unwrap();
    let ends = std::thread::spawn(move || {
        std::thread::sleep(std::time::Duration::from_millis(50));
        io::read_to_string(reader)
    });
    write(&path, "new").unwrap();
    assert_eq!(fs::read_to_string(&path).unwrap(), "new");
    assert_eq!(ends.join().unwrap().unwrap(), "old");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
fn a_file_is_replaced_beside_its_reader() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("out.csv");
    write(&path, "old").unwrap();
    let reader = File::open(&path).unwrap();
    write(&path, "new").unwrap();
    assert_eq!(fs::read_to_string(&path).unwrap(), "new");
    assert_eq!(io::read_to_string(reader).unwrap(), "old");
}

#[cfg(unix)]
mod unix {
    use std::{
        os::unix::{
            fs::{FileTypeExt as _, MetadataExt as _, PermissionsExt as _, symlink},
            net::UnixListener,
        },
        process::Command,
    };

    use super::*;

    #[test]
    fn what_is_no_plain_file_is_refused_and_stays() {
        let folder = tempfile::tempdir().unwrap();
        let place = |name: &str| folder.path().join(name);
        let run = |program: &str, arguments: &[&str]| Command::new(program).args(arguments).status().unwrap().success();
        assert!(run("mkfifo", &[place("pipe").to_str().unwrap()]));
        let _socket = UnixListener::bind(place("socket")).unwrap();
        fs::create_dir(place("folder")).unwrap();
        symlink(place("none"), place("to nothing")).unwrap();
        symlink(place("pipe"), place("to a pipe")).unwrap();
        let mut cases = vec!["pipe", "socket", "folder", "to nothing", "to a pipe"];
        // Only root can create a device. A copy of /dev/null, so that the real one is never at risk.
        if run("sh", &["-c", &format!("mknod '{}' c 1 3 2>/dev/null", place("device").display())]) {
            cases.push("device");
        }
        let look = |name: &str| fs::symlink_metadata(place(name)).map(|there| (there.ino(), there.mode())).unwrap();
        let before: Vec<_> = cases.iter().map(|name| look(name)).collect();
        for name in &cases {
            for error in [write(&place(name), "x"), check_output(&place(name), &[])].map(Result::unwrap_err) {
                let words = error.to_string();
                assert!(
                    words.contains("never replaced") || words.contains("a link to a file that does not exist"),
                    "{words}"
                );
            }
        }
        assert_eq!(cases.iter().map(|name| look(name)).collect::<Vec<_>>(), before);
        assert!(fs::symlink_metadata(place("pipe")).unwrap().file_type().is_fifo() && !place("none").exists());
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), cases.len(), "something was left behind");
    }

    #[test]
    fn the_mode_of_a_file_stays_and_a_new_one_goes_by_the_umask() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("out.csv");
        let mode = |path: &Path| fs::metadata(path).unwrap().mode() & 0o7777;
        write(&path, "1").unwrap();
        let usual = folder.path().join("usual");
        fs::write(&usual, "").unwrap();
        assert_eq!(mode(&path), mode(&usual));
        for kept in [0o600, 0o664, 0o400] {
            fs::set_permissions(&path, fs::Permissions::from_mode(kept)).unwrap();
            write(&path, "2").unwrap();
            assert_eq!(mode(&path), kept, "{kept:o}");
        }
    }

    #[test]
    fn a_link_stays_and_its_file_is_replaced_beside_itself() {
        let here = tempfile::tempdir().unwrap();
        let there = tempfile::tempdir().unwrap();
        let link = here.path().join("link");
        let file = there.path().join("file");
        fs::write(&file, "old").unwrap();
        symlink(&file, &link).unwrap();
        write(&link, "new").unwrap();
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
        assert_eq!(fs::read_to_string(&file).unwrap(), "new");
        assert_eq!([&here, &there].map(|folder| fs::read_dir(folder.path()).unwrap().count()), [1, 1]);
    }

    #[test]
    fn an_output_that_is_an_input_is_found_by_any_name() {
        let folder = tempfile::tempdir().unwrap();
        let place = |name: &str| folder.path().join(name);
        let [input, other] = ["input", "other"].map(place);
        fs::write(&input, "x").unwrap();
        fs::write(&other, "x").unwrap();
        symlink(&input, place("link")).unwrap();
        fs::hard_link(&input, place("hard link")).unwrap();
        for name in ["input", "link", "hard link"] {
            let error = check_output(&place(name), &[&other, &input]).unwrap_err().to_string();
            assert!(error.contains("is the input") && error.contains("itself"), "{name}: {error}");
            // The same with the roles swapped: the input is given by a link.
            check_output(&input, &[&other, &place(name)]).unwrap_err();
        }
        check_output(&other, &[&input]).unwrap();
        check_output(&place("new"), &[&input]).unwrap();
        check_output(&place("no/such/folder/new"), &[&input]).unwrap_err();
    }
}
