//! Files of samples: tables and arrays, complete and damaged.

use super::code;
use rayweave_photon::{CompareOptions, End, Process, compare, read_sample};
use std::path::PathBuf;

/// A folder that is removed at the end.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Folder {
        let path = std::env::temp_dir().join(format!("rayweave-compare-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&path).unwrap();
        Folder(path)
    }

    fn write(&self, name: &str, bytes: impl AsRef<[u8]>) -> PathBuf {
        let path = self.0.join(name);
        std::fs::write(&path, bytes).unwrap();
        path
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        drop(std::fs::remove_dir_all(&self.0));
    }
}

/// An NPY file of version 1.
fn npy(descr: &str, shape: &str, data: &[u8]) -> Vec<u8> {
    let header = format!("{{'descr': {descr}, 'fortran_order': False, 'shape': {shape}, }}\n");
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.as_bytes());
    bytes.extend(data);
    bytes
}

const STEPS: &str = "photon,track,step,process,time,wavelength_nm,volume
0,0,0,emission,0,400,Tank
0,0,1,rayleigh,1,400,Tank
0,0,1,absorbed,2,400,Tank
1,1,0,emission,0,400,Tank
1,1,1,reemission,1,500,Tank
1,1,2,escaped,3,500,World
1,4611686018427387905,1,reemission,1,510,Tank
1,4611686018427387905,2,detected,4,510,Tank
";

const HISTORIES: &str = "photon,track,steps,history,volume,x,y,z,time,wavelength_nm
0,0,1,emission rayleigh absorbed,Tank,0,0,0,2,400
1,1,2,emission reemission escaped,World,0,0,0,3,500
1,4611686018427387905,2,reemission detected,Tank,0,0,0,4,510
";

/// Steps and histories of the same photons are equal samples; a table of hits is that of their detected ones.
#[test]
fn tables() {
    let folder = Folder::new("tables");
    let steps = read_sample(&folder.write("steps.csv", STEPS)).unwrap();
    let histories = read_sample(&folder.write("histories.csv", HISTORIES)).unwrap();
    assert_eq!(steps.tracks, histories.tracks);
    assert_eq!(steps.volumes, histories.volumes);
    assert_eq!((steps.photons(), steps.tracks.len()), (2, 3));
    assert_eq!(
        &*steps.tracks[0].history,
        [Process::Emission, Process::Rayleigh, Process::End(End::Absorbed)].map(code)
    );
    let hits = "event,photon,x,y,z,time,wavelength_nm,sensor\n0,1,0,0,0,4,510,Tank\n";
    let hits = read_sample(&folder.write("hits.csv", hits)).unwrap();
    let comparison = compare(&steps, &hits, &CompareOptions::default()).unwrap();
    assert!(comparison.is_hits && comparison.photons == [1, 1] && comparison.hits_z == 0.0);
    assert_eq!(comparison.quantity("volume").unwrap().bins[0].label, "Tank");
    assert!(comparison.quantity("history").is_none());
}

/// A structured array with the file of names beside it; without it the names are missing.
#[test]
fn structured_arrays() {
    let folder = Folder::new("structured");
    let descr = "[('photon', '<i8'), ('time', '<f8'), ('wavelength_nm', '<f8'), ('sensor', '<u4')]";
    let mut data = Vec::new();
    for photon in 0..3i64 {
        data.extend(photon.to_le_bytes());
        data.extend((photon as f64).to_le_bytes());
        data.extend(420f64.to_le_bytes());
        data.extend(0u32.to_le_bytes());
    }
    let path = folder.write("hits.npy", npy(descr, "(3,)", &data));
    let error = read_sample(&path).unwrap_err().to_string();
    assert!(error.contains("row 0, column `sensor`") && error.contains(".names.json"), "{error}");
    folder.write("hits.names.json", r#"{"sensor": ["Tube"]}"#);
    let sample = read_sample(&path).unwrap();
    assert_eq!(sample.tracks.iter().map(|track| track.time).collect::<Vec<_>>(), [0.0, 1.0, 2.0]);
    assert_eq!(sample.volumes.unwrap(), ["Tube"]);
    folder.write("hits.names.json", r#"{"sensor": []}"#);
    assert!(read_sample(&path).unwrap_err().to_string().contains("has no name"));
    folder.write("short.names.json", r#"{"sensor": ["Tube"]}"#);
    let path = folder.write("short.npy", npy(descr, "(4,)", &data));
    assert!(read_sample(&path).unwrap_err().to_string().contains("it ends in row 3 of 4"));
}

/// Arrays of Opticks: sequences are compared with tables by flags, hits by times.
#[test]
fn arrays_of_opticks() {
    let folder = Folder::new("opticks");
    // TO SC AB, and TO RE MI: nibbles 13 6 4 and 13 5 3, from the lowest bits
    let words = [0x46du64, 0, 9, 9, 0x35d, 0, 9, 9];
    let data: Vec<u8> = words.iter().flat_map(|word| word.to_le_bytes()).collect();
    let seq = read_sample(&folder.write("seq.npy", npy("'<u8'", "(2, 2, 2)", &data))).unwrap();
    let histories = HISTORIES.lines().take(3).collect::<Vec<_>>().join("\n");
    let table = read_sample(&folder.write("histories.csv", histories)).unwrap();
    let options = CompareOptions { least: 1.0, ..CompareOptions::default() };
    let comparison = compare(&seq, &table, &options).unwrap();
    let own = comparison.quantity("history").unwrap();
    let labels: Vec<&str> = own.bins.iter().map(|bin| bin.label.as_str()).collect();
    assert_eq!(labels, ["TO RE MI", "TO SC AB"]);
    assert_eq!(own.chi2, 0.0);
    assert_eq!(comparison.missing.len(), 2, "{:?}", comparison.missing);
    let mut photons = [0f32; 32];
    (photons[3], photons[11], photons[15]) = (2.5, 420.0, f32::from_bits(0x40));
    photons[16 + 15] = f32::from_bits(0x8);
    let data: Vec<u8> = photons.iter().flat_map(|number| number.to_le_bytes()).collect();
    let hits = read_sample(&folder.write("photon.npy", npy("'<f4'", "(2, 4, 4)", &data))).unwrap();
    assert!(hits.is_hits && hits.is_single && hits.tracks.len() == 1 && hits.tracks[0].time == 2.5);
    // no common quantity: hits without histories, and sequences without a detected photon
    assert!(compare(&seq, &hits, &options).unwrap_err().to_string().contains("no photon is detected"));
}

/// Damaged and foreign files: the file, the place and the reason.
#[test]
fn damaged_files() {
    let folder = Folder::new("damaged");
    let error = |name: &str, bytes: &[u8]| read_sample(&folder.write(name, bytes)).unwrap_err().to_string();
    let changed = |from: &str, to: &str| error("changed.csv", HISTORIES.replace(from, to).as_bytes());
    for (text, parts) in [
        (error("a.csv", b""), vec!["a.csv", "the file is empty"]),
        (error("b.csv", b"photon,x\n1,2\n"), vec!["b.csv", "no column `process`, `history` or `sensor`"]),
        (error("c.csv", b"photon,history\n1,emission\n"), vec!["no column `volume` beside `history`"]),
        (
            changed("rayleigh", "raileigh"),
            vec!["line 2, column `history`", "no process is called \"raileigh\""],
        ),
        (changed("0,0,0,3,500", "0,0,0,nan,500"), vec!["line 3, column `time`", "not finite"]),
        (changed("0,0,0,3,500", "0,0,0,late,500"), vec!["line 3, column `time`", "\"late\" is not a number"]),
        (changed("1,1,2,", "1.5,1,2,"), vec!["line 3, column `photon`", "not a whole number"]),
        (changed("0,0,0,3,500", "0,0,0,3"), vec!["line 3", "9 fields", "10"]),
        (error("d.npy", b"photon"), vec!["d.npy", "not an NPY file"]),
        (error("e.npy", &npy("'<u8'", "(1, 3)", &[0; 24])), vec!["e.npy", "shape"]),
        (error("f.npy", &npy("'<u8'", "(1, 2)", &[0; 16])), vec!["the sequence of row 0 is empty"]),
        (error("g.npy", &npy("'<f4'", "(1, 4)", &[0; 16])), vec!["photons of Opticks have (n, 4, 4)"]),
        (error("h.npy", &npy("'<i4'", "(4,)", &[0; 16])), vec!["its type is <i4"]),
        (error("i.npy", &npy("'<u8'", "(9, 2)", &[0; 16])), vec!["i.npy cannot be compared"]),
        (error("j.npy", &npy("[('photon', '<U7')]", "(1,)", &[0; 28])), vec!["type <U7"]),
        (
            error("k.npy", &npy("[('photon', '<f8', (3,))]", "(1,)", &[0; 24])),
            vec!["the field photon is an array"],
        ),
        (read_sample(&folder.0.join("none.csv")).unwrap_err().to_string(), vec!["none.csv", "no such file"]),
        (read_sample(&folder.0.join("none.npy")).unwrap_err().to_string(), vec!["none.npy", "no such file"]),
    ] {
        assert!(parts.iter().all(|part| text.contains(part)), "{text} without {parts:?}");
    }
}
