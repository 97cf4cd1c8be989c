//! Indications of drawings of lenses: texts in the fields of ISO 10110 that a prescription does not have.

use crate::DrawError;
use rayweave_error::Message;

/// Texts by the names of their fields.
///
/// ```
/// use rayweave_draw::Indications;
///
/// let own = [("thickness", "\u{b1} 0.05"), ("left 3/", "2(0.5)")].map(|(name, text)| (name.to_owned(), text.to_owned()));
/// assert!(Indications::of_element(own.clone()).is_ok());
/// assert!(Indications::of_group(own).is_err());
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Indications(Vec<(String, String)>);

/// The fields of a side of an element, behind `left` and `right`.
const SIDE: [&str; 7] = ["radius", "chamfer", "coating", "3/", "4/", "5/", "6/"];
/// The other fields of an element.
const ELEMENT: [&str; 5] = ["thickness", "diameter", "0/", "1/", "2/"];
/// The fields of a cemented group.
const GROUP: [&str; 6] = ["thickness", "diameter", "cement", "4/", "5/", "note"];

impl Indications {
    /// The indications of an element: tolerances behind the `thickness`, the `diameter` and the radii (`left radius`), and the
    /// texts of the fields `left chamfer`, `left coating`, `left 3/` to `left 6/`, the same on the `right`, and `0/` to `2/`.
    ///
    /// # Errors
    /// [`DrawError::Option`] for fields that do not exist.
    pub fn of_element(entries: impl IntoIterator<Item = (String, String)>) -> Result<Indications, DrawError> {
        let sides = ["left", "right"].into_iter().flat_map(|side| SIDE.map(|own| format!("{side} {own}")));
        Indications::known(entries, &ELEMENT.map(str::to_owned).into_iter().chain(sides).collect::<Vec<_>>())
    }

    /// The indications of a cemented group: tolerances behind `thickness` and `diameter`, and the texts of `cement`, `4/`, `5/`
    /// and `note`.
    ///
    /// # Errors
    /// [`DrawError::Option`] for fields that do not exist.
    pub fn of_group(entries: impl IntoIterator<Item = (String, String)>) -> Result<Indications, DrawError> {
        Indications::known(entries, &GROUP.map(str::to_owned))
    }

    fn known(
        entries: impl IntoIterator<Item = (String, String)>,
        fields: &[String],
    ) -> Result<Indications, DrawError> {
        let entries: Vec<(String, String)> = entries.into_iter().collect();
        match entries.iter().find(|(name, _)| !fields.contains(name)) {
            None => Ok(Indications(entries)),
            Some((name, _)) => {
                let problem = format!("there is no field {name:?} on this drawing");
                let message = Message::new(problem, format!("its fields are {}", fields.join(", ")));
                Err(DrawError::Option(message))
            }
        }
    }

    fn of(&self, field: &str) -> Option<&str> {
        self.0.iter().rev().find(|(name, _)| name == field).map(|(_, text)| text.trim())
    }

    /// A value with the text of a field behind it.
    pub(crate) fn after(&self, field: &str, value: String) -> String {
        self.of(field).map_or(value.clone(), |text| format!("{value} {text}"))
    }

    /// The row of a field: its label and its text, which may begin with the label.
    pub(crate) fn row(&self, field: &str, label: &str) -> String {
        match self.of(field) {
            None => label.to_owned(),
            Some(text) if text.starts_with(label) => text.to_owned(),
            Some(text) => format!("{label} {text}"),
        }
    }
}
