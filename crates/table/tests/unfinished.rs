//! A process that exits while its threads are running leaves no temporary file. A separate test program, because the
//! state is per process.

use rayweave_table::AtomicFile;
use std::io::Write;

#[test]
fn no_file_is_created_once_there_is_none() {
    let folder = std::env::temp_dir().join(format!("rayweave-unfinished-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let files = || std::fs::read_dir(&folder).unwrap().count();
    let mut first = AtomicFile::create(folder.join("first.txt")).unwrap();
    let second = AtomicFile::create(folder.join("second.txt")).unwrap();
    first.write_all(b"complete").unwrap();
    assert!(!AtomicFile::none_from_now_on());
    first.finish().unwrap();
    assert!(!AtomicFile::none_from_now_on());
    // still allowed
    drop(AtomicFile::create(folder.join("third.txt")).unwrap());
    drop(second);
    assert_eq!(files(), 1);
    assert!(AtomicFile::none_from_now_on());
    let error = AtomicFile::create(folder.join("third.txt")).unwrap_err().to_string();
    assert!(error.contains("the program ends"), "{error}");
    assert_eq!(files(), 1);
    std::fs::remove_dir_all(&folder).unwrap();
}
