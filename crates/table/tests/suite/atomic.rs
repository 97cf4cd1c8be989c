//! Atomic output files.

use std::fs;
use std::io::{Seek, SeekFrom, Write};

use rayweave_table::AtomicFile;

use crate::folder::Folder;

#[test]
fn finish_replaces_the_target() {
    let folder = Folder::new();
    let target = folder.write("picture.svg", "earlier and longer");
    let mut file = AtomicFile::create(&target).unwrap();
    file.write_all(b"Later").unwrap();
    file.seek(SeekFrom::Start(0)).unwrap();
    file.write_all(b"l").unwrap();
    assert_eq!(fs::read(&target).unwrap(), b"earlier and longer");
    file.finish().unwrap();
    assert_eq!(fs::read(&target).unwrap(), b"later");
    assert_eq!(folder.names(), ["picture.svg"]);
}

#[test]
fn drop_removes_the_temporary_file() {
    let folder = Folder::new();
    let mut file = AtomicFile::create(folder.join("a.png")).unwrap();
    file.write_all(&[7; 1 << 20]).unwrap();
    let [temporary] = &folder.names()[..] else { panic!() };
    assert!(temporary.starts_with(".a.png.") && temporary.ends_with(".tmp"));
    drop(file);
    assert!(folder.names().is_empty());
}

#[test]
fn two_writers_of_one_target_are_independent() {
    let folder = Folder::new();
    let mut first = AtomicFile::create(folder.join("a")).unwrap();
    let mut second = AtomicFile::create(folder.join("a")).unwrap();
    first.write_all(b"first").unwrap();
    second.write_all(b"second").unwrap();
    second.finish().unwrap();
    first.finish().unwrap();
    assert_eq!(fs::read(folder.join("a")).unwrap(), b"first");
    assert_eq!(folder.names(), ["a"]);
}

#[test]
fn a_target_that_became_a_folder_is_an_error_and_cleans_up() {
    let folder = Folder::new();
    let file = AtomicFile::create(folder.join("a")).unwrap();
    fs::create_dir(folder.join("a")).unwrap();
    assert_eq!(folder.text_of(&file.finish().unwrap_err()), "cannot write a: it is a folder.");
    assert_eq!(folder.names(), ["a"]);
}

#[test]
fn a_long_name_fits() {
    let folder = Folder::new();
    let name = "ä".repeat(125);
    AtomicFile::create(folder.join(&name)).unwrap().finish().unwrap();
    assert_eq!(folder.names(), [name]);
}

#[test]
fn creation_errors_have_a_reason() {
    let folder = Folder::new();
    let text_of = |target: &str| folder.text_of(&AtomicFile::create(folder.join(target)).unwrap_err());
    assert_eq!(
        text_of("out/a.png"),
        "cannot create out/a.png: the folder out does not exist. Create it first."
    );
    fs::create_dir(folder.join("out")).unwrap();
    assert_eq!(text_of("out"), "cannot create out: it is a folder.");
    folder.write("file", "");
    assert_eq!(
        text_of("file/a.png"),
        "cannot create file/a.png: a part of its path is a file, not a folder."
    );
    assert!(AtomicFile::create("").is_err());
    assert!(AtomicFile::create(folder.join("..")).is_err());
}

#[cfg(unix)]
#[test]
fn a_link_stays_a_link() {
    let folder = Folder::new();
    for present in [true, false] {
        if present {
            folder.write("real", "earlier");
        } else {
            fs::remove_file(folder.join("real")).unwrap();
            fs::remove_file(folder.join("link")).unwrap();
        }
        std::os::unix::fs::symlink("real", folder.join("link")).unwrap();
        let mut file = AtomicFile::create(folder.join("link")).unwrap();
        file.write_all(b"later").unwrap();
        file.finish().unwrap();
        assert!(fs::symlink_metadata(folder.join("link")).unwrap().is_symlink());
        assert_eq!(fs::read(folder.join("real")).unwrap(), b"later");
    }
}

#[cfg(unix)]
#[test]
fn permissions_of_the_target_are_kept() {
    use std::os::unix::fs::PermissionsExt;
    let folder = Folder::new();
    let target = folder.write("a", "earlier");
    fs::set_permissions(&target, fs::Permissions::from_mode(0o640)).unwrap();
    AtomicFile::create(&target).unwrap().finish().unwrap();
    assert_eq!(fs::metadata(&target).unwrap().permissions().mode() & 0o777, 0o640);
}

#[cfg(target_os = "linux")]
#[test]
fn a_device_is_written_directly() {
    use std::os::unix::fs::FileTypeExt;
    let mut file = AtomicFile::create("/dev/null").unwrap();
    file.write_all(b"gone").unwrap();
    file.finish().unwrap();
    assert!(fs::metadata("/dev/null").unwrap().file_type().is_char_device());
}

#[cfg(windows)]
#[test]
fn a_device_is_written_directly() {
    let mut file = AtomicFile::create("NUL").unwrap();
    file.write_all(b"gone").unwrap();
    file.finish().unwrap();
    assert!(
        !fs::read_dir(".").unwrap().any(|entry| entry.unwrap().file_name().to_string_lossy().contains("NUL"))
    );
}

#[cfg(target_os = "linux")]
#[test]
fn a_failed_write_cannot_be_finished() {
    let mut file = AtomicFile::create("/dev/full").unwrap();
    assert!(file.write_all(&[0; 1 << 20]).is_err());
    let error = file.finish().unwrap_err();
    assert_eq!(error.to_string(), "cannot write /dev/full: an earlier write failed.");
    assert!(matches!(error, rayweave_table::TableError::Io { action: "write", .. }));
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_reported() {
    let mut file = AtomicFile::create("/dev/full").unwrap();
    file.write_all(b"little").unwrap();
    let error = file.finish().unwrap_err();
    assert_eq!(error.to_string(), "cannot write /dev/full: the disk is full.");
    assert_eq!(error.io_kind(), Some(std::io::ErrorKind::StorageFull));
}
