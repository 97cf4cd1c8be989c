//! Numbers of texts.

use std::collections::HashMap;
use std::sync::Arc;

/// The distinct texts of a list, numbered in the order in which they were added.
///
/// Texts that share memory are mostly known by their addresses, without a look at their letters.
#[derive(Clone, Debug, Default)]
pub struct TextIds {
    list: Vec<Arc<str>>,
    ids: HashMap<Arc<str>, u32>,
    /// The last texts by address, each with its number. They are kept, so that no other text gets their addresses.
    recent: Vec<Option<(Arc<str>, u32)>>,
}

/// The number of places for recent texts per text of the list: the threads of a run have copies of their own.
const RECENT: usize = 4;

impl TextIds {
    /// The texts by number.
    #[must_use]
    pub fn texts(&self) -> &[Arc<str>] {
        &self.list
    }

    /// The number of a text, which is added if it is new.
    #[inline]
    pub fn id(&mut self, text: &Arc<str>) -> u32 {
        match self.recent.get(self.place(text)) {
            Some(Some((known, id))) if Arc::ptr_eq(known, text) => *id,
            _ => self.find(text),
        }
    }

    /// The place of a text among the recent ones: the upper bits of a product spread addresses, which are multiples of a power of two.
    fn place(&self, text: &Arc<str>) -> usize {
        let address = Arc::as_ptr(text).cast::<u8>().addr() as u64;
        (address.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 32) as usize & self.recent.len().wrapping_sub(1)
    }

    fn find(&mut self, text: &Arc<str>) -> u32 {
        let next = self.list.len() as u32;
        let id = *self.ids.entry(text.clone()).or_insert(next);
        if id == next {
            self.list.push(text.clone());
        }
        if self.recent.len() < RECENT * self.list.len() {
            self.recent = vec![None; (2 * RECENT * self.list.len()).next_power_of_two()];
        }
        let place = self.place(text);
        self.recent[place] = Some((text.clone(), id));
        id
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Equal texts have one number, whether they share memory or not, also where there are more texts than addresses kept.
    #[test]
    fn equal_texts_have_one_number() {
        let mut ids = TextIds::default();
        for round in 0..20 {
            let texts: Vec<Arc<str>> = (0..500).map(|k| format!("tube[{}]", k % 250).into()).collect();
            for (k, text) in texts.iter().enumerate() {
                assert_eq!(ids.id(text), k as u32 % 250, "{round}");
                assert_eq!(ids.id(&text.clone()), k as u32 % 250, "{round}");
            }
        }
        assert_eq!(ids.texts().len(), 250);
        assert!(ids.texts().iter().enumerate().all(|(k, text)| **text == format!("tube[{k}]")));
        assert!(ids.recent.len() <= 2048, "{}", ids.recent.len());
    }
}
