//! Remarks about runs that probably do not answer the question of their users.

use crate::flight::End;
use std::collections::BTreeMap;

/// The number of photons from which a run without hits is remarkable.
const MANY: u64 = 100;

/// The words of a program for the things that remarks mention.
#[derive(Clone, Copy, Debug)]
pub struct RemarkTerms<'t> {
    /// The check of the model, such as `` `rayweave check bar.gdml` ``.
    pub check: &'t str,
    /// The findings of the check that count, after "probable mistakes"; may be empty.
    pub findings: &'t str,
    /// The option that counts the processes at each surface.
    pub counts: &'t str,
    /// The maximum number of steps.
    pub max_steps: &'t str,
}

/// True if a run with these numbers of photons by way of ending has many photons and no hit.
#[must_use]
pub fn is_dark(ends: &BTreeMap<End, u64>) -> bool {
    ends.values().sum::<u64>() >= MANY && count(ends, End::Detected) == 0
}

impl RemarkTerms<'_> {
    /// The remark about a run without hits. `mistakes` is the number of probable mistakes in the optical part of the model.
    #[must_use]
    pub fn no_hits(&self, ends: &BTreeMap<End, u64>, mistakes: usize) -> String {
        let RemarkTerms { check, findings, counts, .. } = self;
        let photons: u64 = ends.values().sum();
        // of equally frequent ends the first one
        let most = ends.iter().rev().max_by_key(|(_, count)| **count);
        let (end, number) = most.map_or(("", 0), |(end, count)| (end.name(), *count));
        let found = match mistakes {
            0 => format!("no probable mistake{findings}"),
            1 => format!("1 probable mistake{findings}"),
            n => format!("{n} probable mistakes{findings}"),
        };
        format!(
            "no photon is detected: {number} of {photons} end as {end}. {check} reports {found}; {counts} counts the processes at each \
             surface."
        )
    }

    /// The remark about a run most of whose photons are stopped by the limit of steps.
    #[must_use]
    pub fn mostly_stopped(&self, ends: &BTreeMap<End, u64>) -> Option<String> {
        let (stopped, photons) = (count(ends, End::StepLimit), ends.values().sum::<u64>());
        let text = || {
            format!(
                "{stopped} of {photons} photons are stopped by the limit of steps: their light is never absorbed. Check the absorption \
                 lengths and REFLECTIVITY, or raise {}.",
                self.max_steps
            )
        };
        (2 * stopped > photons).then(text)
    }

    /// The remark about photons that are stopped by the limit of steps, many or few.
    #[must_use]
    pub fn stopped(&self, ends: &BTreeMap<End, u64>) -> Option<String> {
        let few = || match count(ends, End::StepLimit) {
            0 => None,
            1 => Some(format!("1 photon is stopped by the limit of steps, which {} raises.", self.max_steps)),
            n => Some(format!(
                "{n} photons are stopped by the limit of steps, which {} raises.",
                self.max_steps
            )),
        };
        self.mostly_stopped(ends).or_else(few)
    }
}

fn count(ends: &BTreeMap<End, u64>, end: End) -> u64 {
    ends.get(&end).copied().unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    const TERMS: RemarkTerms<'static> = RemarkTerms {
        check: "`check`",
        findings: " of kind `optical`",
        counts: "--counts",
        max_steps: "--max-steps",
    };

    #[test]
    fn dark_runs_name_the_most_frequent_end() {
        let ends = BTreeMap::from([(End::Absorbed, 40), (End::Escaped, 60), (End::Detected, 0)]);
        assert!(is_dark(&ends));
        assert_eq!(
            TERMS.no_hits(&ends, 2),
            "no photon is detected: 60 of 100 end as escaped. `check` reports 2 probable mistakes of kind `optical`; --counts counts the \
             processes at each surface."
        );
        assert!(TERMS.no_hits(&ends, 1).contains("reports 1 probable mistake of kind `optical`;"));
        assert!(TERMS.no_hits(&ends, 0).contains("reports no probable mistake of kind `optical`;"));
        // one photon less, and one hit
        assert!(!is_dark(&BTreeMap::from([(End::Absorbed, 99)])));
        assert!(!is_dark(&BTreeMap::from([(End::Absorbed, 99), (End::Detected, 1)])));
    }

    #[test]
    fn stopped_photons_are_reported() {
        let ends = |stopped| BTreeMap::from([(End::Absorbed, 100 - stopped), (End::StepLimit, stopped)]);
        assert_eq!(TERMS.stopped(&ends(0)), None);
        let one = "1 photon is stopped by the limit of steps, which --max-steps raises.";
        assert_eq!(TERMS.stopped(&ends(1)).as_deref(), Some(one));
        assert!(TERMS.stopped(&ends(50)).unwrap().starts_with("50 photons are stopped"));
        assert_eq!(TERMS.mostly_stopped(&ends(50)), None);
        let most = TERMS.mostly_stopped(&ends(51)).unwrap();
        assert!(most.starts_with("51 of 100 photons are stopped by the limit of steps: "), "{most}");
        assert_eq!(TERMS.stopped(&ends(51)), Some(most));
    }
}
