//! Tables that are readable both as Markdown and on a terminal.

use super::{Figure, Section};
use crate::ceiling::Ceilings;
use crate::interleaved::Role;

/// A table of the ceilings.
pub fn ceilings(ceilings: &Ceilings) -> String {
    let row = |(name, unit, figure): (String, &str, crate::statistics::Statistics)| {
        vec![name, format!("{} {unit}", short(figure.median)), percent(figure.spread())]
    };
    let rows = ceilings.rows().into_iter().map(row).collect();
    table(&["ceiling", "rate", "spread"], rows)
}

/// A table of the figures of a section, and the candidates that failed.
pub fn section(section: &Section) -> String {
    let item = section.item;
    let heads = [
        "",
        "threads",
        &format!("{}/s", if item == "leaf" { "leaves".to_owned() } else { format!("{item}s") }),
        &format!("ns per {item}"),
        "spread",
        "of the ceiling",
        "to the best peer",
        "time over Rust's",
        "answers",
        &format!("instructions per {item}"),
    ];
    let rows: Vec<Vec<String>> = section.figures.iter().map(|figure| row(section, figure)).collect();
    let mut text = match rows.is_empty() {
        true => String::new(),
        false => table(&heads, rows),
    };
    for (name, problem) in &section.failures {
        text += &format!("\n{name}: {problem}\n");
    }
    text
}

fn row(section: &Section, figure: &Figure) -> Vec<String> {
    let name = match figure.role {
        Role::Ours => format!("**{}**", figure.name),
        Role::Peer => figure.name.clone(),
        Role::Ceiling => format!("*{}*", figure.name),
    };
    let floor = figure.floor.as_ref().zip(figure.fraction());
    let fraction = floor.map(|(floor, fraction)| format!("{} ({})", percent(fraction), floor.what));
    let ratio = section
        .fastest(Role::Peer)
        .filter(|_| figure.role != Role::Peer)
        .map(|peer| format!("{} x", short(peer.time.median / figure.time.median)));
    let tax = section.over_rust(figure).map(|tax| format!("{} x", short(tax)));
    let or_nothing = |text: Option<String>| text.unwrap_or_default();
    vec![
        name,
        figure.threads.to_string(),
        rate(figure.rate()),
        short(figure.time.median),
        percent(figure.time.spread()),
        or_nothing(fraction),
        or_nothing(ratio),
        or_nothing(tax),
        or_nothing(figure.agreement.map(|agreement| agreement.to_string())),
        or_nothing(figure.instructions.map(short)),
    ]
}

/// A table with aligned columns; empty columns are omitted.
fn table(heads: &[&str], rows: Vec<Vec<String>>) -> String {
    let columns: Vec<usize> =
        (0..heads.len()).filter(|&k| rows.iter().any(|row| !row[k].is_empty())).collect();
    let width = |k: usize| {
        let widths = rows.iter().map(|row| row[k].chars().count());
        widths.chain([heads[k].chars().count(), 3]).max().unwrap_or(3)
    };
    let widths: Vec<usize> = columns.iter().map(|&k| width(k)).collect();
    let line = |cells: Vec<&str>| {
        let cells = cells.iter().zip(&widths).map(|(cell, width)| format!(" {cell:<width$} |"));
        format!("|{}\n", cells.collect::<String>())
    };
    let mut text = line(columns.iter().map(|&k| heads[k]).collect());
    let rule = widths.iter().enumerate().map(|(i, width)| match i {
        0 => format!(" {} |", "-".repeat(*width)),
        _ => format!(" {}: |", "-".repeat(width - 1)),
    });
    text += &format!("|{}\n", rule.collect::<String>());
    for row in &rows {
        text += &line(columns.iter().map(|&k| row[k].as_str()).collect());
    }
    text
}

/// Formats a number with three digits.
pub fn short(value: f64) -> String {
    match value.abs() {
        v if v >= 99.95 || v == 0.0 => format!("{value:.0}"),
        v if v >= 9.995 => format!("{value:.1}"),
        v if v >= 0.9995 => format!("{value:.2}"),
        _ => format!("{value:.3}"),
    }
}

/// Formats a rate per second with an SI prefix.
pub fn rate(value: f64) -> String {
    match value {
        v if v >= 999.5e6 => format!("{} G", short(v / 1e9)),
        v if v >= 999.5e3 => format!("{} M", short(v / 1e6)),
        v if v >= 999.5 => format!("{} k", short(v / 1e3)),
        v => short(v),
    }
}

fn percent(part: f64) -> String {
    let percent = 100.0 * part;
    match percent {
        p if p >= 9.95 => format!("{p:.0} %"),
        p => format!("{p:.1} %"),
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::example;
    use super::*;

    #[test]
    fn numbers_are_short() {
        assert_eq!([123.4, 12.34, 1.234, 0.1234].map(short), ["123", "12.3", "1.23", "0.123"]);
        assert_eq!([5.0, 5e3, 5e6, 5e9].map(rate), ["5.00", "5.00 k", "5.00 M", "5.00 G"]);
        assert_eq!([0.5, 0.01].map(percent), ["50 %", "1.0 %"]);
    }

    #[test]
    fn tables_have_a_row_for_each_figure_and_no_empty_columns() {
        let text = section(&example().sections[0]);
        let lines: Vec<&str> = text.lines().collect();
        let cells = |line: &str| line.matches('|').count();
        assert!(lines[..5].iter().all(|line| cells(line) == cells(lines[0])), "{text}");
        assert!(lines[2].contains("**weave**") && lines[2].contains("50 % (kernel by hand)"), "{text}");
        assert!(lines[2].contains("50.0 x") && !lines[3].contains(" x "), "{text}");
        assert!(!text.contains("instructions"), "they were not counted");
        assert!(text.ends_with("\nGeant4: it broke\n"));
        assert!(ceilings(&example().ceilings).contains("| copy, 2 threads"));
    }
}
