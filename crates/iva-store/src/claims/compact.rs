//! Reader of Thrift's compact protocol, in which Parquet writes the headers of its pages, for the whole
//! numbers that state the sizes of a page.

/// Depth at which nested structures are refused.
const MOST_DEPTH: usize = 16;

// Type codes of the protocol; 4 to 6 are the whole numbers i16, i32 and i64.
const TRUE: u8 = 1;
const FALSE: u8 = 2;
const BYTE: u8 = 3;
const DOUBLE: u8 = 7;
const BINARY: u8 = 8;
const LIST: u8 = 9;
const SET: u8 = 10;
const MAP: u8 = 11;
const STRUCT: u8 = 12;

/// A reader of bytes in the compact protocol.
pub(super) struct Compact<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Compact<'a> {
    /// A reader at the first byte.
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, at: 0 }
    }

    /// Number of bytes read so far.
    pub(super) fn read(&self) -> usize {
        self.at
    }

    /// Reads a structure and passes each of its whole numbers to `found`, with the path of field numbers that
    /// leads to it; `None` if the bytes are not a valid structure.
    pub(super) fn structure(&mut self, found: &mut dyn FnMut(&[i64], i64)) -> Option<()> {
        self.fields(&mut Vec::new(), found)
    }

    /// Reads the fields of a structure up to its end.
    fn fields(&mut self, path: &mut Vec<i64>, found: &mut dyn FnMut(&[i64], i64)) -> Option<()> {
        if path.len() >= MOST_DEPTH {
            return None;
        }
        let mut number = 0i64;
        loop {
            let head = self.byte()?;
            if head == 0 {
                return Some(());
            }
            number = match head >> 4 {
                0 => self.whole()?,
                step => number.checked_add(i64::from(step))?,
            };
            path.push(number);
            self.value(head & 0x0f, path, found)?;
            path.pop();
        }
    }

    /// Reads a value of a type code.
    fn value(
        &mut self,
        kind: u8,
        path: &mut Vec<i64>,
        found: &mut dyn FnMut(&[i64], i64),
    ) -> Option<()> {
        match kind {
            TRUE | FALSE => Some(()),
            BYTE => self.skip(1),
            4..=6 => {
                let value = self.whole()?;
                found(path, value);
                Some(())
            }
            DOUBLE => self.skip(8),
            BINARY => {
                let length = self.varint()?;
                self.skip(length)
            }
            LIST | SET => {
                let head = self.byte()?;
                let length = if head >> 4 == 15 { self.varint()? } else { u64::from(head >> 4) };
                self.items(length, &[head & 0x0f], path, found)
            }
            MAP => match self.varint()? {
                0 => Some(()),
                length => {
                    let kinds = self.byte()?;
                    self.items(length, &[kinds >> 4, kinds & 0x0f], path, found)
                }
            },
            STRUCT => self.fields(path, found),
            _ => None,
        }
    }

    /// Reads the items of a list, set or map, of which each has values of the types `kinds`.
    fn items(
        &mut self,
        length: u64,
        kinds: &[u8],
        path: &mut Vec<i64>,
        found: &mut dyn FnMut(&[i64], i64),
    ) -> Option<()> {
        if path.len() >= MOST_DEPTH || length > self.left() {
            return None;
        }
        for _ in 0..length {
            for kind in kinds {
                // In a collection a boolean is a byte, not part of the type code.
                path.push(-1);
                self.value(if *kind <= FALSE { BYTE } else { *kind }, path, found)?;
                path.pop();
            }
        }
        Some(())
    }

    /// Number of bytes not read yet.
    fn left(&self) -> u64 {
        (self.bytes.len() - self.at) as u64
    }

    fn byte(&mut self) -> Option<u8> {
        let byte = *self.bytes.get(self.at)?;
        self.at += 1;
        Some(byte)
    }

    fn skip(&mut self, length: u64) -> Option<()> {
        if length > self.left() {
            return None;
        }
        self.at += length as usize;
        Some(())
    }

    /// Reads an unsigned number of variable length, seven bits a byte.
    fn varint(&mut self) -> Option<u64> {
        let mut value = 0u64;
        for shift in (0..64).step_by(7) {
            let byte = self.byte()?;
            value |= u64::from(byte & 0x7f).checked_shl(shift)?;
            if byte & 0x80 == 0 {
                return Some(value);
            }
        }
        None
    }

    /// Reads a signed number in zigzag coding, with the sign in the last bit.
    fn whole(&mut self) -> Option<i64> {
        let value = self.varint()?;
        Some((value >> 1) as i64 ^ -((value & 1) as i64))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn numbers(bytes: &[u8]) -> Option<Vec<(Vec<i64>, i64)>> {
        let mut all = Vec::new();
        Compact::new(bytes).structure(&mut |path, value| all.push((path.to_vec(), value)))?;
        Some(all)
    }

    // The bytes are written by hand from the specification of the protocol.
    #[test]
    fn whole_numbers_come_with_their_fields() {
        // 1: i32 3, 5: struct { 1: i32 −1 }, then a binary of two bytes.
        let bytes = [0x15, 6, 0x4c, 0x15, 1, 0, 0x18, 2, 7, 7, 0];
        assert_eq!(numbers(&bytes), Some(vec![(vec![1], 3), (vec![5, 1], -1)]));
    }

    #[test]
    fn nothing_longer_than_the_bytes_is_believed() {
        for bytes in [
            &[0x18, 0xff, 0xff, 0xff, 0x7f, 0][..],
            &[0x19, 0xf5, 0xff, 0xff, 0x7f, 0],
            &[0x1b, 0xff, 0x7f, 0x55, 0],
            &[0x1c; 100],
            &[0x19; 100],
            &[0x15],
            &[0x1f, 0],
            &[],
        ] {
            assert_eq!(numbers(bytes), None, "{bytes:?}");
        }
    }
}
