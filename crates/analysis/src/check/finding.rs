//! Findings and their kinds.

use crate::AnalysisError;
use crate::measure::{Estimate, MeasuredChord};
use rayweave_error::Message;
use rayweave_math::Vec3;

/// The kinds of findings.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
pub enum FindingKind {
    /// Two regions overlap and neither is inside the other; the overlap belongs to the later one. In models
    /// with a hierarchy, also overlapping copies of the same volume.
    Overlap,
    /// A daughter extends beyond its mother.
    Outside,
    /// A region is completely covered by later regions.
    Hidden,
    /// A solid is empty.
    Empty,
    /// An operand of a boolean operator has no effect.
    Absorbed,
    /// A mesh is closed, but suspicious.
    Mesh,
    /// A wall is thinner than a given length.
    Thin,
    /// A gap is narrower than a given length.
    Gap,
    /// An optical property, surface or sensor is probably wrong.
    Optical,
    /// A region consists of separate pieces: a note, not a fault.
    Loose,
    /// One or several regions enclose a cavity: a note, not a fault.
    Cavity,
    /// Two regions touch: a note, not a fault.
    Touch,
    /// An optical property or surface has no effect: a note, not a fault.
    Unused,
}

impl FindingKind {
    /// All kinds with their names.
    pub const ALL: [(FindingKind, &'static str); 13] = [
        (FindingKind::Overlap, "overlap"),
        (FindingKind::Outside, "outside"),
        (FindingKind::Hidden, "hidden"),
        (FindingKind::Empty, "empty"),
        (FindingKind::Absorbed, "absorbed"),
        (FindingKind::Mesh, "mesh"),
        (FindingKind::Thin, "thin"),
        (FindingKind::Gap, "gap"),
        (FindingKind::Optical, "optical"),
        (FindingKind::Loose, "loose"),
        (FindingKind::Cavity, "cavity"),
        (FindingKind::Touch, "touch"),
        (FindingKind::Unused, "unused"),
    ];

    /// True for notes, which are not faults.
    pub fn is_note(self) -> bool {
        use FindingKind::{Cavity, Loose, Touch, Unused};
        matches!(self, Loose | Cavity | Touch | Unused)
    }

    /// The name.
    pub fn name(self) -> &'static str {
        FindingKind::ALL[self as usize].1
    }
}

impl std::str::FromStr for FindingKind {
    type Err = AnalysisError;

    fn from_str(name: &str) -> Result<FindingKind, AnalysisError> {
        let found = FindingKind::ALL.into_iter().find(|(_, own)| *own == name);
        let names = FindingKind::ALL.into_iter().map(|(_, own)| own);
        let unknown = || AnalysisError::Name(Message::unknown("kind of finding", name, names));
        found.map(|(kind, _)| kind).ok_or_else(unknown)
    }
}

/// A possible modelling error.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Finding {
    /// The kind.
    pub kind: FindingKind,
    /// The regions concerned.
    pub regions: Vec<String>,
    /// A description of the finding.
    pub text: String,
    /// The depth of an overlap, or the thickness of a wall or gap, in the unit of the model.
    ///
    /// The thickness belongs to [`Finding::ray`] and is exact to rounding errors of the coordinates: the length of that chord where
    /// it is perpendicular to both faces or ends at an edge or corner, otherwise the diameter of the larger of the two balls inside that
    /// touch the face at one of its ends and pass through the other. It is the least that was found, hence an upper bound of the smallest thickness of the
    /// region: a thinner wall at a face between the rays is missed ([`CheckSettings::across`](super::CheckSettings::across)). The
    /// depth of an overlap is the shortest of several chords through the middle of its thickest place that was found.
    pub size: Option<f64>,
    /// The volume of the overlap, or of the part outside.
    pub volume: Option<Estimate>,
    /// The area where regions touch.
    pub area: Option<f64>,
    /// A point of the finding.
    pub at: Option<Vec3>,
    /// The chord of a ray there.
    pub ray: Option<MeasuredChord>,
    /// The faces at both ends of a wall or gap, such as `plate.top` and `bore.side`; `a/b` where faces meet at
    /// an edge. Empty for other findings.
    pub faces: Vec<String>,
    /// True if the finding is proved without rays.
    pub is_proved: bool,
}

impl Finding {
    /// Creates a finding without a position, for example about the text of a file.
    pub fn stated(kind: FindingKind, text: String) -> Finding {
        Finding::new(kind, &[], text)
    }

    pub(super) fn new(kind: FindingKind, regions: &[&str], text: String) -> Finding {
        let regions = regions.iter().map(|name| (*name).to_owned()).collect();
        let (size, volume, area, at, ray) = (None, None, None, None, None);
        Finding { kind, regions, text, size, volume, area, at, ray, faces: Vec::new(), is_proved: false }
    }

    pub(super) fn seen(self, size: f64, chord: MeasuredChord) -> Finding {
        let at = Some(0.5 * (chord.from + chord.to));
        Finding { size: Some(size), at, ray: Some(chord), ..self }
    }
}
