//! Output: text on standard output, messages and progress on standard error.

use crate::failure::{Failure, stdout_failure};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use rayweave::measure::MeasureProgress;
use rayweave::scene::Diagnostics;
use rayweave::table::AtomicFile;
use std::borrow::Cow;
use std::io::{self, IsTerminal, Write};
use std::path::Path;
use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

const RED: &str = "\x1b[1;31m";
const BOLD: &str = "\x1b[1m";
const PLAIN: &str = "\x1b[0m";

/// Writes text to standard output, all of it. Control characters, which names of a model may contain and a terminal would obey, are
/// written as [`visible`] escapes.
pub fn print(text: &str) -> Result<(), Failure> {
    print_bytes(visible(text).as_bytes())
}

/// The text with control characters as escapes, such as `\\u001b`, which mean the same in JSON; line feeds and tabs are kept.
fn visible(text: &str) -> Cow<'_, str> {
    escaped(text, |c| c.is_control() && !matches!(c, '\n' | '\t'))
}

/// The text with the selected characters as escapes.
fn escaped(text: &str, is_selected: impl Fn(char) -> bool) -> Cow<'_, str> {
    if !text.contains(&is_selected) {
        return Cow::Borrowed(text);
    }
    let mut escaped = String::with_capacity(text.len() + 8);
    for c in text.chars() {
        match is_selected(c) {
            true => escaped += &format!("\\u{:04x}", u32::from(c)),
            false => escaped.push(c),
        }
    }
    Cow::Owned(escaped)
}

/// Writes bytes to standard output, all of them.
pub fn print_bytes(bytes: &[u8]) -> Result<(), Failure> {
    let mut stdout = io::stdout().lock();
    let written = stdout.write_all(bytes).and_then(|()| stdout.flush());
    written.map_err(|error| stdout_failure(&error))
}

/// Writes a file atomically; `-` is standard output.
pub fn save(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    if path == Path::new("-") {
        return print_bytes(bytes);
    }
    let mut file = AtomicFile::create(path)?;
    file.write_all(bytes)
        .map_err(|error| Failure::Run(format!("cannot write {}: {error}.", path.display())))?;
    file.finish()?;
    Ok(())
}

/// Reports a written file on standard output, unless it is standard output itself.
pub fn wrote(path: &Path, is_quiet: bool) -> Result<(), Failure> {
    match is_quiet || path == Path::new("-") {
        true => Ok(()),
        false => print(&format!("wrote {}\n", path.display())),
    }
}

/// True if messages may have colours: on a terminal, unless `NO_COLOR` is set (no-color.org).
fn has_colour() -> bool {
    let forbidden = std::env::var_os("NO_COLOR").is_some_and(|value| !value.is_empty());
    io::stderr().is_terminal() && !forbidden
}

/// Writes a message to standard error and ignores failures.
fn tell(text: &str) {
    let _ = writeln!(io::stderr(), "{text}");
}

/// Writes a note to standard error.
pub fn note(text: &str) {
    tell(&visible(text));
}

/// Writes an error without a position in a model file.
pub fn complain(text: &str) {
    let text = visible(text);
    match has_colour() {
        true => tell(&format!("{RED}error{PLAIN}{BOLD}:{PLAIN} {text}")),
        false => tell(&format!("error: {text}")),
    }
}

/// True if `--quiet` is given.
static IS_QUIET: AtomicBool = AtomicBool::new(false);

/// Suppresses warnings from now on.
pub fn silence_warnings() {
    IS_QUIET.store(true, Ordering::Relaxed);
}

fn is_quiet() -> bool {
    IS_QUIET.load(Ordering::Relaxed)
}

/// Writes a warning about ignored input, without a position in a model file, unless warnings are suppressed.
pub fn caution(text: &str) {
    if !is_quiet() {
        tell(&format!("warning: {}", visible(text)));
    }
}

/// Writes the problems of a model file, each with its position.
pub fn diagnose(diagnostics: &Diagnostics) {
    tell(&diagnostics.render(has_colour()));
}

/// Writes the warnings about a model file, if there are any, unless warnings are suppressed.
pub fn warn(warnings: &Diagnostics) {
    if !warnings.is_empty() && !is_quiet() {
        diagnose(warnings);
    }
}

/// Reports a failure on standard error; returns its exit code.
pub fn report(failure: &Failure) -> ExitCode {
    match failure {
        Failure::Library(error) => match error.diagnostics() {
            Some(diagnostics) => diagnose(diagnostics),
            None => complain(&error.to_string()),
        },
        Failure::Usage(text) | Failure::Input(text) | Failure::Run(text) => complain(text),
        Failure::BrokenPipe | Failure::Answer => {}
        Failure::Trouble(failure) => {
            report(failure);
        }
        Failure::Cancelled => complain("cancelled: unfinished files were removed."),
    }
    ExitCode::from(failure.code())
}

/// A progress bar on standard error, visible only on a terminal. Without a total it is a counter.
pub fn progress_bar(total: Option<u64>, unit: Unit, quiet: bool) -> ProgressBar {
    let target = match quiet {
        true => ProgressDrawTarget::hidden(),
        false => ProgressDrawTarget::stderr(),
    };
    let bar = ProgressBar::with_draw_target(total, target);
    let template = match (unit, total) {
        (Unit::Bytes, Some(_)) => "{bar:40} {bytes}/{total_bytes} {bytes_per_sec} {eta} left",
        (Unit::Bytes, None) => "{spinner} {bytes} {bytes_per_sec}",
        (Unit::Percent, _) => "{bar:40} {percent} % {eta} left",
    };
    // the templates are valid constants; if one were not, the default style would be used
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style);
    }
    bar.enable_steady_tick(Duration::from_millis(200));
    bar
}

/// A progress bar of sampling to a relative precision, with the time left and the precision reached.
pub struct Sampling {
    bar: ProgressBar,
    goal: f64,
}

/// The length of the bar of [`Sampling`].
const WHOLE: f64 = 1000.0;

impl Sampling {
    /// A bar, visible only on a terminal.
    pub fn new(goal: f64, quiet: bool) -> Sampling {
        let bar = progress_bar(Some(WHOLE as u64), Unit::Percent, quiet);
        if let Ok(style) = ProgressStyle::with_template("{bar:40} {percent} % {eta} left, {msg}") {
            bar.set_style(style);
        }
        Sampling { bar, goal }
    }

    /// Shows the number of rays and the precision reached.
    pub fn show(&self, rays: u64, precision: f64) {
        self.show_pair(rays, precision, [0, 1]);
    }

    /// Shows the same for one of several pairs that are measured one after the other, given the number of finished pairs and of all.
    pub fn show_pair(&self, rays: u64, precision: f64, [done, pairs]: [usize; 2]) {
        let part =
            (done as f64 + MeasureProgress { rays, precision }.part_done(self.goal)) / pairs.max(1) as f64;
        self.bar.set_position((WHOLE * part) as u64);
        let pair = match pairs {
            0 | 1 => String::new(),
            _ => format!("pair {} of {pairs}, ", done + 1),
        };
        let [now, goal] = [precision, self.goal].map(|part| short(rounded(100.0 * part, 2)));
        self.bar.set_message(match precision.is_finite() {
            true => format!("{pair}{rays} rays, precision {now} % of {goal} %"),
            false => format!("{pair}{rays} rays"),
        });
    }

    /// Removes the bar.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

/// A progress bar of searches with rays, with the time left and the number of rays.
pub struct Searching {
    bar: ProgressBar,
}

impl Searching {
    /// A bar, visible only on a terminal.
    pub fn new(quiet: bool) -> Searching {
        let bar = progress_bar(Some(0), Unit::Percent, quiet);
        if let Ok(style) = ProgressStyle::with_template("{bar:40} {percent} % {eta} left, {msg}") {
            bar.set_style(style);
        }
        Searching { bar }
    }

    /// Shows the finished part of the planned work, and the number of rays.
    pub fn show(&self, rays: u64, [done, total]: [u64; 2]) {
        self.bar.set_length(total);
        self.bar.set_position(done);
        self.bar.set_message(format!("{rays} rays"));
    }

    /// Removes the bar.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

/// Unit of a progress bar.
#[derive(Clone, Copy)]
pub enum Unit {
    /// Bytes of a file.
    Bytes,
    /// Parts of the work.
    Percent,
}

/// A number of things, with their name in the singular or plural.
pub fn count(number: u64, name: &str) -> String {
    let ending = if number == 1 { "" } else { "s" };
    format!("{number} {name}{ending}")
}

/// The name of a unit in a sentence: its symbol, except that of inches, which is a word.
pub fn unit_name(symbol: &str) -> &str {
    if symbol == "in" { "inches" } else { symbol }
}

/// Formats a number with three significant digits.
pub fn short3(x: f64) -> String {
    short(rounded(x, 3))
}

/// A number with `digits` significant digits, at least 1.
pub fn rounded(x: f64, digits: usize) -> f64 {
    format!("{x:.*e}", digits - 1).parse().unwrap_or(x)
}

/// A table with aligned columns: numbers to the right, text to the left. Control characters in cells are written as escapes.
pub fn table(header: &[&str], rows: &[Vec<String>], is_number: &[bool]) -> String {
    let rows: Vec<Vec<Cow<'_, str>>> =
        rows.iter().map(|row| row.iter().map(|cell| escaped(cell, char::is_control)).collect()).collect();
    let width = |k: usize| {
        let cells = rows.iter().map(|row| row[k].chars().count());
        cells.chain([header[k].chars().count()]).max().unwrap_or(0)
    };
    let widths: Vec<usize> = (0..header.len()).map(width).collect();
    let line = |cells: &mut dyn Iterator<Item = &str>| {
        let cells = cells.enumerate().map(|(k, cell)| match is_number[k] {
            true => format!("{cell:>width$}", width = widths[k]),
            false => format!("{cell:<width$}", width = widths[k]),
        });
        cells.collect::<Vec<_>>().join("  ").trim_end().to_owned() + "\n"
    };
    let mut text = line(&mut header.iter().copied());
    for row in &rows {
        text += &line(&mut row.iter().map(AsRef::as_ref));
    }
    text
}

/// Formats a number with at most ten significant digits; `-0` becomes `0`.
pub fn short(value: f64) -> String {
    let rounded: f64 = format!("{value:.9e}").parse().unwrap_or(value);
    let plain = rounded == 0.0 || (1e-4..1e10).contains(&rounded.abs()) || !rounded.is_finite();
    match rounded == 0.0 {
        true => "0".to_owned(),
        false if plain => rounded.to_string(),
        false => format!("{rounded:e}"),
    }
}

/// Formats a point for messages.
pub fn short_point(p: [f64; 3]) -> String {
    format!("({})", p.map(short).join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        assert_eq!(short(0.1 + 0.2), "0.3");
        assert_eq!(short(-0.0), "0");
        assert_eq!(short(1.0 / 3.0), "0.3333333333");
        assert_eq!(short(1e-20), "1e-20");
        assert_eq!(short(123456789012.0), "1.23456789e11");
        assert_eq!(short(f64::NEG_INFINITY), "-inf");
        assert_eq!(short_point([1.0, -2.5, 0.0]), "(1, -2.5, 0)");
    }

    #[test]
    fn control_characters_are_visible() {
        assert_eq!(visible("a\u{1b}]0;t\u{7}\tb\n"), "a\\u001b]0;t\\u0007\tb\n");
        assert_eq!(visible("\u{9b}\u{7f}\u{e9}"), "\\u009b\\u007f\u{e9}");
        let text = table(&["name", "n"], &[vec!["a\nb\u{1b}".to_owned(), "1".to_owned()]], &[false, true]);
        assert_eq!(text, "name            n\na\\u000ab\\u001b  1\n");
    }

    #[test]
    fn tables_are_aligned() {
        let rows =
            vec![vec!["1".to_owned(), "a".to_owned()], vec!["-20".to_owned(), "\u{e9}t\u{e9}".to_owned()]];
        let text = table(&["t", "name"], &rows, &[true, false]);
        assert_eq!(text, "  t  name\n  1  a\n-20  \u{e9}t\u{e9}\n");
    }
}
