//! Advice for names of sub-commands that do not exist: another sub-command, or a function in Python.

use clap::error::{ContextKind, ErrorKind};

/// The guide to the analyses of lenses.
const GUIDE: &str = "see docs/guides/lens-design.md";

/// Names that users of other programs try, with the functions in Python.
const LENSES: [(&[&str], &str); 11] = [
    (&["seidel", "aberrations"], "lens.seidel()"),
    (&["fan", "fans", "ray-fan", "rayfan"], "lens.fans()"),
    (&["wavefront", "opd", "zernike", "strehl"], "lens.wavefront(0)"),
    (&["mtf", "psf"], "lens.diffraction_mtf()"),
    (&["encircled", "encircled-energy"], "lens.encircled_energy()"),
    (&["through-focus", "focus", "quickfocus"], "lens.through_focus()"),
    (&["distortion"], "lens.distortion()"),
    (&["field-curvature"], "lens.field_curvature()"),
    (&["vignetting"], "lens.vignetting()"),
    (&["optimise", "optimize", "merit"], "optimise(lens, parameters, goals)"),
    (&["tolerance", "tolerances", "tolerancing", "sensitivity"], "tolerance(lens, errors)"),
];

/// Names for which there is another sub-command.
const COMMANDS: [(&[&str], &str); 9] = [
    (&["spot", "spots"], "rayweave optics MODEL --spot spot.svg"),
    (&["layout"], "rayweave optics MODEL --layout layout.svg"),
    (&["ghosts", "paths"], "rayweave optics MODEL --branches both --paths paths.csv"),
    (&["prescription", "paraxial", "first-order", "efl"], "rayweave info LENS.zmx"),
    (&["measure", "mass", "area", "inertia", "bounds"], "rayweave volume MODEL"),
    (
        &["draw", "drawing", "sheet", "techdraw"],
        "rayweave render MODEL --view sheet --dimensions -o drawing.pdf",
    ),
    (&["view", "show", "picture", "plot"], "rayweave render MODEL"),
    (&["slice", "cut"], "rayweave section MODEL --plane z=0"),
    (&["radiograph", "xray"], "rayweave thickness MODEL -o radiograph.png"),
];

/// The error with advice, for sub-commands that have another name here.
pub fn advised(error: clap::Error) -> clap::Error {
    if error.kind() != ErrorKind::InvalidSubcommand {
        return error;
    }
    let Some(name) = error.get(ContextKind::InvalidSubcommand).map(ToString::to_string) else { return error };
    let advice = advice(&name);
    advice.map_or(error, |advice| {
        clap::Error::raw(ErrorKind::InvalidSubcommand, format!("there is no command '{name}': {advice}\n"))
    })
}

fn advice(name: &str) -> Option<String> {
    let name = name.to_ascii_lowercase();
    let is_own = |names: &[&str]| names.contains(&name.as_str());
    if let Some((_, call)) = LENSES.iter().find(|(names, _)| is_own(names)) {
        return Some(format!(
            "this analysis of lenses is in Python, {GUIDE}.\n\n  from rayweave.optics import *\n  lens = Prescription.read_zmx(\"lens.zmx\")\n  {call}"
        ));
    }
    let command = COMMANDS.iter().find(|(names, _)| is_own(names));
    command.map(|(_, command)| format!("another one does that.\n\n  {command}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_other_programs_get_advice() {
        assert!(
            advice("MTF").is_some_and(|text| text.contains(".diffraction_mtf()") && text.contains(GUIDE))
        );
        assert!(advice("spot").is_some_and(|text| text.ends_with("rayweave optics MODEL --spot spot.svg")));
        assert_eq!(advice("rendr"), None);
    }

    /// No name is that of a sub-command, or occurs twice.
    #[test]
    fn names_are_unique() {
        use clap::CommandFactory;
        let lists = LENSES.iter().chain(&COMMANDS);
        let mut names: Vec<&str> = lists.flat_map(|(names, _)| names.iter().copied()).collect();
        let command = crate::cli::Cli::command();
        assert!(names.iter().all(|name| command.find_subcommand(name).is_none()));
        let count = names.len();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), count);
    }
}
