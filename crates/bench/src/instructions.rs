//! Instruction counts of candidates by callgrind, which do not depend on the load of the machine.

use std::process::Command;

/// Instructions per item of a candidate of an exemplar: this program runs again under valgrind,
/// which collects inside [`counted`](crate::interleaved::counted) only. `None` if the candidate does
/// not exist there: the processor that valgrind emulates has no AVX-512.
pub fn count(exemplar: &str, candidate: &str) -> Result<Option<f64>, String> {
    let program = std::env::current_exe().map_err(|error| error.to_string())?;
    let mut command = Command::new("valgrind");
    command.args(["--tool=callgrind", "--callgrind-out-file=/dev/null", "--collect-atstart=no"]);
    command.arg("--toggle-collect=*interleaved*counted*").arg(program);
    if std::env::args().nth(1).as_deref() == Some("bench") {
        command.arg("bench");
    }
    command.args(["--only", exemplar, "--once", candidate]);
    let output = command.output().map_err(|error| format!("valgrind cannot be run: {error}"))?;
    let [printed, log] =
        [output.stdout, output.stderr].map(|bytes| String::from_utf8_lossy(&bytes).into_owned());
    if !output.status.success() {
        return Err(format!("instructions were not counted: {}", log.lines().last().unwrap_or_default()));
    }
    let Some(items) = number_after(&printed, "items ") else { return Ok(None) };
    let collected = number_after(&log, "Collected : ").ok_or("valgrind collected nothing")?;
    Ok(Some(collected / items))
}

/// The number after the last occurrence of a word.
fn number_after(text: &str, word: &str) -> Option<f64> {
    let (_, rest) = text.rsplit_once(word)?;
    rest.split_whitespace().next()?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_found() {
        let text = "==1== Events    : Ir\n==1== Collected : 123456\n==1==";
        assert_eq!(number_after(text, "Collected : "), Some(123_456.0));
        assert_eq!(number_after(text, "items "), None);
    }
}
