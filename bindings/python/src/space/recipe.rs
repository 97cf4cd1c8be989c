//! Recipe of a solid in R^d, by which Python compares, prints, hashes and pickles it.

use std::collections::HashMap;
use std::sync::Arc;

/// A call that makes a solid, with the calls that made its operands. Recipes are shared. No
/// traversal recurses, so that the depth is limited only by memory.
pub struct Recipe {
    /// The name of the call: one of [`CALLS`].
    pub call: &'static str,
    /// The dimension of the result.
    pub dimension: usize,
    /// Its numbers, one after the other; zeros are positive.
    pub numbers: Vec<f64>,
    /// The name, for the call `named`.
    pub name: Option<Arc<str>>,
    /// The operands.
    pub operands: Vec<Arc<Recipe>>,
}

/// All calls.
pub const CALLS: [&str; 20] = [
    "empty",
    "universe",
    "half_space",
    "slab",
    "box",
    "quadric",
    "ball",
    "cylinder",
    "cone",
    "prism",
    "polygons",
    "affine",
    "translate",
    "scale",
    "rotate",
    "extrude",
    "complement",
    "union",
    "intersection",
    "named",
];

/// The calls that are operators between two solids.
pub const OPERATORS: [&str; 2] = ["difference", "symmetric_difference"];

/// The call of this name.
pub fn call_named(name: &str) -> Option<&'static str> {
    CALLS.into_iter().chain(OPERATORS).find(|&call| call == name)
}

/// One call of a recipe written as a list; operands are indices of earlier steps.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Step {
    pub call: &'static str,
    pub dimension: usize,
    /// The bits of the numbers.
    pub numbers: Vec<u64>,
    pub name: Option<Arc<str>>,
    pub operands: Vec<usize>,
}

impl Recipe {
    /// The calls in order, equal ones once. Recipes are equal if and only if their lists are equal,
    /// however they share parts.
    pub fn steps(&self) -> Vec<Step> {
        let (mut steps, mut number_of, mut done) = (Vec::new(), HashMap::new(), HashMap::new());
        let mut waiting = vec![(self, false)];
        while let Some((recipe, operands_done)) = waiting.pop() {
            let address = std::ptr::from_ref(recipe);
            if done.contains_key(&address) {
                continue;
            }
            if !operands_done {
                waiting.push((recipe, true));
                waiting.extend(recipe.operands.iter().rev().map(|operand| (&**operand, false)));
                continue;
            }
            let step = Step {
                call: recipe.call,
                dimension: recipe.dimension,
                numbers: recipe.numbers.iter().map(|x| x.to_bits()).collect(),
                name: recipe.name.clone(),
                operands: recipe.operands.iter().map(|operand| done[&Arc::as_ptr(operand)]).collect(),
            };
            let number = *number_of.entry(step.clone()).or_insert_with(|| {
                steps.push(step);
                steps.len() - 1
            });
            done.insert(address, number);
        }
        steps
    }

    /// The recipe as text, truncated to a maximum length.
    pub fn text(&self) -> String {
        let mut texts: Vec<String> = Vec::new();
        for step in self.steps() {
            let text = step.text(&texts);
            texts.push(cut(text));
        }
        texts.pop().unwrap_or_default()
    }
}

impl Step {
    fn text(&self, made: &[String]) -> String {
        let operands: Vec<&str> = self.operands.iter().map(|&k| made[k].as_str()).collect();
        let joined = |sign: &str| format!("({})", operands.join(sign));
        match (self.call, operands.as_slice()) {
            ("named", _) => self.name.as_deref().unwrap_or_default().to_owned(),
            ("complement", [part]) => format!("~{part}"),
            ("union", [_, _, ..]) => joined(" | "),
            ("intersection", [_, _, ..]) => joined(" & "),
            ("difference", _) => joined(" - "),
            ("symmetric_difference", _) => joined(" ^ "),
            _ => {
                let numbers = self.numbers.iter().map(|&bits| format!("{}", f64::from_bits(bits)));
                let arguments = operands.iter().map(|&text| text.to_owned()).chain(numbers);
                format!("{}({})", self.call, arguments.collect::<Vec<_>>().join(", "))
            }
        }
    }
}

/// At most `most` characters.
fn cut(text: String) -> String {
    const LONG: usize = 100;
    match text.char_indices().nth(LONG) {
        Some((end, _)) => format!("{}...", text[..end].trim_end_matches('.')),
        None => text,
    }
}

impl Drop for Recipe {
    fn drop(&mut self) {
        let mut waiting = std::mem::take(&mut self.operands);
        while let Some(operand) = waiting.pop() {
            if let Some(mut last) = Arc::into_inner(operand) {
                waiting.append(&mut last.operands);
            }
        }
    }
}
