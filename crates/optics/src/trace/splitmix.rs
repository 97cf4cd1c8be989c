//! SplitMix64: keys of random numbers.

/// Mixes the bits of a key (the finaliser of SplitMix64: Steele, Lea, Flood, OOPSLA 2014).
pub(crate) fn splitmix64(key: u64) -> u64 {
    let a = key.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let b = (a ^ (a >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let c = (b ^ (b >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    c ^ (c >> 31)
}
