//! Attributes of PyO3 and of the stub generator: their names, signatures and texts.

use syn::ext::IdentExt;
use syn::parse::{Parse, ParseStream};
use syn::punctuated::Punctuated;
use syn::{Attribute, Expr, ExprLit, Ident, Lit, LitStr, Meta, Token, UnOp, token};

/// The signature of a function as `#[pyo3(signature = ...)]` has it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Signature {
    /// Parameters and separators, in order.
    pub slots: Vec<Slot>,
    /// The type of the result.
    pub returns: Option<String>,
}

/// An item between the parentheses of a signature.
#[derive(Clone, Debug, PartialEq)]
pub enum Slot {
    /// The end of the positional-only parameters.
    Slash,
    /// The start of the keyword-only parameters.
    Star,
    /// A parameter.
    Parameter(Parameter),
}

/// A parameter in Python.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// `*` or `**` for the rest of the arguments, otherwise empty.
    pub prefix: &'static str,
    /// Name.
    pub name: String,
    /// Python type, if it is stated.
    pub annotation: Option<String>,
    /// Default value: a Python literal, or `...`.
    pub default: Option<String>,
}

/// Options of `#[pyo3(...)]` and `#[pyclass(...)]` that matter to the stub.
#[derive(Default)]
pub struct Options {
    /// The name in Python.
    pub name: Option<String>,
    /// The signature.
    pub signature: Option<Signature>,
    /// The base class, as named in Rust.
    pub extends: Option<String>,
    /// True if Python may derive classes from it.
    pub is_subclassable: bool,
    /// True if `==` is that of Rust.
    pub has_eq: bool,
}

/// One option: a name, perhaps with a value.
struct Entry(String, Value);

enum Value {
    Flag,
    Expression(Box<Expr>),
    Signature(Signature),
}

impl Parse for Entry {
    fn parse(input: ParseStream<'_>) -> syn::Result<Self> {
        let name = input.call(Ident::parse_any)?.to_string();
        if input.peek(token::Paren) {
            let content;
            syn::parenthesized!(content in input);
            content.parse::<proc_macro2::TokenStream>()?;
            return Ok(Entry(name, Value::Flag));
        }
        if !input.peek(Token![=]) {
            return Ok(Entry(name, Value::Flag));
        }
        input.parse::<Token![=]>()?;
        let value = match name.as_str() {
            "signature" => Value::Signature(input.parse()?),
            _ => Value::Expression(Box::new(input.parse()?)),
        };
        Ok(Entry(name, value))
    }
}

impl Parse for Signature {
    fn parse(input: ParseStream<'_>) -> syn::Result<Self> {
        let content;
        syn::parenthesized!(content in input);
        let slots = Punctuated::<Slot, Token![,]>::parse_terminated(&content)?;
        let returns = match input.parse::<Option<Token![->]>>()? {
            Some(_) => Some(input.parse::<LitStr>()?.value()),
            None => None,
        };
        Ok(Signature { slots: slots.into_iter().collect(), returns })
    }
}

impl Parse for Slot {
    fn parse(input: ParseStream<'_>) -> syn::Result<Self> {
        if input.parse::<Option<Token![/]>>()?.is_some() {
            return Ok(Slot::Slash);
        }
        let mut prefix = "";
        if input.parse::<Option<Token![*]>>()?.is_some() {
            prefix = if input.parse::<Option<Token![*]>>()?.is_some() { "**" } else { "*" };
            if input.is_empty() || input.peek(Token![,]) {
                return Ok(Slot::Star);
            }
        }
        let name = input.call(Ident::parse_any)?.to_string();
        let annotation = match input.parse::<Option<Token![:]>>()? {
            Some(_) => Some(input.parse::<LitStr>()?.value()),
            None => None,
        };
        let default = match input.parse::<Option<Token![=]>>()? {
            Some(_) => Some(python_literal(&input.parse()?)),
            None => None,
        };
        Ok(Slot::Parameter(Parameter { prefix, name, annotation, default }))
    }
}

/// A default value in Python; `...` if it is not a literal.
fn python_literal(value: &Expr) -> String {
    match value {
        Expr::Lit(ExprLit { lit: Lit::Bool(flag), .. }) if flag.value => "True".to_owned(),
        Expr::Lit(ExprLit { lit: Lit::Bool(_), .. }) => "False".to_owned(),
        Expr::Lit(ExprLit { lit: Lit::Int(number), .. }) => number.base10_digits().to_owned(),
        Expr::Lit(ExprLit { lit: Lit::Float(number), .. }) => number.base10_digits().to_owned(),
        Expr::Lit(ExprLit { lit: Lit::Str(text), .. }) => format!("{:?}", text.value()),
        Expr::Path(path) if path.path.is_ident("None") => "None".to_owned(),
        Expr::Unary(unary) if matches!(unary.op, UnOp::Neg(_)) => match python_literal(&unary.expr) {
            unknown if unknown == "..." => unknown,
            number => format!("-{number}"),
        },
        _ => "...".to_owned(),
    }
}

impl Options {
    /// The options of all attributes with one of these names.
    pub fn read(attributes: &[Attribute], names: &[&str]) -> syn::Result<Options> {
        let mut options = Options::default();
        let wanted = |attribute: &&Attribute| names.iter().any(|name| attribute.path().is_ident(name));
        for attribute in attributes.iter().filter(wanted) {
            let Meta::List(_) = &attribute.meta else { continue };
            for entry in attribute.parse_args_with(Punctuated::<Entry, Token![,]>::parse_terminated)? {
                options.add(entry);
            }
        }
        Ok(options)
    }

    fn add(&mut self, entry: Entry) {
        match entry {
            Entry(name, Value::Expression(value)) if name == "name" => self.name = text(&value),
            Entry(name, Value::Expression(value)) if name == "extends" => {
                if let Expr::Path(path) = *value {
                    self.extends = path.path.segments.last().map(|segment| segment.ident.to_string());
                }
            }
            Entry(_, Value::Signature(signature)) => self.signature = Some(signature),
            Entry(name, Value::Flag) if name == "subclass" => self.is_subclassable = true,
            Entry(name, Value::Flag) if name == "eq" => self.has_eq = true,
            _ => {}
        }
    }
}

/// The text of a string literal.
pub fn text(value: &Expr) -> Option<String> {
    match value {
        Expr::Lit(ExprLit { lit: Lit::Str(text), .. }) => Some(text.value()),
        _ => None,
    }
}

/// True if an attribute of this name is present.
pub fn has(attributes: &[Attribute], name: &str) -> bool {
    attributes.iter().any(|attribute| attribute.path().segments.last().is_some_and(|last| last.ident == name))
}

/// True if the item derives this trait.
pub fn derives(attributes: &[Attribute], name: &str) -> bool {
    let derive = attributes.iter().filter(|attribute| attribute.path().is_ident("derive"));
    let paths =
        derive.filter_map(|a| a.parse_args_with(Punctuated::<syn::Path, Token![,]>::parse_terminated).ok());
    paths.flatten().any(|path| path.segments.last().is_some_and(|last| last.ident == name))
}

/// The documentation, without the blank after the slashes.
pub fn documentation(attributes: &[Attribute]) -> Vec<String> {
    let lines = attributes.iter().filter(|attribute| attribute.path().is_ident("doc"));
    let lines = lines.filter_map(|attribute| match &attribute.meta {
        Meta::NameValue(pair) => text(&pair.value),
        _ => None,
    });
    let mut lines: Vec<String> =
        lines.map(|line| line.strip_prefix(' ').unwrap_or(&line).trim_end().to_owned()).collect();
    while lines.last().is_some_and(String::is_empty) {
        lines.pop();
    }
    lines
}

/// An attribute that the compiler drops: `#[cfg_attr(false, stub("..."))]`.
struct Dropped(Option<LitStr>);

impl Parse for Dropped {
    fn parse(input: ParseStream<'_>) -> syn::Result<Self> {
        let condition: Expr = input.parse()?;
        input.parse::<Token![,]>()?;
        let never = matches!(&condition, Expr::Lit(ExprLit { lit: Lit::Bool(flag), .. }) if !flag.value);
        let name = input.call(Ident::parse_any)?;
        if !never || name != "stub" {
            input.parse::<proc_macro2::TokenStream>()?;
            return Ok(Dropped(None));
        }
        let content;
        syn::parenthesized!(content in input);
        Ok(Dropped(Some(content.parse()?)))
    }
}

/// The texts of the attributes `#[cfg_attr(false, stub("..."))]`.
pub fn stub_texts(attributes: &[Attribute]) -> syn::Result<Vec<String>> {
    let mut texts = Vec::new();
    for attribute in attributes.iter().filter(|attribute| attribute.path().is_ident("cfg_attr")) {
        let Dropped(text) = attribute.parse_args()?;
        texts.extend(text.map(|text| text.value()));
    }
    Ok(texts)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parameter(name: &str, annotation: Option<&str>, default: Option<&str>) -> Slot {
        let [annotation, default] = [annotation, default].map(|text| text.map(str::to_owned));
        Slot::Parameter(Parameter { prefix: "", name: name.to_owned(), annotation, default })
    }

    #[test]
    fn signatures_have_types_defaults_and_separators() {
        let text = r#"(a: "int | None" = None, /, t_min = f64::NEG_INFINITY, n = -2, *, b = false) -> "str""#;
        let signature: Signature = syn::parse_str(text).unwrap();
        let expected = [
            parameter("a", Some("int | None"), Some("None")),
            Slot::Slash,
            parameter("t_min", None, Some("...")),
            parameter("n", None, Some("-2")),
            Slot::Star,
            parameter("b", None, Some("False")),
        ];
        assert_eq!(signature.slots, expected);
        assert_eq!(signature.returns.as_deref(), Some("str"));
    }

    #[test]
    fn the_rest_of_the_arguments_is_a_parameter() {
        let signature: Signature = syn::parse_str(r#"(*values, **options: "Any")"#).unwrap();
        let prefixes: Vec<&str> = signature
            .slots
            .iter()
            .map(|slot| if let Slot::Parameter(parameter) = slot { parameter.prefix } else { "none" })
            .collect();
        assert_eq!(prefixes, ["*", "**"]);
    }

    #[test]
    fn only_attributes_that_the_compiler_drops_are_read() {
        let item: syn::ItemFn = syn::parse_str(
            r#"#[cfg_attr(false, stub("() -> int"))] #[cfg_attr(test, stub("() -> str"))] fn f() {}"#,
        )
        .unwrap();
        assert_eq!(stub_texts(&item.attrs).unwrap(), ["() -> int"]);
    }
}
