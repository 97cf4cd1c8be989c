//! The results as JSON.

use super::{Figure, Report, Section};
use crate::level;
use crate::statistics::Statistics;
use serde_json::{Map, Value, json};

/// The report as JSON. Times are in nanoseconds per item, the ceilings in GB/s and in operations per nanosecond.
pub fn json(report: &Report) -> Value {
    let named = |pairs: &[(String, String)]| -> Value {
        pairs.iter().map(|(name, text)| (name.clone(), json!(text))).collect::<Map<_, _>>().into()
    };
    let machine: Map<_, _> =
        report.machine.iter().map(|(name, text)| ((*name).to_owned(), json!(text))).collect();
    json!({
        "date": report.date,
        "command": report.command,
        "machine": machine,
        "ceilings": ceilings(report),
        "peers": named(&report.peers),
        "missing": named(&report.missing),
        "exemplars": report.sections.iter().map(section).collect::<Vec<_>>(),
    })
}

fn ceilings(report: &Report) -> Value {
    let ceilings = &report.ceilings;
    let levels = ceilings.levels.iter().map(|rates| {
        json!({
            "level": level::name(rates.level),
            "fused_multiply_add": statistics(&rates.fused),
            "multiply_and_add": statistics(&rates.simple),
            "minimum_and_maximum": statistics(&rates.extremes),
            "divide": statistics(&rates.divisions),
            "square_root": statistics(&rates.roots),
        })
    });
    json!({
        "copy": { "threads_1": statistics(&ceilings.copy[0]), "threads_all": statistics(&ceilings.copy[1]) },
        "threads": ceilings.threads,
        "levels": levels.collect::<Vec<_>>(),
    })
}

fn section(section: &Section) -> Value {
    let failures: Map<_, _> =
        section.failures.iter().map(|(name, problem)| (name.clone(), json!(problem))).collect();
    json!({
        "name": section.name,
        "about": section.about,
        "item": section.item,
        "figures": section.figures.iter().map(figure).collect::<Vec<_>>(),
        "failures": failures,
    })
}

fn figure(figure: &Figure) -> Value {
    let floor = figure
        .floor
        .as_ref()
        .map(|floor| json!({ "what": floor.what, "time": floor.time, "fraction": figure.fraction() }));
    let agreement = figure.agreement.map(|agreement| {
        json!({
            "rays": agreement.rays,
            "other_count": agreement.other_count,
            "other_time": agreement.other_time,
            "worst": agreement.worst,
        })
    });
    json!({
        "name": figure.name,
        "role": figure.role.name(),
        "threads": figure.threads,
        "time": statistics(&figure.time),
        "per_second": figure.rate(),
        "ceiling": floor,
        "agreement": agreement,
        "instructions": figure.instructions,
    })
}

fn statistics(statistics: &Statistics) -> Value {
    json!({
        "median": statistics.median,
        "quartiles": statistics.quartiles,
        "range": statistics.range,
        "runs": statistics.count,
    })
}

#[cfg(test)]
mod tests {
    use super::super::tests::example;
    use super::*;

    #[test]
    fn text_can_be_read_again() {
        let text = serde_json::to_string_pretty(&json(&example())).unwrap();
        let read: Value = serde_json::from_str(&text).unwrap();
        let exemplar = &read["exemplars"][0];
        assert_eq!(exemplar["about"], "Every crossing of a \"die\".");
        assert_eq!(exemplar["figures"][0]["time"]["median"], 10.0);
        assert_eq!(exemplar["figures"][0]["ceiling"]["fraction"], 0.5);
        assert_eq!(exemplar["failures"]["Geant4"], "it broke");
        assert_eq!(read["missing"]["Raysect"], "it is not there");
        assert_eq!(read["ceilings"]["copy"]["threads_1"]["median"], 1.0);
    }
}
