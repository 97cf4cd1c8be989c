//! Functions and methods in Python: their parameters and results.

use std::fmt::Write;

use syn::punctuated::Punctuated;
use syn::{Attribute, FnArg, Pat, ReturnType, Token, Type};

use super::attribute::{self, Options, Parameter, Signature, Slot};
use super::binding::located;
use super::python_type::{Direction, Scope, without_option};

/// Binary operators: Python calls the one slot of PyO3 for both orders of the operands.
const OPERATORS: [(&str, &str); 8] = [
    ("__or__", "__ror__"),
    ("__and__", "__rand__"),
    ("__sub__", "__rsub__"),
    ("__xor__", "__rxor__"),
    ("__add__", "__radd__"),
    ("__mul__", "__rmul__"),
    ("__truediv__", "__rtruediv__"),
    ("__matmul__", "__rmatmul__"),
];

/// Operators that accept any object and return `NotImplemented` for foreign ones.
const COMPARISONS: [&str; 6] = ["__eq__", "__ne__", "__lt__", "__le__", "__gt__", "__ge__"];

/// Methods with two underscores that Python calls like any other.
const ORDINARY: [&str; 2] = ["__copy__", "__deepcopy__"];

/// Methods that have the types of `object`, and the one that only raises errors: in a stub it would permit every attribute.
const INHERITED: [&str; 4] = ["__repr__", "__str__", "__reduce__", "__getattr__"];

/// A function of the stub.
pub struct Function {
    /// Name in Python.
    pub name: String,
    /// Lines of documentation.
    pub documentation: Vec<String>,
    /// The kind of call.
    pub role: Role,
    /// One signature, or one of each overload.
    pub signatures: Vec<Signature>,
}

/// The ways to call a function.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Role {
    /// By its name.
    Free,
    /// On an object.
    Method,
    /// By reading an attribute.
    Property,
    /// On the class, without it.
    Static,
    /// On the class.
    Class,
    /// As the constructor.
    Constructor,
}

/// A function of Rust with its attributes.
pub struct Rust<'a> {
    pub attributes: &'a [Attribute],
    pub signature: &'a syn::Signature,
    /// False for a method.
    pub is_free: bool,
}

impl Rust<'_> {
    /// The function in Python, and the reflected operator; empty if the stub leaves it to `object`.
    pub fn functions(&self, scope: Scope<'_>) -> Result<Vec<Function>, Vec<String>> {
        let path = &scope.binding.file(scope.file).path;
        let failed = |error: syn::Error| vec![located(path, &error)];
        let options = Options::read(self.attributes, &["pyo3", "pyfunction"]).map_err(failed)?;
        let role = self.role();
        let name = self.python_name(&options, role);
        if INHERITED.contains(&name.as_str()) {
            return Ok(Vec::new());
        }
        let texts = attribute::stub_texts(self.attributes).map_err(failed)?;
        let overloads = if texts.is_empty() { vec![String::new()] } else { texts };
        let start = self.signature.ident.span().start().line;
        let stated = options.signature.unwrap_or_else(|| self.plain_signature(&name, role));
        let mut problems = Vec::new();
        let mut signatures = Vec::new();
        for overload in &overloads {
            let filled =
                changed(&stated, overload).and_then(|signature| self.filled(signature, &name, scope));
            match filled {
                Ok(signature) => signatures.push(signature),
                Err(problem) => problems.push(format!("{path}:{start}: {name}: {problem}")),
            }
        }
        if !problems.is_empty() {
            return Err(problems);
        }
        let documentation = attribute::documentation(self.attributes);
        let reflected =
            OPERATORS.iter().find(|(operator, _)| *operator == name).map(|(_, reflected)| *reflected);
        let mut functions = vec![Function { name, documentation, role, signatures: signatures.clone() }];
        functions.extend(reflected.map(|reflected| Function {
            name: reflected.to_owned(),
            documentation: Vec::new(),
            role,
            signatures,
        }));
        Ok(functions)
    }

    fn role(&self) -> Role {
        let has = |name: &str| attribute::has(self.attributes, name);
        match () {
            () if self.is_free => Role::Free,
            () if has("new") => Role::Constructor,
            () if has("getter") => Role::Property,
            () if has("staticmethod") => Role::Static,
            () if has("classmethod") => Role::Class,
            () => Role::Method,
        }
    }

    fn python_name(&self, options: &Options, role: Role) -> String {
        let own = self.signature.ident.to_string();
        match (&options.name, role) {
            (_, Role::Constructor) => "__new__".to_owned(),
            (Some(name), _) => name.clone(),
            (None, Role::Property) => own.strip_prefix("get_").unwrap_or(&own).to_owned(),
            (None, _) => own,
        }
    }

    /// The parameters that Python passes: neither the interpreter nor the object itself.
    fn inputs(&self, role: Role) -> Vec<(String, &Type)> {
        let inputs: &Punctuated<FnArg, Token![,]> = &self.signature.inputs;
        let typed = inputs.iter().filter_map(|input| match input {
            FnArg::Typed(typed) => Some(typed),
            FnArg::Receiver(_) => None,
        });
        let names = typed.filter_map(|typed| match &*typed.pat {
            Pat::Ident(pattern) => Some((pattern.ident.to_string(), &*typed.ty)),
            _ => None,
        });
        let mut names: Vec<(String, &Type)> = names.filter(|(_, ty)| !is_interpreter(ty)).collect();
        let has_object = matches!(role, Role::Method | Role::Property | Role::Class);
        if has_object && self.signature.receiver().is_none() && !names.is_empty() {
            names.remove(0);
        }
        names
    }

    /// The signature without attribute: all parameters are required.
    fn plain_signature(&self, name: &str, role: Role) -> Signature {
        let parameter = |(name, _): (String, &Type)| {
            Slot::Parameter(Parameter { prefix: "", name, annotation: None, default: None })
        };
        let mut slots: Vec<Slot> = self.inputs(role).into_iter().map(parameter).collect();
        let is_slot = name.starts_with("__") && !ORDINARY.contains(&name) && role == Role::Method;
        if is_slot && !slots.is_empty() {
            slots.push(Slot::Slash);
        }
        Signature { slots, returns: None }
    }

    /// The signature with the types of all parameters and of the result.
    fn filled(&self, mut signature: Signature, name: &str, scope: Scope<'_>) -> Result<Signature, String> {
        let is_comparison = COMPARISONS.contains(&name);
        let inputs = self.inputs(self.role());
        for slot in &mut signature.slots {
            let Slot::Parameter(parameter) = slot else { continue };
            if parameter.annotation.is_some() {
                continue;
            }
            let input = inputs.iter().find(|(name, _)| *name == parameter.name);
            let python = match input {
                _ if is_comparison => Some("object".to_owned()),
                Some((_, ty)) if parameter.prefix.is_empty() => scope.python(ty, Direction::Argument),
                _ => None,
            };
            let unknown = || {
                format!(
                    "the Python type of '{}' does not follow from Rust. State it in the signature.",
                    parameter.name
                )
            };
            parameter.annotation = Some(python.ok_or_else(unknown)?);
        }
        if signature.returns.is_none() {
            let python = if is_comparison { Some("bool".to_owned()) } else { self.result(name, scope) };
            let unknown =
                || "the Python type of the result does not follow from Rust. State it in the signature.";
            signature.returns = Some(python.ok_or_else(unknown)?);
        }
        Ok(signature)
    }

    fn result(&self, name: &str, scope: Scope<'_>) -> Option<String> {
        if self.role() == Role::Constructor {
            return scope.own.map(str::to_owned);
        }
        match &self.signature.output {
            ReturnType::Default => Some("None".to_owned()),
            // the iteration ends at `None`
            ReturnType::Type(_, ty) if name == "__next__" => {
                scope.python(without_option(ty), Direction::Result)
            }
            ReturnType::Type(_, ty) => scope.python(ty, Direction::Result),
        }
    }
}

fn is_interpreter(ty: &Type) -> bool {
    matches!(ty, Type::Path(path) if path.path.segments.last().is_some_and(|last| last.ident == "Python"))
}

/// A signature with the changes of a text such as `(index: Literal[0]) -> int`: it states parameters
/// that differ, and the result if it differs.
fn changed(stated: &Signature, text: &str) -> Result<Signature, String> {
    let mut signature = stated.clone();
    if text.is_empty() {
        return Ok(signature);
    }
    let wrong =
        || format!("the stub's signature is \"{text}\". Write it as \"(name: type = default) -> type\".");
    let close = closing(text).ok_or_else(wrong)?;
    for own in split(&text[1..close]) {
        let (name, rest) = own.split_once(':').ok_or_else(wrong)?;
        let (annotation, default) = match rest.split_once(" = ") {
            Some((annotation, default)) => (annotation, Some(default.trim().to_owned())),
            None => (rest, None),
        };
        let slot = signature.slots.iter_mut().find_map(|slot| match slot {
            Slot::Parameter(parameter) if parameter.name == name.trim() => Some(parameter),
            _ => None,
        });
        let unknown = || format!("the stub's signature has '{}': there is no such parameter.", name.trim());
        let parameter = slot.ok_or_else(unknown)?;
        parameter.annotation = Some(annotation.trim().to_owned());
        parameter.default = default;
    }
    match text[close + 1..].trim() {
        "" => {}
        rest => signature.returns = Some(rest.strip_prefix("->").ok_or_else(wrong)?.trim().to_owned()),
    }
    Ok(signature)
}

/// The place of the parenthesis that closes the first character.
fn closing(text: &str) -> Option<usize> {
    let mut depth = 0;
    for (place, character) in text.char_indices() {
        depth += match character {
            '(' => 1,
            ')' => -1,
            _ => 0,
        };
        if depth == 0 {
            return (character == ')').then_some(place);
        }
    }
    None
}

/// The parts between commas that are in no brackets.
fn split(text: &str) -> Vec<&str> {
    let (mut parts, mut depth, mut start) = (Vec::new(), 0, 0);
    for (place, character) in text.char_indices() {
        match character {
            '[' | '(' => depth += 1,
            ']' | ')' => depth -= 1,
            ',' if depth == 0 => {
                parts.push(text[start..place].trim());
                start = place + 1;
            }
            _ => {}
        }
    }
    parts.push(text[start..].trim());
    parts.retain(|part| !part.is_empty());
    parts
}

impl Function {
    /// A comparison that PyO3 derives.
    pub fn comparison(name: &str) -> Function {
        let other = Parameter {
            prefix: "",
            name: "other".to_owned(),
            annotation: Some("object".to_owned()),
            default: None,
        };
        let slots = vec![Slot::Parameter(other), Slot::Slash];
        let signature = Signature { slots, returns: Some("bool".to_owned()) };
        let (name, documentation) = (name.to_owned(), Vec::new());
        Function { name, documentation, role: Role::Method, signatures: vec![signature] }
    }

    /// The types that its signatures name.
    pub fn annotations(&self) -> impl Iterator<Item = &str> {
        self.signatures.iter().flat_map(|signature| {
            let parameters = signature.slots.iter().filter_map(|slot| match slot {
                Slot::Parameter(parameter) => parameter.annotation.as_deref(),
                _ => None,
            });
            parameters.chain(signature.returns.as_deref())
        })
    }

    /// The parameters of a signature as text, one by one.
    pub fn parameters(&self, signature: &Signature) -> Vec<String> {
        let first = match self.role {
            Role::Free | Role::Static => None,
            Role::Method | Role::Property => Some("self"),
            Role::Class | Role::Constructor => Some("cls"),
        };
        let mut all: Vec<String> = first.into_iter().map(str::to_owned).collect();
        all.extend(signature.slots.iter().map(slot_text));
        all
    }
}

/// A type with the quotation marks that formatters of Python prefer.
fn quoted(annotation: &str) -> String {
    annotation.replace('\'', "\"")
}

fn slot_text(slot: &Slot) -> String {
    match slot {
        Slot::Slash => "/".to_owned(),
        Slot::Star => "*".to_owned(),
        Slot::Parameter(Parameter { prefix, name, annotation, default }) => {
            let mut text = format!("{prefix}{name}");
            // writing to a String cannot fail
            let _ = write!(text, ": {}", quoted(annotation.as_deref().unwrap_or("Any")));
            if let Some(default) = default {
                let _ = write!(text, " = {default}");
            }
            text
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::binding::tests::binding;
    use super::*;

    /// The functions of a method of the class `Ray`, as text.
    fn stub(method: &str) -> Result<Vec<String>, Vec<String>> {
        let binding = binding(&[("", "#[pymodule] mod _core {}")]);
        let scope = Scope { binding: &binding, file: 0, own: Some("Ray") };
        let method: syn::ImplItemFn = syn::parse_str(method).unwrap();
        let rust = Rust { attributes: &method.attrs, signature: &method.sig, is_free: false };
        let text = |function: &Function, signature: &Signature| {
            let returns = signature.returns.as_deref().unwrap_or_default();
            format!("{}({}) -> {returns}", function.name, function.parameters(signature).join(", "))
        };
        let functions = rust.functions(scope)?;
        Ok(functions
            .iter()
            .flat_map(|f| f.signatures.iter().map(|s| text(f, s)).collect::<Vec<_>>())
            .collect())
    }

    #[test]
    fn an_operator_has_both_orders() {
        let found = stub("fn __sub__(&self, other: PyRef<'_, Self>) -> PyResult<Self> {}").unwrap();
        assert_eq!(found, ["__sub__(self, other: Ray, /) -> Ray", "__rsub__(self, other: Ray, /) -> Ray"]);
        let found = stub("fn __eq__(&self, other: PyRef<'_, Self>) -> bool {}").unwrap();
        assert_eq!(found, ["__eq__(self, other: object, /) -> bool"]);
    }

    #[test]
    fn an_overload_states_only_its_differences() {
        let found = stub(
            r#"#[pyo3(signature = (points: "ArrayLike", *, pair = false) -> "int")]
            #[cfg_attr(false, stub("(pair: Literal[False] = False)"))]
            #[cfg_attr(false, stub("(pair: Literal[True]) -> tuple[int, int]"))]
            fn f(slf: &Bound<'_, Self>, py: Python<'_>, points: &Bound<'_, PyAny>, pair: bool) {}"#,
        )
        .unwrap();
        let expected = [
            "f(self, points: ArrayLike, *, pair: Literal[False] = False) -> int",
            "f(self, points: ArrayLike, *, pair: Literal[True]) -> tuple[int, int]",
        ];
        assert_eq!(found, expected);
    }

    #[test]
    fn a_type_that_only_a_person_knows_is_a_problem_with_its_place() {
        let problems = stub("\nfn f(&self, points: &Bound<'_, PyAny>) {}").unwrap_err();
        let expected =
            ".rs:2: f: the Python type of 'points' does not follow from Rust. State it in the signature.";
        assert_eq!(problems, [expected]);
    }
}
