//! The results as a Markdown page.

use super::{Report, Section, text};
use crate::interleaved::Role;

const HEAD: &str = "\
# Performance

The benchmark writes this page: figures, tables and the plot are those of one run. The end of the page explains them.
";

const FOOT: &str = include_str!("page.md");

/// Formats the report as a page; `plot` is the path of the picture relative to the page.
pub fn markdown(report: &Report, plot: Option<&str>) -> String {
    let mut page = HEAD.to_owned();
    page += &format!("\nMeasured on {} with `{}`.\n\n", report.date, report.command);
    for (name, fact) in &report.machine {
        page += &format!("- {name}: {fact}\n");
    }
    if let Some(plot) = plot {
        page += &format!("\n![Rates of all candidates]({plot})\n");
    }
    page += &format!("\n## Ceilings of the machine\n\n{}", text::ceilings(&report.ceilings));
    page += "\n## Exemplars\n";
    report.sections.iter().for_each(|section| page += &exemplar(section));
    page += &growth(report);
    page += &peers(report);
    page + "\n" + FOOT
}

fn exemplar(section: &Section) -> String {
    format!("\n### {}\n\n{}\n\n{}", section.name, section.about, text::section(section))
}

/// Time per ray by size of the model, for the fastest evaluator of this project, by family.
fn growth(report: &Report) -> String {
    let mut rows: Vec<(String, Vec<String>)> = Vec::new();
    for section in &report.sections {
        let parts: Vec<&str> = section.name.split('/').collect();
        let (&["scale", family, size, what], Some(figure)) = (&parts[..], section.fastest(Role::Ours)) else {
            continue;
        };
        let name = format!("{family}, {what}");
        let cell = format!("{size}: {} ns ({})", text::short(figure.time.median), figure.name);
        match rows.iter_mut().find(|(row, _)| *row == name) {
            Some((_, cells)) => cells.push(cell),
            None => rows.push((name, vec![cell])),
        }
    }
    if rows.is_empty() {
        return String::new();
    }
    let lines = rows.into_iter().map(|(name, cells)| format!("- {name}: {}\n", cells.join(", ")));
    format!(
        "\n## Growth\n\nThe time per ray, or per leaf when compiling, by number of leaves, for the fastest evaluator.\n\n{}",
        lines.collect::<String>()
    )
}

fn peers(report: &Report) -> String {
    let mut text = "\n## Peers\n\n".to_owned();
    let line = |(name, what): &(String, String)| format!("- {name}: {what}\n");
    text += &report.peers.iter().map(line).collect::<String>();
    if !report.missing.is_empty() {
        text += "\nMissing in this run:\n\n";
        text += &report.missing.iter().map(line).collect::<String>();
    }
    text
}

#[cfg(test)]
mod tests {
    use super::super::tests::example;
    use super::*;

    #[test]
    fn the_page_holds_everything() {
        let page = markdown(&example(), Some("performance.svg"));
        let parts = [
            "# Performance",
            "2026-01-02",
            "- cores: 2",
            "](performance.svg)",
            "### die/full",
            "- Raysect: it is not there",
            "## How it is measured",
        ];
        let places: Vec<Option<usize>> = parts.iter().map(|part| page.find(part)).collect();
        assert!(places.iter().all(Option::is_some), "{places:?}");
        assert!(places.is_sorted());
        assert!(!markdown(&example(), None).contains("!["));
        assert!(!page.contains("## Growth"), "nothing grew");
    }

    #[test]
    fn growth_is_reported_family_by_family() {
        let mut report = example();
        let mut other = example();
        report.sections.append(&mut other.sections);
        report.sections[0].name = "scale/spheres/1e3/full".to_owned();
        report.sections[1].name = "scale/spheres/1e4/full".to_owned();
        let page = markdown(&report, None);
        assert!(page.contains("- spheres, full: 1e3: 10.0 ns (weave), 1e4: 10.0 ns (weave)\n"), "{page}");
    }
}
