//! POV-Ray as an external program.

use rayweave::render::{Image, Size};
use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::Command;

/// A scene on disk for POV-Ray.
pub struct Peer {
    scene: PathBuf,
    out: PathBuf,
    size: Size,
}

/// POV-Ray's acceleration structures: slabs, and binary space partition.
const METHODS: [&str; 2] = ["+BM1", "+BM2"];

impl Peer {
    /// Writes the scene.
    pub fn new(text: &str, folder: &Path, name: &str, size: Size) -> Result<Peer, Box<dyn Error>> {
        let scene = folder.join(format!("{name}.pov"));
        std::fs::write(&scene, text)?;
        Ok(Peer { scene, out: folder.join(format!("{name}-povray.png")), size })
    }

    /// Renders on one thread without anti-aliasing; returns the processor seconds of tracing that POV-Ray
    /// reports.
    pub fn draw(&self) -> Result<f64, Box<dyn Error>> {
        let times = METHODS.map(|method| self.draw_by(method));
        times.into_iter().try_fold(f64::INFINITY, |least, time| Ok(least.min(time?)))
    }

    fn draw_by(&self, method: &str) -> Result<f64, Box<dyn Error>> {
        let output = Command::new("povray")
            .arg(format!("+I{}", self.scene.display()))
            .arg(format!("+O{}", self.out.display()))
            .arg(format!("+W{}", self.size.width()))
            .arg(format!("+H{}", self.size.height()))
            .args(["-D", "-A", "-P", "+WT1", "+FN8", method])
            .output()?;
        let said = String::from_utf8_lossy(&output.stderr);
        let trace = said.split("Trace Time:").nth(1).ok_or_else(|| format!("no picture: {said}"))?;
        let time = trace.split("with").nth(1).and_then(|rest| rest.split_whitespace().next());
        Ok(time.ok_or("no time is printed")?.parse()?)
    }

    /// The rendered picture.
    pub fn picture(&self) -> Result<Image, Box<dyn Error>> {
        let file = std::io::BufReader::new(std::fs::File::open(&self.out)?);
        let mut decoder = ::png::Decoder::new(file);
        decoder.set_transformations(::png::Transformations::normalize_to_color8());
        let mut reader = decoder.read_info()?;
        let mut bytes = vec![0; reader.output_buffer_size().ok_or("the picture is too large")?];
        let info = reader.next_frame(&mut bytes)?;
        let channels = info.color_type.samples();
        let pixel = |own: &[u8]| [own[0], own[1 % channels], own[2 % channels], 255];
        let values = bytes[..info.buffer_size()].chunks(channels).map(pixel).collect();
        Image::from_values(self.size, values).ok_or_else(|| "the picture has a different size".into())
    }
}
