//! Report of a photon run: how photons end, processes, sequences.

use crate::terminal;
use rayweave::photon::{
    Detector, End, Histories, Hits, PhotonPart, PhotonRun, Process, RemarkTerms, is_dark, sequence_text,
};
use rayweave::photon_simulator::PhotonShare;
use rayweave::table::{Counts, TextIds};
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;
use std::time::Duration;

/// The name that reports use for interfaces without an optical surface.
const BARE: &str = "(none)";

/// The number of sensors that the table of the terminal lists.
const LISTED_SENSORS: usize = 32;

/// The results of a run.
pub struct PhotonReport {
    /// The counts of the run, and its hits if they are kept.
    pub run: PhotonRun,
    hits: u64,
    keeps_hits: bool,
    /// Some of the detected photons.
    pub detected: DetectedPhotons,
    pub duration: Duration,
    /// The share of a graphics card.
    pub share: Option<PhotonShare>,
    detection: &'static str,
    /// Processes and events at surfaces, if they are reported.
    counts: Option<Histories>,
    /// The number of photons by sequence, and the number of sequences to report.
    sequences: Option<(BTreeMap<[u64; 2], u64>, usize)>,
    surfaces: Vec<String>,
    /// The paths of the sensors with their numbers of hits, in the order of the detector.
    sensors: Vec<(String, u64)>,
    /// The places of the paths in that list.
    places: TextIds,
}

/// Numbers of detected photons, evenly spread over all hits in their order, in bounded memory: every hit, then every second one, and
/// so on.
#[derive(Debug, Default)]
pub struct DetectedPhotons {
    numbers: Vec<u64>,
    hits: u64,
    /// Every 2^k-th hit is kept.
    thinned: u32,
}

/// The largest number of detected photons that are kept.
const MAX_DETECTED: usize = 1 << 16;

impl DetectedPhotons {
    fn add(&mut self, photons: &[i64]) {
        for &photon in photons {
            if self.hits.trailing_zeros() >= self.thinned {
                self.numbers.push(photon as u64);
            }
            self.hits += 1;
            if self.numbers.len() == MAX_DETECTED {
                let mut place = 0usize;
                self.numbers.retain(|_| {
                    place += 1;
                    place % 2 == 1
                });
                self.thinned += 1;
            }
        }
    }

    /// Up to `count` different ones, ascending.
    pub fn numbers(&self, count: u64) -> Vec<u64> {
        let mut all = self.numbers.clone();
        // a wavelength shifter may emit several photons of one number
        all.dedup();
        let count = (count as usize).min(all.len());
        (0..count).map(|k| all[k * all.len() / count]).collect()
    }
}

impl PhotonReport {
    /// A report without photons. `sequences` is the number of sequences to report. Hits are counted, and kept if `keeps_hits`.
    pub fn new(
        detector: &Detector,
        detection: &'static str,
        counts: bool,
        sequences: Option<usize>,
        keeps_hits: bool,
    ) -> PhotonReport {
        let sensors = detector.sensor_paths();
        let mut places = TextIds::default();
        for (path, _) in sensors {
            places.id(&path.as_str().into());
        }
        PhotonReport {
            run: PhotonRun::default(),
            hits: 0,
            keeps_hits,
            detected: DetectedPhotons::default(),
            duration: Duration::ZERO,
            share: None,
            detection,
            counts: counts.then(Histories::default),
            sequences: sequences.map(|most| (BTreeMap::new(), most)),
            surfaces: detector.surfaces().iter().map(|surface| surface.name.clone()).collect(),
            sensors: sensors.iter().map(|(path, _)| (path.clone(), 0)).collect(),
            places,
        }
    }

    /// Adds a part of the run.
    pub fn add(&mut self, mut part: PhotonPart) {
        self.hits += part.run.hits.len() as u64;
        self.count_by_sensor(&part.run.hits);
        self.detected.add(&part.run.hits.photon);
        if !self.keeps_hits {
            part.run.hits = Hits::default();
        }
        self.run.append(part.run);
        let Some(histories) = part.histories else { return };
        if let Some((found, _)) = &mut self.sequences {
            for sequence in &histories.sequences {
                *found.entry(sequence.words).or_default() += 1;
            }
        }
        if let Some(counts) = &mut self.counts {
            let mut histories = histories;
            // only the counts are needed
            histories.steps = Vec::new();
            histories.sequences = Vec::new();
            histories.hit_flags = Vec::new();
            counts.append(histories);
        }
    }

    /// Adds hits to the counts of the sensors.
    fn count_by_sensor(&mut self, hits: &Hits) {
        let mut counts = vec![0u64; hits.paths().len()];
        for sensor in &hits.sensor {
            counts[*sensor as usize] += 1;
        }
        for (path, count) in hits.paths().iter().zip(counts) {
            let place = self.places.id(path) as usize;
            // of a detector with too many placements for a list in advance
            if place == self.sensors.len() {
                self.sensors.push((path.to_string(), 0));
            }
            self.sensors[place].1 += count;
        }
    }

    /// The fraction of the photons that a sensor with a number of hits detects, and its statistical error: the standard deviation of
    /// a binomial distribution, sqrt(p (1 - p) / n).
    fn fraction(&self, hits: u64) -> [f64; 2] {
        let photons = self.run.photons.max(1) as f64;
        let fraction = hits as f64 / photons;
        [fraction, (fraction * (1.0 - fraction) / photons).max(0.0).sqrt()]
    }

    /// The table of the hits by sensor, in the order of the detector; of many sensors those with hits come first.
    fn sensor_table(&self) -> String {
        if self.hits == 0 && self.sensors.len() > 1 {
            return format!("no hits in {} sensors\n\n", self.sensors.len());
        }
        let row = |(path, count): &(String, u64)| {
            let part = 100.0 * *count as f64 / self.hits.max(1) as f64;
            let [fraction, error] = self.fraction(*count).map(|part| 100.0 * part);
            // two digits of the error; a sensor without hits has no estimate of it
            let place = if error > 0.0 { 1.0 - libm::log10(error).floor() } else { 0.0 };
            let digits = place.clamp(0.0, 9.0) as usize;
            let fraction = format!("{fraction:.digits$}");
            let error = if error > 0.0 { format!("{error:.digits$}") } else { "-".to_owned() };
            vec![path.clone(), count.to_string(), format!("{part:.2}"), fraction, error]
        };
        let mut sensors: Vec<&(String, u64)> = self.sensors.iter().collect();
        if sensors.len() > LISTED_SENSORS {
            sensors.sort_by_key(|(_, count)| *count == 0);
        }
        let rows: Vec<Vec<String>> = sensors.iter().take(LISTED_SENSORS).map(|own| row(own)).collect();
        let header = ["sensor", "hits", "% of hits", "% of photons", "+/-"];
        let mut text = terminal::table(&header, &rows, &[false, true, true, true, true]) + "\n";
        let rest = sensors.iter().skip(LISTED_SENSORS);
        if rest.len() > 0 {
            let hits: u64 = rest.clone().map(|(_, count)| count).sum();
            text += &format!("... and {} more sensors with {hits} hits; --json lists all\n\n", rest.len());
        }
        text
    }

    /// Remarks about a run that probably does not answer the question of its user. `mistakes` counts the probable mistakes in the
    /// optical part of the model, if no photon is detected.
    pub fn remarks(&self, model: &str, mistakes: impl FnOnce() -> usize) -> Vec<String> {
        let check = format!("`rayweave check {model}`");
        let terms = RemarkTerms {
            check: &check,
            findings: " of kind `optical`",
            counts: "--counts",
            max_steps: "--max-steps",
        };
        let ends = &self.run.ends;
        let dark = is_dark(ends).then(|| terms.no_hits(ends, mistakes()));
        dark.into_iter().chain(terms.stopped(ends)).map(|text| format!("note: {text}")).collect()
    }

    /// The numbers of the report that add up over the parts of a run.
    pub fn counts(&self) -> Counts {
        let ends = End::ALL.iter().map(|end| {
            let count = *self.run.ends.get(end).unwrap_or(&0);
            (end.name(), Counts::Number(count))
        });
        let sensors = self.sensors.iter().map(|(path, count)| (path.as_str(), Counts::Number(*count)));
        let mut counts = vec![
            ("photons", Counts::Number(self.run.photons)),
            ("hits", Counts::Number(self.hits)),
            ("steps", Counts::Number(self.run.steps)),
            ("ends", Counts::group(ends)),
            ("sensors", Counts::group(sensors)),
        ];
        if let Some(own) = &self.counts {
            let processes = own.processes.iter().map(|(process, n)| (process.name(), Counts::Number(*n)));
            counts.push(("processes", Counts::group(processes)));
        }
        Counts::group(counts)
    }

    pub fn as_json(&self) -> Value {
        let ends: Map<String, Value> = End::ALL
            .iter()
            .map(|end| (end.name().to_owned(), json!(self.run.ends.get(end).unwrap_or(&0))))
            .collect();
        let fraction = |(path, count): &(String, u64)| {
            let [fraction, error] = self.fraction(*count);
            (path.clone(), json!({ "fraction": fraction, "error": error }))
        };
        let mut report = json!({
            "photons": self.run.photons,
            "hits": self.hits,
            "steps": self.run.steps,
            "seconds": terminal::rounded(self.duration.as_secs_f64(), 6),
            "detection": self.detection,
            "ends": ends,
            "sensors": self.sensors.iter().map(|(path, count)| (path.clone(), json!(count))).collect::<Map<_, _>>(),
            "sensor_fractions": self.sensors.iter().map(fraction).collect::<Map<_, _>>(),
        });
        if let Some(share) = &self.share {
            report["gpu"] =
                json!({ "photons": share.photons, "handed_back": share.handed_back, "steps": share.steps });
        }
        if let Some(counts) = &self.counts {
            let processes = counts.processes.iter().map(|(process, n)| (process.name().to_owned(), json!(n)));
            report["processes"] = processes.collect::<Map<_, _>>().into();
            let row = |((surface, process), count): (&(Option<u32>, Process), &u64)| {
                let name = surface.map(|number| &self.surfaces[number as usize]);
                json!({ "surface": name, "process": process.name(), "count": count })
            };
            report["surfaces"] = counts.surfaces.iter().map(row).collect();
        }
        if self.sequences.is_some() {
            let row = |(words, count): ([u64; 2], u64)| json!({ "sequence": sequence_text(words), "photons": count });
            report["sequences"] = self.most_frequent().into_iter().map(row).collect();
        }
        report
    }

    pub fn as_text(&self) -> String {
        let row = |end: &End| {
            let count = *self.run.ends.get(end)?;
            Some(vec![end.name().to_owned(), count.to_string(), self.percent(count)])
        };
        let rows: Vec<Vec<String>> = End::ALL.iter().filter_map(row).collect();
        let mut text = terminal::table(&["end", "photons", "%"], &rows, &[false, true, true]) + "\n";
        if !self.sensors.is_empty() {
            text += &self.sensor_table();
        }
        if let Some(counts) = &self.counts {
            text += &(self.process_table(counts) + "\n");
        }
        if self.sequences.is_some() {
            let row = |(words, count): ([u64; 2], u64)| {
                vec![count.to_string(), self.percent(count), sequence_text(words)]
            };
            let rows: Vec<Vec<String>> = self.most_frequent().into_iter().map(row).collect();
            text += &(terminal::table(&["photons", "%", "sequence"], &rows, &[true, true, false]) + "\n");
        }
        let seconds = self.duration.as_secs_f64();
        let rate = |count: u64| terminal::short3(count as f64 / seconds.max(1e-9));
        text + &format!(
            "{} photons, {} steps in {} s: {} photons/s, {} steps/s; detection by {}\n",
            self.run.photons,
            self.run.steps,
            terminal::short3(seconds),
            rate(self.run.photons),
            rate(self.run.steps),
            self.detection,
        ) + &self.share.map_or(String::new(), |share| format!("{share}\n"))
    }

    fn percent(&self, count: u64) -> String {
        format!("{:.2}", 100.0 * count as f64 / self.run.photons.max(1) as f64)
    }

    /// The processes in total, and by surface.
    fn process_table(&self, counts: &Histories) -> String {
        let rows: Vec<Vec<String>> = counts
            .processes
            .iter()
            .map(|(process, count)| vec![process.name().to_owned(), count.to_string()])
            .collect();
        let total = terminal::table(&["process", "count"], &rows, &[false, true]);
        let row = |((surface, process), count): (&(Option<u32>, Process), &u64)| {
            let name = surface.map_or(BARE, |number| self.surfaces[number as usize].as_str());
            vec![name.to_owned(), process.name().to_owned(), count.to_string()]
        };
        let rows: Vec<Vec<String>> = counts.surfaces.iter().map(row).collect();
        let by_surface = terminal::table(&["surface", "process", "count"], &rows, &[false, false, true]);
        format!("{total}\n{by_surface}")
    }

    /// The sequences with the largest numbers of photons, the most frequent first.
    fn most_frequent(&self) -> Vec<([u64; 2], u64)> {
        let Some((found, most)) = &self.sequences else { return Vec::new() };
        let mut list: Vec<([u64; 2], u64)> = found.iter().map(|(words, count)| (*words, *count)).collect();
        // ties are ordered by sequence
        list.sort_by_key(|&(words, count)| (std::cmp::Reverse(count), words));
        list.truncate(*most);
        list
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn detected_photons_are_spread_over_all_hits() {
        let mut few = DetectedPhotons::default();
        few.add(&[3, 5, 5, 8]);
        few.add(&[20]);
        assert_eq!(few.numbers(10), [3, 5, 8, 20]);
        assert_eq!(few.numbers(2), [3, 8]);
        assert_eq!(few.numbers(0), [0; 0]);
        let mut many = DetectedPhotons::default();
        (0..1_000_000).for_each(|k| many.add(&[7 * k]));
        assert!(many.numbers.len() < MAX_DETECTED);
        let chosen = many.numbers(4);
        for (number, wanted) in chosen.into_iter().zip([0u64, 1_750_000, 3_500_000, 5_250_000]) {
            assert!(number.abs_diff(wanted) < 7_000, "{number} {wanted}");
        }
    }
}
