//! Serialisation of solids for pickling, and their hash, by loops over nodes: operands first, each
//! shared node once.

use std::collections::HashMap;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::sync::Arc;

use rayweave::math::{Affine, Vec3};
use rayweave::model::{Copies, Node, Solid};
use rayweave::shape::primitive::{Primitive, Value, build};

/// Header of the bytes; the number is the version of the format.
const MAGIC: &[u8] = b"rayweave solid 1\n";

/// The nodes of a solid, operands before the nodes that use them, shared ones once, with the
/// numbers of their operands.
struct Order<'a> {
    nodes: Vec<&'a Node>,
    number: HashMap<*const Node, usize>,
}

impl<'a> Order<'a> {
    fn new(solid: &'a Solid) -> Self {
        let mut order = Order { nodes: Vec::new(), number: HashMap::new() };
        let mut waiting = vec![(solid.node(), false)];
        while let Some((node, operands_done)) = waiting.pop() {
            if order.number.contains_key(&std::ptr::from_ref(node)) {
                continue;
            }
            if operands_done {
                order.number.insert(node, order.nodes.len());
                order.nodes.push(node);
            } else {
                waiting.push((node, true));
                waiting.extend(node.operand_refs().map(|operand| (operand.node(), false)));
            }
        }
        order
    }

    fn operands(&self, node: &'a Node) -> impl Iterator<Item = usize> {
        node.operand_refs().map(|operand| self.number[&std::ptr::from_ref(operand.node())])
    }
}

/// A structural hash of a solid: equal for equal solids, however they share nodes.
pub fn hash(solid: &Solid) -> u64 {
    let order = Order::new(solid);
    let mut hashes: Vec<u64> = Vec::with_capacity(order.nodes.len());
    for &node in &order.nodes {
        let mut hasher = DefaultHasher::new();
        std::mem::discriminant(node).hash(&mut hasher);
        hash_head(node, &mut hasher);
        order.operands(node).for_each(|k| hashes[k].hash(&mut hasher));
        hashes.push(hasher.finish());
    }
    hashes.last().copied().unwrap_or_default()
}

fn hash_head(node: &Node, hasher: &mut DefaultHasher) {
    // adding zero makes the two zeros, which are equal, hash alike
    let mut number = |value: f64| (value + 0.0).to_bits().hash(hasher);
    match node {
        Node::Transformed(map, _) => numbers_of(&map.get()).into_iter().for_each(number),
        Node::Placed(_, copies) => {
            copies.iter().flat_map(numbers_of).for_each(number);
            (copies.name(), copies.numbers()).hash(hasher);
        }
        Node::Primitive(primitive) => {
            for (_, value) in primitive.arguments() {
                flat(&value).into_iter().for_each(&mut number);
            }
            primitive.name().hash(hasher);
        }
        Node::Named(name, _) => name.hash(hasher),
        _ => {}
    }
}

fn flat(value: &Value) -> Vec<f64> {
    match value {
        Value::Number(number) => vec![*number],
        Value::Vector(list) => list.clone(),
        Value::Rows(rows) => rows.concat(),
    }
}

fn numbers_of(map: &Affine) -> [f64; 12] {
    let (linear, translation) = (map.linear.to_cols_array(), map.translation.to_array());
    std::array::from_fn(|k| if k < 9 { linear[k] } else { translation[k - 9] })
}

/// Serialises a solid.
pub fn encode(solid: &Solid) -> Vec<u8> {
    let order = Order::new(solid);
    let mut out = Writer(MAGIC.to_vec());
    out.count(order.nodes.len());
    for (number, &node) in order.nodes.iter().enumerate() {
        out.node(node);
        // relative to the node, so that numbers are small regardless of the size of the solid
        order.operands(node).for_each(|operand| out.count(number - operand));
    }
    out.0
}

/// Deserialises the bytes of [`encode`]; the error is the reason why they are invalid.
pub fn decode(bytes: &[u8]) -> Result<Solid, String> {
    let bytes = bytes
        .strip_prefix(MAGIC)
        .ok_or("the bytes are not a solid: they were not written by this version.")?;
    let mut reader = Reader(bytes);
    let count = reader.count()?;
    let mut solids: Vec<Solid> = Vec::new();
    for _ in 0..count {
        let solid = reader.node(&solids)?;
        solids.push(solid);
    }
    solids.pop().filter(|_| reader.0.is_empty()).ok_or_else(cut)
}

fn cut() -> String {
    "the bytes of the solid are cut short or damaged".to_owned()
}

struct Writer(Vec<u8>);

impl Writer {
    /// Writes an integer in groups of seven bits, the lowest first.
    fn count(&mut self, mut count: usize) {
        while count >= 0x80 {
            self.0.push(count as u8 | 0x80);
            count >>= 7;
        }
        self.0.push(count as u8);
    }

    fn numbers(&mut self, numbers: &[f64]) {
        numbers.iter().for_each(|number| self.0.extend(number.to_le_bytes()));
    }

    fn text(&mut self, text: &str) {
        self.count(text.len());
        self.0.extend(text.as_bytes());
    }

    /// Writes the node without its operands.
    fn node(&mut self, node: &Node) {
        match node {
            Node::Empty => self.0.push(b'0'),
            Node::Universe => self.0.push(b'1'),
            Node::Primitive(primitive) => self.primitive(primitive),
            Node::Complement(_) => self.0.push(b'~'),
            Node::Union(all) => self.join(b'|', all),
            Node::Intersection(all) => self.join(b'&', all),
            Node::SymmetricDifference(all) => self.join(b'^', all),
            Node::Difference(..) => self.0.push(b'-'),
            Node::Transformed(map, _) => {
                self.0.push(b'm');
                self.numbers(&numbers_of(&map.get()));
            }
            Node::Named(name, _) => {
                self.0.push(b'n');
                self.text(name);
            }
            Node::Placed(_, copies) => {
                self.0.push(if copies.name().is_some() { b'l' } else { b'p' });
                self.count(copies.len());
                copies.iter().for_each(|map| self.numbers(&numbers_of(map)));
                if let Some(name) = copies.name() {
                    self.text(name);
                    let numbers = copies.numbers().map_or(&[][..], |numbers| numbers);
                    self.count(numbers.len());
                    numbers.iter().for_each(|number| self.0.extend(number.to_le_bytes()));
                }
            }
        }
    }

    fn join(&mut self, tag: u8, operands: &[Solid]) {
        self.0.push(tag);
        self.count(operands.len());
    }

    fn primitive(&mut self, primitive: &Primitive) {
        self.0.push(b's');
        self.text(primitive.name());
        let arguments = primitive.arguments();
        self.count(arguments.len());
        for (name, value) in &arguments {
            self.text(name);
            self.value(value);
        }
    }

    fn value(&mut self, value: &Value) {
        match value {
            Value::Number(number) => {
                self.0.push(b'n');
                self.numbers(&[*number]);
            }
            Value::Vector(list) => {
                self.0.push(b'v');
                self.count(list.len());
                self.numbers(list);
            }
            Value::Rows(rows) => {
                self.0.push(b'r');
                self.count(rows.len());
                for row in rows {
                    self.count(row.len());
                    self.numbers(row);
                }
            }
        }
    }
}

struct Reader<'a>(&'a [u8]);

impl<'a> Reader<'a> {
    fn take(&mut self, count: usize) -> Result<&'a [u8], String> {
        let (taken, rest) = self.0.split_at_checked(count).ok_or_else(cut)?;
        self.0 = rest;
        Ok(taken)
    }

    fn byte(&mut self) -> Result<u8, String> {
        Ok(self.take(1)?[0])
    }

    fn count(&mut self) -> Result<usize, String> {
        let mut count = 0;
        for shift in (0..usize::BITS).step_by(7) {
            let byte = self.byte()?;
            count |= usize::from(byte & 0x7f) << shift;
            if byte < 0x80 {
                return Ok(count);
            }
        }
        Err(cut())
    }

    fn numbers(&mut self, count: usize) -> Result<Vec<f64>, String> {
        let bytes = self.take(count.checked_mul(8).ok_or_else(cut)?)?;
        let words = bytes.as_chunks::<8>().0;
        Ok(words.iter().map(|word| f64::from_le_bytes(*word)).collect())
    }

    fn text(&mut self) -> Result<&'a str, String> {
        let len = self.count()?;
        std::str::from_utf8(self.take(len)?).map_err(|_| cut())
    }

    fn map(&mut self) -> Result<Affine, String> {
        let numbers = self.numbers(12)?;
        let column = |k: usize| Vec3::from_slice(&numbers[3 * k..]);
        Ok(Affine {
            linear: rayweave::math::Mat3::from_cols(column(0), column(1), column(2)),
            translation: column(3),
        })
    }

    fn node(&mut self, solids: &[Solid]) -> Result<Solid, String> {
        Ok(match self.byte()? {
            b'0' => Solid::empty(),
            b'1' => Solid::universe(),
            b's' => self.primitive()?,
            b'~' => !self.operand(solids)?,
            b'|' => Solid::union(self.operands(solids)?),
            b'&' => Solid::intersection(self.operands(solids)?),
            b'^' => Solid::symmetric_difference(self.operands(solids)?),
            b'-' => self.operand(solids)? - self.operand(solids)?,
            b'm' => {
                let map = self.map()?;
                self.operand(solids)?.apply(map)
            }
            b'n' => {
                let name = self.text()?;
                self.operand(solids)?.named(name)
            }
            b'p' => {
                let count = self.count()?;
                let maps: Result<Arc<[Affine]>, String> = (0..count).map(|_| self.map()).collect();
                let maps = maps?;
                self.operand(solids)?.place(maps)
            }
            b'l' => {
                let count = self.count()?;
                let maps: Vec<Affine> = (0..count).map(|_| self.map()).collect::<Result<_, _>>()?;
                let (name, count) = (self.text()?, self.count()?);
                let bytes = self.take(count.checked_mul(8).ok_or_else(cut)?)?;
                let words = bytes.as_chunks::<8>().0.iter();
                let numbers: Arc<[i64]> = words.map(|word| i64::from_le_bytes(*word)).collect();
                let numbers = (!numbers.is_empty()).then_some(numbers);
                self.operand(solids)?.place_copies(Copies::labelled(maps, name, numbers))
            }
            _ => return Err(cut()),
        })
    }

    fn operand(&mut self, solids: &[Solid]) -> Result<Solid, String> {
        let back = self.count()?;
        let number = solids.len().checked_sub(back).ok_or_else(cut)?;
        solids.get(number).cloned().ok_or_else(cut)
    }

    fn operands(&mut self, solids: &[Solid]) -> Result<Vec<Solid>, String> {
        let count = self.count()?;
        (0..count).map(|_| self.operand(solids)).collect()
    }

    fn primitive(&mut self) -> Result<Solid, String> {
        let name = self.text()?;
        let count = self.count()?;
        let arguments: Result<Vec<(&str, Value)>, String> =
            (0..count).map(|_| Ok((self.text()?, self.value()?))).collect();
        let primitive = build(name, &arguments?).map_err(|error| error.to_string())?;
        Ok(primitive.into())
    }

    fn value(&mut self) -> Result<Value, String> {
        Ok(match self.byte()? {
            b'n' => Value::Number(self.numbers(1)?[0]),
            b'v' => {
                let count = self.count()?;
                Value::Vector(self.numbers(count)?)
            }
            b'r' => {
                let rows = self.count()?;
                let row = |_| {
                    let count = self.count()?;
                    self.numbers(count)
                };
                Value::Rows((0..rows).map(row).collect::<Result<_, String>>()?)
            }
            _ => return Err(cut()),
        })
    }
}
