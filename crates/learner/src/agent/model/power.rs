//! Powers with the same result on every machine.

/// Returns a power with a whole exponent, by squaring. [`f64::powi`] may round differently on other
/// machines.
pub fn power(base: f64, exponent: u32) -> f64 {
    let (mut product, mut square, mut left) = (1.0, base, exponent);
    while left > 0 {
        if left % 2 == 1 {
            product *= square;
        }
        square *= square;
        left /= 2;
    }
    product
}
