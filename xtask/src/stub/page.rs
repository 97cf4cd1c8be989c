//! The text of the stub.

use super::attribute::Signature;
use super::function::{Function, Role};

/// The longest line of code.
const WIDTH: usize = 110;

/// A class of the stub.
pub struct Class {
    /// Name in Python.
    pub name: String,
    /// Base class, if it has one.
    pub base: Option<String>,
    /// The decorator, without the sign.
    pub decorator: Option<&'static str>,
    /// Lines of documentation.
    pub documentation: Vec<String>,
    /// Methods and properties.
    pub functions: Vec<Function>,
}

impl Class {
    /// The class as text.
    pub fn text(&self) -> String {
        let decorator = self.decorator.map(|name| format!("@{name}\n")).unwrap_or_default();
        let base = self.base.as_ref().map(|base| format!("({base})")).unwrap_or_default();
        let head = format!("{decorator}class {}{base}:", self.name);
        if self.documentation.is_empty() && self.functions.is_empty() {
            return format!("{head} ...\n");
        }
        let mut parts = Vec::new();
        if !self.documentation.is_empty() {
            parts.push(docstring(&self.documentation, "    "));
        }
        parts.extend(self.functions.iter().map(|function| function_text(function, "    ")));
        format!("{head}\n{}", joined(&parts))
    }
}

/// Definitions with an empty line after each that has documentation.
pub fn joined(parts: &[String]) -> String {
    let mut text = String::new();
    for (number, part) in parts.iter().enumerate() {
        let is_apart = part.contains("\"\"\"") || number > 0 && parts[number - 1].contains("\"\"\"");
        text += if number > 0 && is_apart { "\n" } else { "" };
        text += part;
    }
    text
}

/// A function as text, one definition for each overload.
pub fn function_text(function: &Function, indent: &str) -> String {
    let mut text = String::new();
    for (number, signature) in function.signatures.iter().enumerate() {
        if function.signatures.len() > 1 {
            text += &format!("{indent}@overload\n");
        }
        match function.role {
            Role::Property => text += &format!("{indent}@property\n"),
            Role::Static => text += &format!("{indent}@staticmethod\n"),
            Role::Class => text += &format!("{indent}@classmethod\n"),
            Role::Free | Role::Method | Role::Constructor => {}
        }
        text += &head(function, signature, indent);
        // editors show the documentation of the first overload
        if number == 0 && !function.documentation.is_empty() {
            text += &format!("\n{}", docstring(&function.documentation, &format!("{indent}    ")));
        } else {
            text += " ...\n";
        }
    }
    text
}

/// The definition of a name for a type with these alternatives.
pub fn alias_text(name: &str, alternatives: &[String]) -> String {
    let line = format!("{name} = {}\n", alternatives.join(" | "));
    match line.len() <= WIDTH {
        true => line,
        false => format!("{name} = (\n    {}\n)\n", alternatives.join("\n    | ")),
    }
}

/// The definition up to its colon: on one line, with the parameters on a line, or with a line for each.
fn head(function: &Function, signature: &Signature, indent: &str) -> String {
    let parameters = function.parameters(signature);
    let start = format!("{indent}def {}(", function.name);
    let end = format!(") -> {}:", signature.returns.as_deref().unwrap_or("None"));
    let list = parameters.join(", ");
    if start.len() + list.len() + end.len() + " ...".len() <= WIDTH {
        return format!("{start}{list}{end}");
    }
    let inner = format!("{indent}    ");
    let lines = match parameters.len() > 1 && inner.len() + list.len() <= WIDTH {
        true => format!("{inner}{list}\n"),
        false => parameters.iter().map(|parameter| format!("{inner}{parameter},\n")).collect(),
    };
    format!("{start}\n{lines}{indent}{end}")
}

/// Lines of documentation as a docstring.
fn docstring(lines: &[String], indent: &str) -> String {
    let escaped: Vec<String> =
        lines.iter().map(|line| line.replace('\\', "\\\\").replace("\"\"\"", "\\\"\\\"\\\"")).collect();
    let ends_in_quote = escaped.last().is_some_and(|line| line.ends_with('"'));
    let mut text = format!("{indent}\"\"\"");
    for (number, line) in escaped.iter().enumerate() {
        if number > 0 {
            text += "\n";
            text += if line.is_empty() { "" } else { indent };
        }
        text += line;
    }
    if escaped.len() > 1 || ends_in_quote {
        text += &format!("\n{indent}");
    }
    text + "\"\"\"\n"
}

#[cfg(test)]
mod tests {
    use super::*;

    fn function(returns: &str, documentation: &[&str]) -> Function {
        let signature = Signature { slots: Vec::new(), returns: Some(returns.to_owned()) };
        Function {
            name: "f".to_owned(),
            documentation: documentation.iter().map(|line| (*line).to_owned()).collect(),
            role: Role::Method,
            signatures: vec![signature],
        }
    }

    #[test]
    fn a_docstring_ends_where_the_text_ends() {
        let text = function_text(&function("int", &["A \"word\""]), "");
        assert_eq!(text, "def f(self) -> int:\n    \"\"\"A \"word\"\n    \"\"\"\n");
        let text = function_text(&function("int", &["One.", "", "Two \\ three."]), "");
        assert_eq!(text, "def f(self) -> int:\n    \"\"\"One.\n\n    Two \\\\ three.\n    \"\"\"\n");
    }

    #[test]
    fn a_long_definition_has_several_lines() {
        let long = "a".repeat(100);
        assert_eq!(
            function_text(&function(&long, &[]), ""),
            format!("def f(\n    self,\n) -> {long}: ...\n")
        );
    }
}
