//! The results as a page.

use super::{Report, Section, text};

const HEAD: &str = "\
# Performance

Written by the benchmark itself: figures, tables and the plot are those of one run. What they mean is said at the end.
";

const FOOT: &str = include_str!("page.md");

/// The report as a page; `plot` is the path of the picture from the page.
pub fn markdown(report: &Report, plot: Option<&str>) -> String {
    let mut page = HEAD.to_owned();
    page += &format!("\nMeasured on {} with `{}`.\n\n", report.date, report.command);
    for (name, fact) in &report.machine {
        page += &format!("- {name}: {fact}\n");
    }
    if let Some(plot) = plot {
        page += &format!("\n![Rates of all contenders]({plot})\n");
    }
    page += &format!("\n## Ceilings of the machine\n\n{}", text::ceilings(&report.ceilings));
    page += "\n## Exemplars\n";
    report.sections.iter().for_each(|section| page += &exemplar(section));
    page += &peers(report);
    page + "\n" + FOOT
}

fn exemplar(section: &Section) -> String {
    format!("\n### {}\n\n{}\n\n{}", section.name, section.about, text::section(section))
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
    }
}
