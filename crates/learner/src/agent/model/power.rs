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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_power_is_a_product_of_squares_to_the_bit() {
        assert_eq!([0, 1, 2, 5].map(|n| power(3.0, n)), [1.0, 3.0, 9.0, 243.0]);
        assert_eq!(power(0.5, 1000), f64::from_bits(23 << 52));
        let (one, two) = (0.7_f64, 0.7 * 0.7);
        let four = two * two;
        assert_eq!(power(one, 7).to_bits(), (one * two * four).to_bits());
        let in_a_row: f64 = [one; 7].iter().product();
        assert_ne!(power(one, 7), in_a_row, "control: the order matters");
    }
}
