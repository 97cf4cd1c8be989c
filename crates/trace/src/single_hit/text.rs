//! Explanations as text.

use super::explain::{Entry, ExplainedOperand, Explanation, Found, Meaning, Question, What};
use super::{Next, ValueStep, Verdict};
use std::fmt;
use std::sync::Arc;

/// Default number of lines of decisions.
pub const MAX_LINES: usize = 1_000;

/// Inverse of the largest share of all lines that one query takes.
const SHARE: usize = 10;

/// Largest number of crossings printed at the end.
const MAX_CROSSINGS: usize = 100;

/// Largest depth for which lines are indented.
const DEEPEST: u32 = 12;

const LEGEND: &str = "\
Each leaf reports its next change. A node of the tree, printed below its two operands and with less indentation, decides
from their next changes:
  rule 1: if operands that never change again determine the node, it is constant from here on;
  rule 2: otherwise the earlier change is taken, or both changes if they are at the same time;
  rule 3: if that changes the node, it is the node's next change;
  rule 4: if not, the operands that have changed are queried again, after that time.
";

/// The text of an explanation, of bounded length: see [`Explanation::text`].
#[derive(Clone, Debug)]
pub struct ExplanationText<'a> {
    explanation: &'a Explanation,
    figures: Figures,
    most_lines: usize,
}

impl Explanation {
    /// The explanation as text with at most `most_lines` lines of decisions; `usize::MAX` prints all. A query
    /// takes at most a tenth of them: of a longer one the beginning and the end are printed. Omitted lines
    /// are counted.
    pub fn text(&self, most_lines: usize) -> ExplanationText<'_> {
        ExplanationText { explanation: self, figures: Figures::new(self), most_lines }
    }
}

impl fmt::Display for Explanation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.text(MAX_LINES).fmt(f)
    }
}

impl fmt::Display for ExplanationText<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (o, d) = (self.explanation.ray.origin, self.explanation.ray.direction);
        let [ox, oy, oz, dx, dy, dz] = [o.x, o.y, o.z, d.x, d.y, d.z].map(|x| Figures::PEOPLE.text(x));
        writeln!(f, "The ray ({ox}, {oy}, {oz}) + t ({dx}, {dy}, {dz}).\n\n{LEGEND}")?;
        let (mut remaining, mut left_out) = (self.most_lines, 0);
        for question in &self.explanation.questions {
            if remaining == 0 {
                left_out += 1;
                continue;
            }
            let shown = shown(&question.entries);
            remaining = remaining.saturating_sub(self.question(f, question, &shown, remaining)?);
        }
        if left_out > 0 {
            writeln!(f, "... {left_out} more questions are left out.\n")?;
        }
        self.summary(f)
    }
}

impl ExplanationText<'_> {
    /// Prints a query. Returns the number of lines.
    fn question(
        &self,
        f: &mut fmt::Formatter<'_>,
        question: &Question,
        shown: &[&Entry],
        remaining: usize,
    ) -> Result<usize, fmt::Error> {
        writeln!(f, "The next change after t = {}:", self.figures.text(question.t_min))?;
        let most = (self.most_lines / SHARE).max(2).min(remaining);
        let (head, tail) = match shown.len() > most {
            true => (most - most / 2, most / 2),
            false => (shown.len(), 0),
        };
        shown[..head].iter().try_for_each(|entry| self.line(f, entry))?;
        if shown.len() > most {
            writeln!(f, "  ... {} lines are left out ...", shown.len() - head - tail)?;
        }
        shown[shown.len() - tail..].iter().try_for_each(|entry| self.line(f, entry))?;
        if question.left_out > 0 {
            writeln!(f, "  ... {} steps are not recorded.", question.left_out)?;
        }
        writeln!(f, "  So the ray is {}.\n", self.answer(question.answer))?;
        Ok(head + tail)
    }

    fn line(&self, f: &mut fmt::Formatter<'_>, entry: &Entry) -> fmt::Result {
        let indent = 2 + 2 * entry.depth.min(DEEPEST) as usize;
        write!(f, "{:indent$}{}", "", self.sentence(entry))?;
        match entry.what.rule() {
            Some(rule) => writeln!(f, " (rule {rule})"),
            None => writeln!(f),
        }
    }

    fn answer(&self, step: ValueStep) -> String {
        let name = |region: u32| self.region(region);
        match step.resolved() {
            Some(region) => format!("in {} from here on", name(region)),
            None => {
                let t = self.figures.text(step.t);
                format!("in {} until t = {t}, then in {}", name(step.before), name(step.after))
            }
        }
    }

    fn region(&self, region: u32) -> &str {
        self.explanation.regions.get(region as usize).map_or("", |name| name)
    }

    fn summary(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "The ray starts in {}.", self.region(self.explanation.start.0))?;
        let crossings = &self.explanation.crossings;
        for Found { crossing, face } in crossings.iter().take(MAX_CROSSINGS) {
            let [before, after] = [crossing.before, crossing.after].map(|region| self.region(region.0));
            let t = self.figures.text(crossing.t);
            writeln!(f, "At t = {t} it passes from {before} into {after}, through {face}.")?;
        }
        if crossings.len() > MAX_CROSSINGS {
            writeln!(f, "... and so on: {} crossings in all.", crossings.len())?;
        }
        if self.explanation.welded > 0 {
            let n = self.explanation.welded;
            writeln!(f, "Changes welded because the ray stays in both surfaces between them: {n}.")?;
        }
        let questions = match self.explanation.questions.len() {
            1 => "1 question".to_owned(),
            n => format!("{n} questions"),
        };
        writeln!(f, "({questions}, {} steps.)", self.explanation.steps())
    }

    /// A query or decision as a sentence.
    pub fn sentence(&self, entry: &Entry) -> String {
        match &entry.what {
            What::Leaf { answer, face_name, .. } => {
                let next = self.next(&entry.name, *answer);
                match face_name {
                    Some(face) => format!("{next}, through {face}."),
                    None => format!("{next}."),
                }
            }
            What::Gate { operands, value, verdict } => match *verdict {
                Verdict::Fixed(value) => {
                    format!("{}: {}.", self.for_good(entry, value), self.resolved_by(operands))
                }
                Verdict::Changes(step) => {
                    format!("{}: {}.", self.change(entry, step), self.events(operands, step.t, "and"))
                }
                Verdict::QueryAgain { t, .. } => {
                    let again = match operands.iter().filter(|x| x.answer.t == t).collect::<Vec<_>>()[..] {
                        [only] => format!("{} is queried again", subject(only)),
                        _ => "both are queried again".to_owned(),
                    };
                    let events = self.events(operands, t, "but");
                    format!("{}: {events}. So {again}.", self.no_change(entry, *value, t))
                }
            },
        }
    }

    fn next(&self, name: &str, answer: Next) -> String {
        match answer {
            Next::Enter(t) => format!("{name} is entered at {}", self.figures.text(t)),
            Next::Exit(t) => format!("{name} is left at {}", self.figures.text(t)),
            Next::Outside => format!("{name} is outside for good"),
            Next::Inside => format!("{name} is inside for good"),
        }
    }

    fn for_good(&self, Entry { name, meaning, .. }: &Entry, value: u32) -> String {
        match meaning {
            Meaning::Solid => self.next(name, ValueStep::constant(value).next()),
            Meaning::Count => format!("{name} is {value} for good"),
            Meaning::Region => format!("among {name} the ray is in {} for good", self.region(value)),
        }
    }

    fn change(&self, Entry { name, meaning, .. }: &Entry, step: ValueStep) -> String {
        match meaning {
            Meaning::Solid => self.next(name, step.next()),
            _ => format!("{} at {}", self.event(name, *meaning, step), self.figures.text(step.t)),
        }
    }

    fn no_change(&self, Entry { name, meaning, .. }: &Entry, value: u32, t: f64) -> String {
        let t = self.figures.text(t);
        match meaning {
            Meaning::Solid => format!("{name} stays {} at {t}", side(value)),
            Meaning::Count => format!("{name} stays {value} at {t}"),
            Meaning::Region => format!("among {name} the ray stays in {} at {t}", self.region(value)),
        }
    }

    /// The change at `t`, and the state of the operand that does not change then.
    fn events(&self, operands: &[ExplainedOperand; 2], t: f64, joint: &str) -> String {
        let event =
            |operand: &ExplainedOperand| self.event(&operand.name, operand.meaning, operand.own_answer());
        let [a, b] = operands;
        match [a.answer.t == t, b.answer.t == t] {
            [true, false] => format!("{}, {joint} {}", event(a), self.state(b)),
            [false, true] => format!("{}, {joint} {}", event(b), self.state(a)),
            _ => format!("{} and {} at the same time", event(a), event(b)),
        }
    }

    fn event(&self, name: &str, meaning: Meaning, step: ValueStep) -> String {
        match meaning {
            Meaning::Solid if step.before == 0 => format!("{name} is entered"),
            Meaning::Solid => format!("{name} is left"),
            Meaning::Count => format!("{name} becomes {}", step.after),
            Meaning::Region => {
                let [before, after] = [step.before, step.after].map(|region| self.region(region));
                format!("among {name} the ray passes from {before} into {after}")
            }
        }
    }

    /// The state of an operand and its duration.
    fn state(&self, operand: &ExplainedOperand) -> String {
        let (name, step) = (&operand.name, operand.own_answer());
        let until = match step.resolved() {
            Some(_) => "for good".to_owned(),
            None => format!("until {}", self.figures.text(step.t)),
        };
        match operand.meaning {
            Meaning::Solid => format!("the ray is {} {name} {until}", side(step.before)),
            Meaning::Count => format!("{name} is {} {until}", step.before),
            Meaning::Region => format!("among {name} the ray is in {} {until}", self.region(step.before)),
        }
    }

    /// The reason why a node is constant from here on.
    fn resolved_by(&self, operands: &[ExplainedOperand; 2]) -> String {
        let [a, b] = operands;
        match [a, b].map(|operand| operand.own_answer().resolved()) {
            [Some(x), Some(y)] if [a.meaning, b.meaning] == [Meaning::Solid; 2] => match x == y {
                true => format!("the ray is {} {} and {} for good", side(x), a.name, b.name),
                false => format!("the ray is {} {} and {} {} for good", side(x), a.name, side(y), b.name),
            },
            [Some(_), Some(_)] => format!("{}, and {}", self.state(a), self.state(b)),
            [Some(_), None] => format!("{}, regardless of {}", self.state(a), subject(b)),
            _ => format!("{}, regardless of {}", self.state(b), subject(a)),
        }
    }
}

fn side(value: u32) -> &'static str {
    if value == 0 { "outside" } else { "inside" }
}

/// The name of an operand in a sentence.
fn subject(operand: &ExplainedOperand) -> Arc<str> {
    match operand.meaning {
        Meaning::Region => format!("the choice among {}", operand.name).into(),
        Meaning::Solid | Meaning::Count => operand.name.clone(),
    }
}

/// The entries to be printed, without those that only lead to a node that is also found constant right after
/// them.
fn shown(entries: &[Entry]) -> Vec<&Entry> {
    let mut shown: Vec<&Entry> = Vec::new();
    for entry in entries {
        if entry.what.is_resolved() {
            forget_resolved(&mut shown, entry);
        }
        shown.push(entry);
    }
    shown
}

/// Drops the lines below a constant node if all of them are about constant nodes.
fn forget_resolved(shown: &mut Vec<&Entry>, node: &Entry) {
    let is_below = |entry: &&Entry| (node.begin..node.node).contains(&entry.node);
    let kept = shown.iter().rposition(|entry| !(entry.what.is_resolved() && is_below(entry)));
    if kept.is_none_or(|last| !is_below(&shown[last])) {
        shown.truncate(kept.map_or(0, |last| last + 1));
    }
}

/// Number of digits of printed times: at least six, and enough to distinguish all times.
#[derive(Clone, Copy, Debug)]
struct Figures {
    digits: usize,
}

impl Figures {
    /// Enough for any f64.
    const ALL: usize = 17;

    /// For coordinates of the ray.
    const PEOPLE: Figures = Figures { digits: 10 };

    fn new(explanation: &Explanation) -> Figures {
        let mut times: Vec<f64> = explanation.crossings.iter().map(|found| found.crossing.t).collect();
        for question in &explanation.questions {
            times.extend([question.t_min, question.answer.t]);
            times.extend(question.entries.iter().flat_map(|entry| match &entry.what {
                What::Leaf { answer, .. } => [answer.time(); 2],
                What::Gate { operands, .. } => operands.each_ref().map(|operand| operand.answer.t),
            }));
        }
        times.retain(|t| t.is_finite());
        times.sort_unstable_by(f64::total_cmp);
        times.dedup();
        let tells_apart = |digits: &usize| {
            let figures = Figures { digits: *digits };
            times.windows(2).all(|pair| figures.rounded(pair[0]) != figures.rounded(pair[1]))
        };
        Figures { digits: (6..Figures::ALL).find(tells_apart).unwrap_or(Figures::ALL) }
    }

    fn rounded(self, t: f64) -> f64 {
        format!("{t:.*e}", self.digits - 1).parse().unwrap_or(t)
    }

    fn text(self, t: f64) -> String {
        full(self.rounded(t))
    }
}

/// A number in decimal notation, or in scientific notation if it is very large or small.
fn full(x: f64) -> String {
    let is_plain = x == 0.0 || (1e-4..1e10).contains(&x.abs()) || !x.is_finite();
    // + 0.0 turns -0 into 0
    if is_plain { (x + 0.0).to_string() } else { format!("{x:e}") }
}
