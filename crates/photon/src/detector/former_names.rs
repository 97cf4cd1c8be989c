//! Names of properties before version 11 of Geant4 (release notes of Geant4 11.0, "Optical photons").

/// A property that Geant4 11 renamed or replaced.
pub(crate) struct FormerName {
    /// The name before version 11.
    pub former: &'static str,
    /// The name since then.
    pub name: &'static str,
    /// True if the values are read under the present name. Others have another meaning, such as the share of the first component.
    pub is_read: bool,
}

/// All former names.
pub(crate) const FORMER_NAMES: [FormerName; 8] = [
    renamed("FASTCOMPONENT", "SCINTILLATIONCOMPONENT1"),
    renamed("SLOWCOMPONENT", "SCINTILLATIONCOMPONENT2"),
    renamed("FASTTIMECONSTANT", "SCINTILLATIONTIMECONSTANT1"),
    renamed("SLOWTIMECONSTANT", "SCINTILLATIONTIMECONSTANT2"),
    renamed("FASTSCINTILLATIONRISETIME", "SCINTILLATIONRISETIME1"),
    renamed("SLOWSCINTILLATIONRISETIME", "SCINTILLATIONRISETIME2"),
    replaced("YIELDRATIO", "SCINTILLATIONYIELD1"),
    replaced("SCINTILLATIONRISETIME", "SCINTILLATIONRISETIME1"),
];

const fn renamed(former: &'static str, name: &'static str) -> FormerName {
    FormerName { former, name, is_read: true }
}

const fn replaced(former: &'static str, name: &'static str) -> FormerName {
    FormerName { former, name, is_read: false }
}

/// The name since Geant4 11 of a property with an older name.
pub(crate) fn successor(name: &str) -> Option<&'static str> {
    FORMER_NAMES.iter().find(|row| row.former == name).map(|row| row.name)
}
