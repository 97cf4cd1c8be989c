//! The one error of the library.

use crate::files::ContourProblems;
use rayweave_analysis::infill::InfillError;
use rayweave_analysis::measure::MeasureError;
use rayweave_analysis::section::SectionError;
use rayweave_formats::WriteError;
use rayweave_model::{BadRay, CompileError, WindowError};
use rayweave_optics::OpticsError;
use rayweave_render::{CameraError, RenderError, TimelineError};
use rayweave_rootray::RootRayError;
use rayweave_scene::Diagnostics;
use rayweave_shape::RayError;
use rayweave_shape::primitive::ShapeError;
use rayweave_space::polygon::{LineError, PolygonError};
use rayweave_table::TableError;
use rayweave_trace::single_hit::TooLarge;
use std::fmt;

/// Anything that can go wrong, as "problem (why) suggestion?".
///
/// Opaque: what it holds may grow. [`Error::kind`] and the predicates say what sort of thing happened;
/// [`Error::diagnostics`] gives the places in a model file.
pub struct Error(Box<Cause>);

/// The sorts of errors.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum ErrorKind {
    /// A shape's parameters are wrong.
    Shape,
    /// A solid cannot be compiled: a singular transform, sizes that overflow, a tree too large for an evaluator.
    Compile,
    /// A model file cannot be read or is wrong.
    ModelFile,
    /// A file of rays, or another input file, cannot be read or is wrong.
    Input,
    /// An output file cannot be written.
    Output,
    /// The name of a file tells no format that is known, or one that this build cannot write.
    Format,
    /// A value is out of range: a ray without direction, an empty window of time, a root that is NaN, a picture without pixels.
    Value,
    /// A solid cannot be asked this, because it is empty or unbounded.
    Solid,
    /// An optical system that does not fit together, or light that cannot be traced through it.
    Optics,
    /// A name that nothing has.
    Name,
    /// Somebody asked the run to stop.
    Cancelled,
}

enum Cause {
    Shape(ShapeError),
    Compile(CompileError),
    TooLarge(TooLarge),
    ModelFile(Diagnostics),
    Input(TableError),
    Output(TableError),
    Window(WindowError),
    Ray(RayError),
    Rays(BadRay),
    RootRay(RootRayError),
    Camera(CameraError),
    Render(RenderError),
    Timeline(TimelineError),
    Infill(InfillError),
    Section(SectionError),
    Measure(MeasureError),
    Write(WriteError),
    Polygon(PolygonError),
    Line(LineError),
    Contours(ContourProblems),
    Optics(OpticsError),
    Wish(String),
    Name(String),
    Said(ErrorKind, String),
    Cancelled,
}

impl Error {
    /// What sort of thing happened.
    pub fn kind(&self) -> ErrorKind {
        match *self.0 {
            Cause::Shape(_) => ErrorKind::Shape,
            Cause::Compile(_) | Cause::TooLarge(_) => ErrorKind::Compile,
            Cause::ModelFile(_) => ErrorKind::ModelFile,
            Cause::Input(TableError::Format { .. }) | Cause::Output(TableError::Format { .. }) => {
                ErrorKind::Format
            }
            Cause::Input(_) | Cause::Contours(_) => ErrorKind::Input,
            Cause::Output(_) => ErrorKind::Output,
            Cause::Render(RenderError::Cancelled)
            | Cause::Infill(InfillError::Cancelled)
            | Cause::Measure(MeasureError::Cancelled)
            | Cause::Section(SectionError::Cancelled)
            | Cause::Optics(OpticsError::Cancelled)
            | Cause::Cancelled => ErrorKind::Cancelled,
            Cause::Infill(
                InfillError::Empty { .. } | InfillError::Unbounded { .. } | InfillError::TooFar { .. },
            )
            | Cause::Measure(MeasureError::Unbounded { .. } | MeasureError::TooFar { .. })
            | Cause::Write(WriteError::Unbounded { .. } | WriteError::Kernel { .. }) => ErrorKind::Solid,
            Cause::Write(WriteError::Compile(_)) => ErrorKind::Compile,
            Cause::Write(_)
            | Cause::Window(_)
            | Cause::Ray(_)
            | Cause::Rays(_)
            | Cause::RootRay(_)
            | Cause::Camera(_)
            | Cause::Render(_)
            | Cause::Timeline(_)
            | Cause::Infill(_)
            | Cause::Section(_)
            | Cause::Measure(_)
            | Cause::Polygon(_)
            | Cause::Line(_)
            | Cause::Wish(_) => ErrorKind::Value,
            Cause::Optics(_) => ErrorKind::Optics,
            Cause::Name(_) => ErrorKind::Name,
            Cause::Said(kind, _) => kind,
        }
    }

    /// True if a shape's parameters are wrong.
    pub fn is_shape(&self) -> bool {
        self.kind() == ErrorKind::Shape
    }

    /// True if a solid cannot be compiled.
    pub fn is_compile(&self) -> bool {
        self.kind() == ErrorKind::Compile
    }

    /// True if a model file cannot be read or is wrong.
    pub fn is_model_file(&self) -> bool {
        self.kind() == ErrorKind::ModelFile
    }

    /// True if a file of rays, or another input file, cannot be read or is wrong.
    pub fn is_input(&self) -> bool {
        self.kind() == ErrorKind::Input
    }

    /// True if an output file cannot be written.
    pub fn is_output(&self) -> bool {
        self.kind() == ErrorKind::Output
    }

    /// True if the name of a file tells no format that is known.
    pub fn is_format(&self) -> bool {
        self.kind() == ErrorKind::Format
    }

    /// True if a value is out of range.
    pub fn is_value(&self) -> bool {
        self.kind() == ErrorKind::Value
    }

    /// True if a solid cannot be asked this, because it is empty or unbounded.
    pub fn is_solid(&self) -> bool {
        self.kind() == ErrorKind::Solid
    }

    /// True if an optical system does not fit together, or light cannot be traced through it.
    pub fn is_optics(&self) -> bool {
        self.kind() == ErrorKind::Optics
    }

    /// True if a name is unknown.
    pub fn is_name(&self) -> bool {
        self.kind() == ErrorKind::Name
    }

    /// True if somebody asked the run to stop.
    pub fn is_cancelled(&self) -> bool {
        self.kind() == ErrorKind::Cancelled
    }

    /// True if whoever read our output has gone, as `head` does when it has seen enough.
    pub fn is_broken_pipe(&self) -> bool {
        match &*self.0 {
            Cause::Output(error) => error.io_kind() == Some(std::io::ErrorKind::BrokenPipe),
            _ => false,
        }
    }

    /// The problems of a model file, each with its place.
    pub fn diagnostics(&self) -> Option<&Diagnostics> {
        match &*self.0 {
            Cause::ModelFile(diagnostics) => Some(diagnostics),
            _ => None,
        }
    }

    /// Somebody asked the run to stop.
    pub(crate) fn cancelled() -> Error {
        Error(Box::new(Cause::Cancelled))
    }

    /// A question that makes no sense, in words.
    pub(crate) fn said(kind: ErrorKind, text: String) -> Error {
        Error(Box::new(Cause::Said(kind, text)))
    }

    /// An input file is at fault.
    pub(crate) fn input(error: TableError) -> Error {
        Error(Box::new(Cause::Input(error)))
    }

    /// An output file is at fault.
    pub(crate) fn output(error: TableError) -> Error {
        Error(Box::new(Cause::Output(error)))
    }

    /// A file of contours is at fault.
    pub(crate) fn contours(problems: ContourProblems) -> Error {
        Error(Box::new(Cause::Contours(problems)))
    }

    /// A picture that is wished cannot be drawn.
    pub(crate) fn wish(text: String) -> Error {
        Error(Box::new(Cause::Wish(text)))
    }

    /// There is no `what` of this name; the one that was probably meant is suggested.
    pub(crate) fn unknown<'a>(what: &str, name: &str, known: impl Iterator<Item = &'a str> + Clone) -> Error {
        let names: Vec<&str> = known.clone().collect();
        let reason = match names.len() {
            0 => "there is none".to_owned(),
            1..=12 => format!("there is {}", names.join(", ")),
            n => format!("there is {}, ... and {} more", names[..10].join(", "), n - 10),
        };
        let suggestion =
            nearest(name, known).map(|meant| format!(" did you mean `{meant}`?")).unwrap_or_default();
        let text = format!("no {what} is called `{name}` ({reason}){suggestion}");
        Error(Box::new(Cause::Name(text)))
    }
}

/// The name with the fewest edits, if they are few enough to be a slip: one for every three letters.
fn nearest<'a>(name: &str, known: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    let edits = |other: &&str| strsim::damerau_levenshtein(name, other);
    let best = known.min_by_key(edits)?;
    let most = (name.chars().count() / 3).max(1);
    (edits(&best) <= most).then_some(best)
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &*self.0 {
            Cause::Shape(error) => error.fmt(f),
            Cause::Compile(error) => error.fmt(f),
            Cause::TooLarge(error) => error.fmt(f),
            Cause::ModelFile(diagnostics) => diagnostics.fmt(f),
            Cause::Input(error) | Cause::Output(error) => error.fmt(f),
            Cause::Window(error) => error.fmt(f),
            Cause::Ray(error) => error.fmt(f),
            Cause::Rays(error) => error.fmt(f),
            Cause::RootRay(error) => error.fmt(f),
            Cause::Camera(error) => error.fmt(f),
            Cause::Render(error) => error.fmt(f),
            Cause::Timeline(error) => error.fmt(f),
            Cause::Infill(error) => error.fmt(f),
            Cause::Section(error) => error.fmt(f),
            Cause::Measure(error) => error.fmt(f),
            Cause::Write(error) => error.fmt(f),
            Cause::Polygon(error) => error.fmt(f),
            Cause::Line(error) => error.fmt(f),
            Cause::Contours(problems) => problems.fmt(f),
            Cause::Optics(error) => error.fmt(f),
            Cause::Wish(text) | Cause::Name(text) | Cause::Said(_, text) => f.write_str(text),
            Cause::Cancelled => f.write_str("cancelled"),
        }
    }
}

/// As [`fmt::Display`] prints it, so that `unwrap` and a `main` that returns it can be read.
impl fmt::Debug for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:?}: {self}", self.kind())
    }
}

impl std::error::Error for Error {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        // the causes say everything in their own text, which is ours too; only theirs goes on
        match &*self.0 {
            Cause::Input(error) | Cause::Output(error) => error.source(),
            _ => None,
        }
    }
}

macro_rules! from {
    ($($error:ty => $cause:ident),* $(,)?) => {$(
        impl From<$error> for Error {
            fn from(error: $error) -> Error {
                Error(Box::new(Cause::$cause(error)))
            }
        }
    )*};
}

from! {
    ShapeError => Shape,
    CompileError => Compile,
    TooLarge => TooLarge,
    Diagnostics => ModelFile,
    WindowError => Window,
    RayError => Ray,
    BadRay => Rays,
    RootRayError => RootRay,
    CameraError => Camera,
    RenderError => Render,
    TimelineError => Timeline,
    InfillError => Infill,
    SectionError => Section,
    MeasureError => Measure,
    WriteError => Write,
    PolygonError => Polygon,
    LineError => Line,
    OpticsError => Optics,
}

/// Problems with files of rays are those of an input, all others those of an output.
impl From<TableError> for Error {
    fn from(error: TableError) -> Error {
        match &error {
            TableError::Rays(_) | TableError::Io { action: "read", .. } => Error::input(error),
            _ => Error::output(error),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn unknown(name: &str, known: &[&str]) -> String {
        Error::unknown("solid", name, known.iter().copied()).to_string()
    }

    #[test]
    fn a_slip_gets_a_suggestion() {
        assert_eq!(
            unknown("lesn", &["lens", "rim"]),
            "no solid is called `lesn` (there is lens, rim) did you mean `lens`?"
        );
        assert_eq!(unknown("mirror", &["lens", "rim"]), "no solid is called `mirror` (there is lens, rim)");
        assert_eq!(unknown("x", &[]), "no solid is called `x` (there is none)");
        let many: Vec<String> = (0..20).map(|k| format!("tile{k}")).collect();
        let many: Vec<&str> = many.iter().map(String::as_str).collect();
        assert!(unknown("q", &many).contains("tile9, ... and 10 more"));
    }

    #[test]
    fn kinds_and_predicates_agree() {
        let window = Error::from(rayweave_model::Window::new(2.0, 1.0).unwrap_err());
        assert!(window.is_value() && !window.is_input());
        assert!(window.to_string().contains("t_min must be less than t_max"));
        assert_eq!(Error::cancelled().kind(), ErrorKind::Cancelled);
        let missing = rayweave_table::RayReader::open("no-such-file.csv").unwrap_err();
        assert!(Error::from(missing).is_input());
    }
}
