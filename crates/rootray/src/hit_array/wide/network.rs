//! Sorting networks (Batcher's odd-even merge): sequences of compare-exchange steps that sort rows.

/// A compare-exchange step: the lesser numbers go to the first row, the greater ones to the second.
pub(super) type Exchange = (usize, usize);

/// A comparator network over rows.
#[derive(Clone, Debug, Default)]
pub(super) struct Network {
    /// Compare-exchange steps, in order.
    pub exchanges: Vec<Exchange>,
    /// Rows that hold the sorted numbers after the last step, in ascending order.
    pub order: Vec<usize>,
}

/// Wires of a network: the row on each, or `None` for a wire that carries +inf only.
struct Wires {
    rows: Vec<Option<usize>>,
    exchanges: Vec<Exchange>,
}

impl Wires {
    fn new(rows: Vec<Option<usize>>) -> Self {
        Wires { rows, exchanges: Vec::new() }
    }

    /// A comparator between two wires. If one of them carries +inf, it becomes a renaming or nothing.
    fn exchange(&mut self, low: usize, high: usize) {
        match (self.rows[low], self.rows[high]) {
            (Some(low), Some(high)) => self.exchanges.push((low, high)),
            (None, Some(_)) => self.rows.swap(low, high),
            (_, None) => (),
        }
    }

    /// Batcher's odd-even merge ("Sorting networks and their applications", 1968) of the sorted halves of
    /// `2 * half` wires from `first` on; `half` is a power of two.
    fn merge(&mut self, first: usize, half: usize) {
        (first..first + half).for_each(|low| self.exchange(low, low + half));
        let mut step = half / 2;
        while step > 0 {
            let odd = (step..2 * half - step).filter(|wire| wire & step != 0);
            odd.for_each(|wire| self.exchange(first + wire, first + wire + step));
            step /= 2;
        }
    }

    fn finish(self) -> Network {
        Network { exchanges: self.exchanges, order: self.rows.into_iter().flatten().collect() }
    }
}

impl Network {
    /// Merges rows 0 to `first` with the `second` rows after them; both groups are sorted.
    pub fn merge(first: usize, second: usize) -> Self {
        let half = first.max(second).next_power_of_two();
        let wire = |count: usize, offset: usize, k: usize| (k < count).then_some(offset + k);
        let lower = (0..half).map(|k| wire(first, 0, k));
        let mut wires = Wires::new(lower.chain((0..half).map(|k| wire(second, first, k))).collect());
        wires.merge(0, half);
        wires.finish()
    }

    /// Sorts `count` rows that consist of sorted groups of `half` rows; `half` is a power of two.
    pub fn sort(count: usize, mut half: usize) -> Self {
        let wide = count.next_power_of_two();
        let mut wires = Wires::new((0..wide).map(|k| (k < count).then_some(k)).collect());
        while half < wide {
            (0..wide).step_by(2 * half).for_each(|first| wires.merge(first, half));
            half *= 2;
        }
        wires.finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Applies a network. A network sorts everything if it sorts all zeros and ones (Knuth, TAOCP 5.3.4,
    /// theorem Z).
    fn run(network: &Network, mut rows: Vec<u32>) -> Vec<u32> {
        for &(low, high) in &network.exchanges {
            (rows[low], rows[high]) = (rows[low].min(rows[high]), rows[low].max(rows[high]));
        }
        network.order.iter().map(|&row| rows[row]).collect()
    }

    fn steps(zeros: usize, ones: usize) -> Vec<u32> {
        [vec![0; zeros], vec![1; ones]].concat()
    }

    #[test]
    fn merges_sort_all_pairs_of_sorted_lists() {
        for (first, second) in (0..20).flat_map(|first| (0..20).map(move |second| (first, second))) {
            let network = Network::merge(first, second);
            for (zeros1, zeros2) in (0..=first).flat_map(|z1| (0..=second).map(move |z2| (z1, z2))) {
                let (ones1, ones2) = (first - zeros1, second - zeros2);
                let rows = [steps(zeros1, ones1), steps(zeros2, ones2)].concat();
                assert_eq!(run(&network, rows), steps(zeros1 + zeros2, ones1 + ones2), "{first} {second}");
            }
        }
    }

    #[test]
    fn sorts_sort_everything() {
        for count in 0..13 {
            let network = Network::sort(count, 1);
            for bits in 0..1_u32 << count {
                let rows: Vec<u32> = (0..count).map(|k| bits >> k & 1).collect();
                let ones = bits.count_ones() as usize;
                assert_eq!(run(&network, rows), steps(count - ones, ones), "{count} {bits:b}");
            }
        }
    }

    #[test]
    fn sorted_groups_are_merged() {
        for count in 0..40 {
            let network = Network::sort(count, 8);
            for bits in 0..9_usize.pow(count.div_ceil(8) as u32) {
                // the number of zeros in each group of eight
                let zeros = |group: u32| bits / 9_usize.pow(group) % 9;
                let rows: Vec<u32> = (0..count).map(|k| u32::from(k % 8 >= zeros(k as u32 / 8))).collect();
                let ones = rows.iter().sum::<u32>() as usize;
                assert_eq!(run(&network, rows), steps(count - ones, ones), "{count} {bits}");
            }
        }
    }

    /// The sizes that Batcher states.
    #[test]
    fn networks_are_as_small_as_they_should_be() {
        let merges = [(1, 1), (2, 3), (4, 9), (8, 25), (16, 65)];
        assert!(merges.iter().all(|&(half, size)| Network::merge(half, half).exchanges.len() == size));
        let sorts = [(2, 1), (3, 3), (4, 5), (8, 19), (16, 63), (32, 191)];
        assert!(sorts.iter().all(|&(count, size)| Network::sort(count, 1).exchanges.len() == size));
    }
}
