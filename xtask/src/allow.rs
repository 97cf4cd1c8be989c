//! The list of exceptions from the tidy checks, each with its reason.

/// One line of the list: `RULE PATH -- REASON`, or `RULE PATH::ITEM -- REASON` for one item of a file.
#[derive(Debug, PartialEq, Eq)]
pub struct Exception {
    /// The rule that the exception disables.
    pub rule: String,
    /// Place: a path, or a path, `::` and the name of an item.
    pub place: String,
    /// The line of the list.
    pub line: usize,
}

/// Reads the list; empty lines and comments from `#` on are ignored.
///
/// The error is the number of the first invalid line.
pub fn read(text: &str) -> Result<Vec<Exception>, usize> {
    let lines = text.lines().enumerate().map(|(index, line)| (index + 1, line.trim()));
    lines
        .filter(|(_, line)| !line.is_empty() && !line.starts_with('#'))
        .map(|(number, line)| read_line(number, line).ok_or(number))
        .collect()
}

fn read_line(line: usize, text: &str) -> Option<Exception> {
    let (subject, reason) = text.split_once(" -- ")?;
    let (rule, place) = subject.trim().split_once(' ')?;
    let complete = !reason.trim().is_empty() && !place.trim().contains(' ');
    complete.then(|| Exception { rule: rule.to_owned(), place: place.trim().to_owned(), line })
}

impl Exception {
    /// True if it covers a violation of this rule in this file, at this item.
    pub fn covers(&self, rule: &str, path: &str, item: &str) -> bool {
        let place = match self.place.split_once("::") {
            Some((file, name)) => file == path && name == item,
            None => self.place == path,
        };
        self.rule == rule && place
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exceptions_are_read() {
        let list = read("# why\n\nunsafe a/b.rs -- talks to C\nfunction-length c.rs::solve -- one formula\n")
            .unwrap();
        assert_eq!(list.len(), 2);
        assert!(list[0].covers("unsafe", "a/b.rs", "anything"));
        assert!(!list[0].covers("unsafe", "b.rs", ""));
        assert!(!list[0].covers("tabs", "a/b.rs", ""));
        assert!(list[1].covers("function-length", "c.rs", "solve"));
        assert!(!list[1].covers("function-length", "c.rs", "other"));
        assert_eq!(list[1].line, 4);
    }

    #[test]
    fn an_exception_needs_a_reason() {
        assert_eq!(read("unsafe a.rs -- x\nunsafe b.rs"), Err(2));
        assert_eq!(read("unsafe b.rs -- "), Err(1));
        assert_eq!(read("unsafe -- because"), Err(1));
    }
}
