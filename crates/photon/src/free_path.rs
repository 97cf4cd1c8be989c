//! Free paths in a material.

/// The shortest of two free paths and its process, from their mean lengths and exponentially distributed numbers of mean 1.
#[inline]
pub(crate) fn shortest<P>(means: impl Iterator<Item = (f64, P)>, exponentials: [f64; 2]) -> (f64, Option<P>) {
    let mut found = (f64::INFINITY, None);
    for ((mean, process), exponential) in means.zip(exponentials) {
        let length = mean * exponential;
        if length < found.0 {
            found = (length, Some(process));
        }
    }
    found
}
