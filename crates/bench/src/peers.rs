//! Peers: other systems, each behind a small program that reads commands line by line and reports its own times.
//!
//! A driver is started in a folder with the inputs and prints `peer NAME VERSION TASK TASK ...`.
//! Then it answers each line: `run TASK FILE N` with `seconds S`, the time that the first N rays of
//! FILE.npy took it; `answer TASK FILE N OUT` with `done` once OUT.npy contains the times, float64
//! of shape (H, N), padded with +inf. Any failure is `error TEXT`. The driver ends at the end of
//! its input. If the variable `RAYWEAVE_BENCH_CLOCK` is `processor`, it reports processor times. A
//! task `NAME/all` is NAME on the number of threads in the variable `RAYWEAVE_THREADS`; its times
//! are wall-clock times. Missing peers are reported and skipped.

use crate::answer::Lists;
use crate::clock::Clock;
use crate::interleaved::{Candidate, Role};
use rayweave::model::Rays;
use std::cell::RefCell;
use std::fs;
use std::io::{self, BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::rc::Rc;
use std::sync::atomic::{AtomicUsize, Ordering};

/// A system to compare with.
struct Known {
    name: &'static str,
    role: Role,
    /// The interpreter or program, relative to the folder where peers are installed.
    program: &'static str,
    /// The driver, if the program is an interpreter: its name and text.
    script: Option<(&'static str, &'static str)>,
}

/// The module that all drivers in Python import.
const DRIVER: (&str, &str) = ("driver.py", include_str!("../peers/driver.py"));

/// The name of the driver of this project's Python package.
pub const FROM_PYTHON: &str = "Rayweave from Python";

const KNOWN: &[Known] = &[
    Known {
        name: "NumPy",
        role: Role::Peer,
        program: "py/bin/python",
        script: Some(("peer_numpy.py", include_str!("../peers/peer_numpy.py"))),
    },
    Known { name: "VecGeom", role: Role::Peer, program: "vecgeom", script: None },
    Known {
        name: "Raysect",
        role: Role::Peer,
        program: "py/bin/python",
        script: Some(("peer_raysect.py", include_str!("../peers/peer_raysect.py"))),
    },
    Known {
        name: "PyRayT",
        role: Role::Peer,
        program: "pyrayt/bin/python",
        script: Some(("peer_pyrayt.py", include_str!("../peers/peer_pyrayt.py"))),
    },
    Known {
        name: "Geant4",
        role: Role::Peer,
        program: "py/bin/python",
        script: Some(("peer_geant4.py", include_str!("../peers/peer_geant4.py"))),
    },
    Known {
        name: "Embree",
        role: Role::Peer,
        program: "py/bin/python",
        script: Some(("peer_embree.py", include_str!("../peers/peer_embree.py"))),
    },
    Known {
        name: FROM_PYTHON,
        role: Role::Ours,
        program: "py/bin/python",
        script: Some(("peer_rayweave.py", include_str!("../peers/peer_rayweave.py"))),
    },
];

/// The peers that were started, and the reasons why others were not.
#[derive(Default)]
pub struct Peers {
    running: Vec<Rc<RefCell<Peer>>>,
    /// Names of peers that are missing, each with the reason.
    pub missing: Vec<(String, String)>,
    /// Folder for inputs and results, removed at the end.
    folder: Option<Folder>,
}

/// A running peer that waits for commands.
struct Peer {
    name: String,
    role: Role,
    version: String,
    tasks: Vec<String>,
    folder: PathBuf,
    input: ChildStdin,
    output: BufReader<ChildStdout>,
    child: Child,
}

/// A folder that is removed with its contents.
struct Folder(PathBuf);

impl Drop for Folder {
    fn drop(&mut self) {
        // a failure to remove the folder is ignored
        let _ = fs::remove_dir_all(&self.0);
    }
}

impl Drop for Peer {
    fn drop(&mut self) {
        // the process may have ended
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

impl Peers {
    /// Starts the peers that are installed in a folder; without a folder all are missing. `threads` applies to tasks on all threads.
    pub fn start(installed: Option<&Path>, clock: Clock, threads: usize) -> io::Result<Peers> {
        let Some(installed) = installed else {
            let reason = "no folder with peers was given (--peers)";
            let missing = KNOWN.iter().map(|known| (known.name.to_owned(), reason.to_owned()));
            return Ok(Peers { missing: missing.collect(), ..Peers::default() });
        };
        let folder = std::env::temp_dir().join(unique("rayweave-bench"));
        fs::create_dir_all(&folder)?;
        let mut peers = Peers { folder: Some(Folder(folder.clone())), ..Peers::default() };
        let installed = installed.canonicalize()?;
        for known in KNOWN {
            match Peer::start(known, &installed, &folder, clock, threads) {
                Ok(peer) => peers.running.push(Rc::new(RefCell::new(peer))),
                Err(reason) => peers.missing.push((known.name.to_owned(), reason)),
            }
        }
        Ok(peers)
    }

    /// The names of the peers that run, with their versions.
    pub fn running(&self) -> Vec<(String, String)> {
        let one = |peer: &Rc<RefCell<Peer>>| {
            let peer = peer.borrow();
            (peer.name.clone(), peer.version.clone())
        };
        self.running.iter().map(one).collect()
    }

    /// Writes rays to a file for the peers.
    pub fn give_rays(&self, file: &str, rays: Rays<'_>) -> io::Result<()> {
        let columns = rays.origins.into_iter().chain(rays.directions);
        let rows = columns.flat_map(|column| column.iter().copied());
        self.give(file, &[6, rays.len()], rows)
    }

    /// Writes an array to a file for the peers.
    pub fn give<T: npyz::Serialize + npyz::AutoSerialize>(
        &self,
        file: &str,
        shape: &[usize],
        values: impl IntoIterator<Item = T>,
    ) -> io::Result<()> {
        use npyz::WriterBuilder;
        let Some(Folder(folder)) = self.folder.as_ref() else { return Ok(()) };
        let shape: Vec<u64> = shape.iter().map(|&n| n as u64).collect();
        let file = io::BufWriter::new(fs::File::create(folder.join(file).with_extension("npy"))?);
        let mut writer = npyz::WriteOptions::new().default_dtype().shape(&shape).writer(file).begin_nd()?;
        writer.extend(values)?;
        writer.finish()
    }

    /// Candidates for a task about the first rays of a file, at most `most`, one for each peer that supports the task.
    pub fn candidates(&self, task: &str, file: &str, most: usize) -> Vec<Candidate<'static>> {
        let able = self.running.iter().filter(|peer| peer.borrow().can(task));
        let candidate = |peer: &Rc<RefCell<Peer>>| {
            let (name, order) = (peer.borrow().name.clone(), format!("run {task} {file}"));
            let peer = Rc::clone(peer);
            let role = peer.borrow().role;
            Candidate::elsewhere(name, most, move |items| peer.borrow_mut().seconds(&order, items)).role(role)
        };
        able.map(candidate).collect()
    }

    /// Results of the peers for the first `count` rays of a file, each with the name of the peer.
    pub fn answers(&self, task: &str, file: &str, count: usize) -> Vec<(String, Result<Lists, String>)> {
        let able = self.running.iter().filter(|peer| peer.borrow().can(task));
        let answer = |peer: &Rc<RefCell<Peer>>| {
            let mut peer = peer.borrow_mut();
            (peer.name.clone(), peer.answer(task, file, count))
        };
        able.map(answer).collect()
    }
}

impl Peer {
    fn start(
        known: &Known,
        installed: &Path,
        folder: &Path,
        clock: Clock,
        threads: usize,
    ) -> Result<Peer, String> {
        let program = installed.join(known.program);
        if !program.exists() {
            return Err(format!(
                "`{}` is missing in the folder of the peers: see install.sh.",
                known.program
            ));
        }
        let mut command = Command::new(program);
        if let Some(script) = known.script {
            for (name, text) in [DRIVER, script] {
                fs::write(folder.join(name), text).map_err(|error| error.to_string())?;
            }
            command.arg(script.0);
        }
        command.current_dir(folder).env("OMP_NUM_THREADS", "1").env("PYTHONDONTWRITEBYTECODE", "1");
        command.env("RAYWEAVE_THREADS", threads.to_string());
        if clock == Clock::Processor {
            command.env("RAYWEAVE_BENCH_CLOCK", "processor");
        }
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::null());
        let mut child = command.spawn().map_err(|error| error.to_string())?;
        let pipes = child.stdin.take().zip(child.stdout.take());
        let (input, output) = pipes.ok_or("it has no pipes")?;
        let output = BufReader::new(output);
        let name = known.name.to_owned();
        let folder = folder.to_owned();
        let role = known.role;
        let mut peer =
            Peer { name, role, version: String::new(), tasks: Vec::new(), folder, input, output, child };
        peer.introduce()?;
        Ok(peer)
    }

    /// Reads the first line of a driver.
    fn introduce(&mut self) -> Result<(), String> {
        let line = self.line()?;
        let mut words = line.split_whitespace().map(str::to_owned);
        match (words.next().as_deref(), words.next(), words.next()) {
            (Some("peer"), Some(_), Some(version)) => self.version = version,
            _ => return Err(line),
        }
        self.tasks = words.collect();
        Ok(())
    }

    fn can(&self, task: &str) -> bool {
        self.tasks.iter().any(|known| known == task)
    }

    /// The next line of the protocol; systems print other lines when they are loaded.
    fn line(&mut self) -> Result<String, String> {
        loop {
            let mut line = String::new();
            match self.output.read_line(&mut line) {
                Ok(0) => return Err("its driver has ended. Start it by hand to see why.".to_owned()),
                Ok(_) => {}
                Err(error) => return Err(error.to_string()),
            }
            let line = line.trim();
            let word = line.split(' ').next().unwrap_or_default();
            match word {
                "error" => return Err(line["error".len()..].trim().to_owned()),
                "peer" | "seconds" | "done" => return Ok(line.to_owned()),
                _ => {}
            }
        }
    }

    fn order(&mut self, order: &str) -> Result<String, String> {
        writeln!(self.input, "{order}")
            .and_then(|()| self.input.flush())
            .map_err(|error| error.to_string())?;
        self.line()
    }

    fn seconds(&mut self, order: &str, items: f64) -> Result<f64, String> {
        let line = self.order(&format!("{order} {items}"))?;
        let number = line.split_whitespace().nth(1).and_then(|word| word.parse().ok());
        number.ok_or_else(|| format!("`{line}` is not a time"))
    }

    fn answer(&mut self, task: &str, file: &str, count: usize) -> Result<Lists, String> {
        self.order(&format!("answer {task} {file} {count} answer"))?;
        let bytes = fs::read(self.folder.join("answer.npy")).map_err(|error| error.to_string())?;
        read(&bytes).map_err(|error| format!("its answer is not an array: {error}"))
    }
}

/// A unique name.
fn unique(beginning: &str) -> String {
    static NEXT: AtomicUsize = AtomicUsize::new(0);
    format!("{beginning}-{}-{}", std::process::id(), NEXT.fetch_add(1, Ordering::Relaxed))
}

/// The columns of a two-dimensional array, without entries that are not finite.
fn read(bytes: &[u8]) -> io::Result<Lists> {
    let file = npyz::NpyFile::new(bytes)?;
    let (shape, order) = (file.shape().to_vec(), file.order());
    let &[rows, columns] = &shape[..] else {
        return Err(io::Error::other(format!("{} dimensions instead of 2", shape.len())));
    };
    let (rows, columns) = (rows as usize, columns as usize);
    let values: Vec<f64> = file.into_vec()?;
    let at = |row: usize, column: usize| match order {
        npyz::Order::C => values[row * columns + column],
        npyz::Order::Fortran => values[column * rows + row],
    };
    let column = |column: usize| (0..rows).map(|row| at(row, column)).filter(|t| t.is_finite()).collect();
    Ok((0..columns).map(column).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn without_a_folder_all_are_missing() {
        let peers = Peers::start(None, Clock::Wall, 1).unwrap();
        assert_eq!(peers.missing.len(), KNOWN.len());
        assert!(peers.candidates("die.full", "rays", 10).is_empty());
    }

    #[test]
    fn what_is_not_installed_is_missing_for_a_reason() {
        let peers = Peers::start(Some(&std::env::temp_dir()), Clock::Wall, 1).unwrap();
        assert!(peers.running().is_empty());
        assert!(peers.missing.iter().all(|(_, reason)| reason.contains("install.sh")));
    }

    #[test]
    #[cfg(unix)]
    fn a_driver_is_understood() {
        use std::os::unix::fs::PermissionsExt;
        let installed = std::env::temp_dir().join(unique("rayweave-bench-test"));
        let _removed = Folder(installed.clone());
        fs::create_dir_all(&installed).unwrap();
        let script = "#!/bin/sh\necho some noise\necho peer VecGeom 9.9 die.full\n\
                      while read verb task file n; do case $n in 7) echo error seven;; *) echo seconds 0.5;; esac; done\n";
        let program = installed.join("vecgeom");
        fs::write(&program, script).unwrap();
        fs::set_permissions(&program, fs::Permissions::from_mode(0o755)).unwrap();

        let peers = Peers::start(Some(&installed), Clock::Processor, 1).unwrap();
        assert_eq!(peers.running(), [("VecGeom".to_owned(), "9.9".to_owned())]);
        assert!(peers.candidates("die.first", "rays", 10).is_empty());
        assert_eq!(peers.candidates("die.full", "rays", 10).len(), 1);
        let mut peer = peers.running[0].borrow_mut();
        assert_eq!(peer.seconds("run die.full rays", 10.0), Ok(0.5));
        assert_eq!(peer.seconds("run die.full rays", 7.0), Err("seven".to_owned()));
    }

    #[test]
    fn arrays_become_lists() {
        use npyz::WriterBuilder;
        let mut bytes = Vec::new();
        let options = npyz::WriteOptions::new().default_dtype().shape(&[2, 3]);
        let mut writer = options.writer(&mut bytes).begin_nd().unwrap();
        writer.extend([1.0, 2.0, f64::INFINITY, 3.0, f64::INFINITY, f64::INFINITY]).unwrap();
        writer.finish().unwrap();
        assert_eq!(read(&bytes).unwrap(), [vec![1.0, 3.0], vec![2.0], vec![]]);
    }
}
