//! The counter-based random numbers Philox4x64-10 of J. K. Salmon, M. A. Moraes, R. O. Dror and D. E. Shaw,
//! Parallel random numbers: as easy as 1, 2, 3, SC '11 (2011): four 64-bit words as a function of a counter
//! and a key, without state.
//!
//! They equal those of `numpy.random.Philox`, so that the sample of a seed can be reproduced.

const ROUNDS: usize = 10;
const MULTIPLIERS: [u64; 2] = [0xD2E7_470E_E14C_6C93, 0xCA5A_8263_9512_1157];
/// The increments of the key in each round: golden ratio and √3, less 1, in units of 2⁻⁶⁴.
const WEYL: [u64; 2] = [0x9E37_79B9_7F4A_7C15, 0xBB67_AE85_84CA_A73B];

/// The four words for a counter and a key.
pub(super) fn philox(mut counter: [u64; 4], mut key: [u64; 2]) -> [u64; 4] {
    for _ in 0..ROUNDS {
        let [a, b, c, d] = counter;
        let [low_a, high_a] = product(MULTIPLIERS[0], a);
        let [low_c, high_c] = product(MULTIPLIERS[1], c);
        counter = [high_c ^ b ^ key[0], low_c, high_a ^ d ^ key[1], low_a];
        key = [key[0].wrapping_add(WEYL[0]), key[1].wrapping_add(WEYL[1])];
    }
    counter
}

/// Lower and upper half of the product of two words.
fn product(a: u64, b: u64) -> [u64; 2] {
    let product = u128::from(a) * u128::from(b);
    [product as u64, (product >> 64) as u64]
}

/// The use of random numbers: numbers for different uses are independent.
#[derive(Debug, Clone, Copy)]
pub(super) enum Use {
    /// Coordinates of points, or positions within a cell.
    Coordinates = 0,
    /// Scrambling of Sobol' points.
    Scrambling = 1,
    /// Permutations.
    Shuffle = 2,
}

/// The random numbers of one axis for one use.
#[derive(Debug, Clone, Copy)]
pub(super) struct Stream {
    key: [u64; 2],
    used_for: Use,
}

impl Stream {
    pub(super) fn new(seed: u64, axis: usize, used_for: Use) -> Self {
        Self { key: [seed, axis as u64], used_for }
    }

    /// The four words of a block, numbered by two words.
    pub(super) fn block(&self, number: [u64; 2]) -> [u64; 4] {
        philox([number[0], number[1], 0, self.used_for as u64], self.key)
    }

    /// One word of the sequence of words.
    pub(super) fn word(&self, number: u64) -> u64 {
        self.four_words(number / 4)[(number % 4) as usize]
    }

    /// The sequence of words from its begin.
    pub(super) fn words(self) -> impl Iterator<Item = u64> {
        (0..).flat_map(move |four| self.four_words(four))
    }

    /// The block with four words of the sequence. numpy counts its blocks from 1.
    fn four_words(&self, number: u64) -> [u64; 4] {
        self.block([number + 1, 0])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// numpy 2.4.6: `numpy.random.Philox(key=[7, 3]).random_raw(6)`.
    #[test]
    fn words_are_those_of_numpy() {
        let known: [u64; 6] = [
            0x7b6c_c7b1_862c_c5f2,
            0xb960_f2ea_4b3f_8d9f,
            0x0cdd_72e0_15de_b1a6,
            0x50ed_b0d2_2a6a_6fd5,
            0xae45_891b_f7ab_4df3,
            0x3200_5aae_5c70_0f2c,
        ];
        let stream = Stream::new(7, 3, Use::Coordinates);
        assert!(stream.words().take(6).eq(known));
        assert!((0..6).map(|number| stream.word(number)).eq(known));
    }

    /// numpy 2.4.6: `numpy.random.Philox(key=[2**64 - 1, 5], counter=[2**64 - 1, 2, 0, 1])
    /// .random_raw(4)`, whose first block has the counter [0, 3, 0, 1].
    #[test]
    fn blocks_are_those_of_numpy() {
        let known: [u64; 4] = [
            0xd556_0343_0b70_9c1c,
            0x2905_f672_5a22_846e,
            0x5f86_f851_ef08_588d,
            0x9526_de84_2ba7_a5cb,
        ];
        assert_eq!(Stream::new(u64::MAX, 5, Use::Scrambling).block([0, 3]), known);
    }
}
