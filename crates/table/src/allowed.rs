//! Files that a model names: which of them may be opened.

use crate::reason::reason;
use std::fs::{self, File};
use std::io;
use std::path::{Component, Path, PathBuf};

/// The files that a model may read: the model itself, the files in its folder and below, and those that the caller allows.
///
/// A model names other files: meshes, placements, drawings, light, parts of itself. Models are untrusted, so every
/// reader opens such files with [`open`](Self::open), which alone decides whether a file may be read.
///
/// ```
/// use rayweave_table::{AllowedFiles, RefusedFile};
/// use std::path::Path;
///
/// let files = AllowedFiles::of_model(Some(Path::new("models/lens.toml")), &[]);
/// let refused = files.open(&files.folder().join("../../secret.stl")).unwrap_err();
/// assert!(matches!(refused, RefusedFile::Outside));
/// ```
#[derive(Clone, Debug, Default)]
pub struct AllowedFiles {
    folder: PathBuf,
    /// Files and folders without symbolic links.
    roots: Vec<PathBuf>,
}

impl AllowedFiles {
    /// The files of a model in a file, and in addition the given files and folders with everything below them.
    ///
    /// A model without a file, such as a text or a pipe, may read files in the current folder and below.
    pub fn of_model(model: Option<&Path>, allowed: &[PathBuf]) -> AllowedFiles {
        let model = model.filter(|path| !is_stream(path));
        let folder = model.and_then(Path::parent).unwrap_or(Path::new("")).to_owned();
        let given = allowed.iter().map(PathBuf::as_path);
        let roots = [or_current(&folder)].into_iter().chain(model).chain(given);
        AllowedFiles { roots: roots.filter_map(|root| root.canonicalize().ok()).collect(), folder }
    }

    /// The folder that file names in the model are relative to; empty for the current folder.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Opens a file for reading. The path is used unchanged: join it to [`folder`](Self::folder) first.
    ///
    /// # Errors
    ///
    /// [`RefusedFile`] for a file elsewhere, also behind a symbolic link, and for anything but a regular file: opening a FIFO
    /// waits, and a device may never end.
    pub fn open(&self, path: &Path) -> Result<File, RefusedFile> {
        crate::opened::record(path);
        let real = match path.canonicalize() {
            Ok(real) => real,
            Err(error) if self.is_below(path) => return Err(RefusedFile::Io(error)),
            // do not reveal whether a file exists elsewhere
            Err(_) => return Err(RefusedFile::Outside),
        };
        if !self.contains(&real) {
            return Err(RefusedFile::Outside);
        }
        let kind = fs::metadata(&real).map_err(RefusedFile::Io)?;
        match () {
            () if kind.is_dir() => Err(RefusedFile::Folder),
            () if !kind.is_file() => Err(RefusedFile::NotRegular),
            () => File::open(&real).map_err(RefusedFile::Io),
        }
    }

    fn contains(&self, real: &Path) -> bool {
        self.roots.iter().any(|root| real.starts_with(root))
    }

    /// True if a path, of a file that may not exist, leads below one of the roots.
    fn is_below(&self, path: &Path) -> bool {
        let existing = path.ancestors().find_map(|part| Some((part, or_current(part).canonicalize().ok()?)));
        let Some((existing, real)) = existing else { return false };
        let rest = path.strip_prefix(existing).unwrap_or(path);
        self.contains(&real) && rest.components().all(|part| part != Component::ParentDir)
    }
}

/// True for a pipe, a terminal and device files such as `/dev/stdin`, whose folder is not that of the model.
fn is_stream(path: &Path) -> bool {
    let is_special = path.metadata().is_ok_and(|kind| !kind.is_file() && !kind.is_dir());
    is_special || path.starts_with("/dev") || path.starts_with("/proc")
}

fn or_current(folder: &Path) -> &Path {
    if folder.as_os_str().is_empty() { Path::new(".") } else { folder }
}

/// The reason why a file that a model names is not read. Messages quote nothing of the file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RefusedFile {
    /// The file is not among the [`AllowedFiles`].
    #[error(
        "it is outside the folder of the model. \
         Allow the file or its folder with --allow-path on the command line or `allow` in Python and Rust"
    )]
    Outside,
    /// The path leads to a folder.
    #[error("it is a folder")]
    Folder,
    /// The path leads to a FIFO, a socket or a device.
    #[error("it is a pipe or a device, not a regular file")]
    NotRegular,
    /// The operating system reports an error.
    #[error("{}", reason(.0))]
    Io(#[source] io::Error),
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A folder of a test with `in/model`, `in/sub/part` and `out/part`.
    struct Tree(PathBuf);

    impl Tree {
        fn new(name: &str) -> Tree {
            let root = std::env::temp_dir().join(format!("rayweave-allowed-{name}-{}", std::process::id()));
            for folder in ["in/sub", "out"] {
                fs::create_dir_all(root.join(folder)).unwrap();
            }
            for file in ["in/model", "in/sub/part", "out/part"] {
                fs::write(root.join(file), "text").unwrap();
            }
            Tree(root)
        }

        fn files(&self, allowed: &[&str]) -> AllowedFiles {
            let allowed: Vec<PathBuf> = allowed.iter().map(|name| self.0.join(name)).collect();
            AllowedFiles::of_model(Some(&self.0.join("in/model")), &allowed)
        }
    }

    impl Drop for Tree {
        fn drop(&mut self) {
            let _ = fs::remove_dir_all(&self.0);
        }
    }

    fn verdict(files: &AllowedFiles, name: &str) -> &'static str {
        match files.open(&files.folder().join(name)) {
            Ok(_) => "open",
            Err(RefusedFile::Outside) => "outside",
            Err(RefusedFile::Folder) => "folder",
            Err(RefusedFile::NotRegular) => "not regular",
            Err(RefusedFile::Io(_)) => "error",
        }
    }

    #[test]
    fn files_beside_and_below_the_model_may_be_read() {
        let tree = Tree::new("below");
        let files = tree.files(&[]);
        let out = tree.0.join("out/part");
        let out = out.to_str().unwrap();
        let cases = [
            ("model", "open"),
            ("sub/part", "open"),
            ("sub/../sub/./part", "open"),
            ("sub", "folder"),
            ("missing", "error"),
            ("sub/missing/part", "error"),
            ("../out/part", "outside"),
            ("sub/../../out/part", "outside"),
            ("../out/missing", "outside"),
            ("missing/../../out/part", "outside"),
            ("/missing", "outside"),
            (out, "outside"),
        ];
        for (name, expected) in cases {
            assert_eq!(verdict(&files, name), expected, "{name}");
        }
    }

    #[test]
    fn allowed_files_and_folders_may_be_read() {
        let tree = Tree::new("allowed");
        assert_eq!(verdict(&tree.files(&["out"]), "../out/part"), "open");
        assert_eq!(verdict(&tree.files(&["out/part"]), "../out/part"), "open");
        assert_eq!(verdict(&tree.files(&["in/sub", "nowhere"]), "../out/part"), "outside");
        // an allowed folder does not allow a folder whose name has it as a prefix
        fs::create_dir(tree.0.join("out2")).unwrap();
        fs::write(tree.0.join("out2/part"), "").unwrap();
        assert_eq!(verdict(&tree.files(&["out"]), "../out2/part"), "outside");
    }

    #[test]
    #[cfg(unix)]
    fn links_that_lead_outside_and_special_files_are_refused() {
        use std::os::unix::fs::symlink;
        let tree = Tree::new("links");
        let files = tree.files(&[]);
        symlink("../out/part", tree.0.join("in/link")).unwrap();
        symlink("../out", tree.0.join("in/folder")).unwrap();
        symlink("sub/part", tree.0.join("in/inside")).unwrap();
        symlink("../out/missing", tree.0.join("in/dangling")).unwrap();
        let fifo = tree.0.join("in/fifo");
        assert!(std::process::Command::new("mkfifo").arg(&fifo).status().unwrap().success());
        let cases = [
            ("link", "outside"),
            ("folder/part", "outside"),
            ("inside", "open"),
            ("fifo", "not regular"),
            ("/dev/null", "outside"),
        ];
        for (name, expected) in cases {
            assert_eq!(verdict(&files, name), expected, "{name}");
        }
        assert_eq!(verdict(&tree.files(&["/dev"]), "/dev/null"), "not regular");
        // the model may be a link itself: names are relative to the folder of the link
        symlink("../in/model", tree.0.join("out/model")).unwrap();
        let linked = AllowedFiles::of_model(Some(&tree.0.join("out/model")), &[]);
        assert_eq!(verdict(&linked, "model"), "open");
        assert_eq!(verdict(&linked, "part"), "open");
        assert_eq!(verdict(&linked, "../in/sub/part"), "outside");
    }

    #[test]
    fn a_model_without_a_file_reads_in_the_current_folder() {
        for model in [None, Some(Path::new("model.toml"))] {
            let files = AllowedFiles::of_model(model, &[]);
            assert_eq!(files.folder(), Path::new(""));
            assert_eq!(verdict(&files, "Cargo.toml"), "open");
            assert_eq!(verdict(&files, "../error/Cargo.toml"), "outside");
        }
        #[cfg(unix)]
        assert_eq!(AllowedFiles::of_model(Some(Path::new("/dev/stdin")), &[]).folder(), Path::new(""));
    }
}
