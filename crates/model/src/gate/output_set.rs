//! The set of outputs that are inside, as a hierarchical bit set that finds its largest member quickly.

/// A set of integers below a fixed size n. Insertion, removal and the largest member take O(log64 n) time.
#[derive(Clone, Debug, Default)]
pub struct OutputSet {
    /// Level 0 has one bit per integer. Bit k of each higher level is set if word k of the level below is not 0.
    levels: Vec<Vec<u64>>,
}

impl OutputSet {
    /// An empty set for integers below `size`.
    pub fn new(size: usize) -> OutputSet {
        let mut levels = Vec::new();
        let mut words = size.div_ceil(64).max(1);
        loop {
            levels.push(vec![0; words]);
            if words == 1 {
                return OutputSet { levels };
            }
            words = words.div_ceil(64);
        }
    }

    /// Memory of all levels, in bytes.
    pub(super) fn bytes(&self) -> usize {
        self.levels.iter().map(|level| size_of_val(&level[..])).sum()
    }

    /// True if an integer is in the set.
    pub fn get(&self, member: u32) -> bool {
        self.levels[0][member as usize / 64] >> (member % 64) & 1 == 1
    }

    /// Inserts (`present`) or removes an integer.
    pub fn set(&mut self, member: u32, present: bool) {
        let (mut at, mut bit) = (member as usize / 64, 1u64 << (member % 64));
        for level in &mut self.levels {
            let word = &mut level[at];
            let was_empty = *word == 0;
            *word = if present { *word | bit } else { *word & !bit };
            if was_empty == (*word == 0) {
                return;
            }
            (at, bit) = (at / 64, 1u64 << (at % 64));
        }
    }

    /// The largest member plus one; 0 if the set is empty.
    pub fn last(&self) -> u32 {
        let mut at = 0usize;
        for level in self.levels.iter().rev() {
            let word = level[at];
            if word == 0 {
                return 0;
            }
            at = at * 64 + (63 - word.leading_zeros() as usize);
        }
        at as u32 + 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_the_largest_member_for_any_size() {
        for size in [1u32, 64, 65, 5000, 300_000] {
            let mut set = OutputSet::new(size as usize);
            assert_eq!(set.last(), 0);
            let members = [0, size / 3, size / 2, size - 1];
            for &m in &members {
                set.set(m, true);
                assert!(set.get(m));
                assert_eq!(set.last(), m + 1);
            }
            set.set(size - 1, false);
            assert_eq!(set.last(), if size == 1 { 0 } else { size / 2 + 1 });
            members.iter().for_each(|&m| set.set(m, false));
            assert_eq!(set.last(), 0);
        }
    }
}
