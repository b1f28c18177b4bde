//! Baseline JPEG (ITU-T T.81) to its planes, as Motion JPEG has it.
//!
//! The pictures' decoder spreads chroma smoothly before it gives colours, ffmpeg and OpenCV do not: at a sharp edge of a
//! colour that is twenty grey levels. So the common kind is decoded here: three components, chroma once a block of up to
//! 2 × 2, sides that are whole blocks of chroma, one scan. What is not of that kind is `None`, and the pictures'
//! decoder's affair.

use super::yuv::{Colour, Planes};

/// Most bits of a code that are looked up at once.
const LOOKUP_BITS: u32 = 9;
/// Most pixels that are decoded here.
const MAX_PIXELS: usize = 64 << 20;
/// Places of the 64 coefficients in the order in which they are coded (T.81, figure A.6).
const ZIGZAG: [u8; 64] = [
    0, 1, 8, 16, 9, 2, 3, 10, 17, 24, 32, 25, 18, 11, 4, 5, 12, 19, 26, 33, 40, 48, 41, 34, 27, 20, 13, 6, 7,
    14, 21, 28, 35, 42, 49, 56, 57, 50, 43, 36, 29, 22, 15, 23, 30, 37, 44, 51, 58, 59, 52, 45, 38, 31, 39,
    46, 53, 60, 61, 54, 47, 55, 62, 63,
];

/// The planes of a picture of the size that is expected; `None` for kinds that are not decoded here.
pub(super) fn planes(bytes: &[u8], size: [usize; 2]) -> Result<Option<Planes>, String> {
    if size[0] * size[1] > MAX_PIXELS {
        return Ok(None);
    }
    let Some((tables, scan)) = Tables::read(bytes, size) else { return Ok(None) };
    tables.decode(scan, size).map(Some)
}

/// One component of the picture.
#[derive(Debug, Clone, Copy, Default)]
struct Component {
    id: u8,
    /// Blocks of a unit, across and down.
    blocks: [usize; 2],
    quantisation: usize,
    dc: usize,
    ac: usize,
}

#[derive(Debug, Default)]
struct Tables {
    quantisation: [Option<[f32; 64]>; 4],
    dc: [Option<Huffman>; 4],
    ac: [Option<Huffman>; 4],
    components: [Component; 3],
    /// Units after which a marker comes; 0 for none.
    restart: usize,
}

impl Tables {
    /// Everything up to the scan's data, and these.
    fn read(bytes: &[u8], size: [usize; 2]) -> Option<(Self, &[u8])> {
        let mut tables = Self::default();
        let mut rest = bytes.strip_prefix(&[0xFF, 0xD8])?;
        let mut has_frame = false;
        loop {
            let (&[0xFF, marker], after) = rest.split_first_chunk()? else { return None };
            if marker == 0xFF {
                rest = &rest[1..];
                continue;
            }
            let length = usize::from(u16::from_be_bytes(*after.first_chunk()?));
            let body = after.get(2..length)?;
            rest = after.get(length..)?;
            match marker {
                0xDB => tables.quantisation(body)?,
                0xC4 => tables.huffman(body)?,
                0xC0 | 0xC1 => has_frame = tables.frame(body, size)?,
                // Other kinds of coding; colours that are not luma and chroma.
                0xC2..=0xCF => return None,
                0xEE if body.starts_with(b"Adobe") && body.get(11) != Some(&1) => return None,
                0xDD => tables.restart = usize::from(u16::from_be_bytes(*body.first_chunk()?)),
                0xDA if has_frame => {
                    tables.scan(body)?;
                    return Some((tables, rest));
                }
                0xDA => return None,
                _ => {}
            }
        }
    }

    fn quantisation(&mut self, mut body: &[u8]) -> Option<()> {
        while let Some((&head, rest)) = body.split_first() {
            let bytes = 1 + usize::from(head >> 4 != 0);
            let values = rest.get(..64 * bytes)?;
            body = &rest[64 * bytes..];
            let mut table = [0.0; 64];
            for (value, &place) in values.chunks_exact(bytes).zip(&ZIGZAG) {
                table[usize::from(place)] =
                    value.iter().fold(0.0, |sum, &byte| sum * 256.0 + f32::from(byte));
            }
            *self.quantisation.get_mut(usize::from(head & 15))? = Some(table);
        }
        Some(())
    }

    fn huffman(&mut self, mut body: &[u8]) -> Option<()> {
        while let Some((&head, rest)) = body.split_first() {
            let (counts, rest) = rest.split_first_chunk::<16>()?;
            let count = counts.iter().map(|&count| usize::from(count)).sum();
            let table = Huffman::new(counts, rest.get(..count)?)?;
            body = &rest[count..];
            let kind = if head >> 4 == 0 { &mut self.dc } else { &mut self.ac };
            *kind.get_mut(usize::from(head & 15))? = Some(table);
        }
        Some(())
    }

    fn frame(&mut self, body: &[u8], [width, height]: [usize; 2]) -> Option<bool> {
        let &[8, h1, h0, w1, w0, 3, ref components @ ..] = body else { return None };
        let found = [[w1, w0], [h1, h0]].map(|side| usize::from(u16::from_be_bytes(side)));
        for (component, &[id, blocks, table]) in self.components.iter_mut().zip(components.as_chunks::<3>().0)
        {
            let blocks = [usize::from(blocks >> 4), usize::from(blocks & 15)];
            *component = Component { id, blocks, quantisation: usize::from(table), ..Component::default() };
        }
        let shift = self.shift()?;
        let whole = width.is_multiple_of(1 << shift[0]) && height.is_multiple_of(1 << shift[1]);
        let is_rgb = self.components.map(|component| component.id) == *b"RGB";
        (found == [width, height] && whole && !is_rgb).then_some(true)
    }

    /// log2 of luma samples per chroma sample, across and down, if these are 1 or 2.
    fn shift(&self) -> Option<[u32; 2]> {
        let [luma, u, v] = self.components.map(|component| component.blocks);
        let shift = |k: usize| match (luma[k], u[k]) {
            (1..=4, chroma) if chroma == luma[k] => Some(0),
            (2 | 4, chroma) if 2 * chroma == luma[k] => Some(1),
            _ => None,
        };
        if u == v { Some([shift(0)?, shift(1)?]) } else { None }
    }

    fn scan(&mut self, body: &[u8]) -> Option<()> {
        let &[3, ref components @ ..] = body else { return None };
        let (components, _) = components.as_chunks::<2>();
        for (component, &[id, tables]) in self.components.iter_mut().zip(components.get(..3)?) {
            if component.id != id {
                return None;
            }
            (component.dc, component.ac) = (usize::from(tables >> 4), usize::from(tables & 15));
        }
        let has = |component: &Component| {
            self.quantisation.get(component.quantisation)?.as_ref()?;
            self.dc.get(component.dc)?.as_ref()?;
            self.ac.get(component.ac)?.as_ref()
        };
        self.components.iter().all(|component| has(component).is_some()).then_some(())
    }

    fn decode(&self, scan: &[u8], size: [usize; 2]) -> Result<Planes, String> {
        let luma = self.components[0].blocks;
        let units = [0, 1].map(|k| size[k].div_ceil(8 * luma[k]));
        let strides = self.components.map(|component| units[0] * component.blocks[0] * 8);
        let mut planes: [Vec<u8>; 3] =
            [0, 1, 2].map(|k| vec![0; strides[k] * units[1] * self.components[k].blocks[1] * 8]);
        let mut bits = Bits::new(scan);
        let mut before = [0; 3];
        for unit in 0..units[0] * units[1] {
            if self.restart > 0 && unit > 0 && unit.is_multiple_of(self.restart) {
                bits.restart().ok_or("a restart marker is missing")?;
                before = [0; 3];
            }
            for (k, component) in self.components.iter().enumerate() {
                for block in 0..component.blocks[0] * component.blocks[1] {
                    let coefficients = self.block(&mut bits, component, &mut before[k]);
                    let samples = inverse_cosine(coefficients.ok_or("its data are damaged")?);
                    let x = unit % units[0] * component.blocks[0] + block % component.blocks[0];
                    let y = unit / units[0] * component.blocks[1] + block / component.blocks[0];
                    for (row, samples) in samples.iter().enumerate() {
                        let at = (y * 8 + row) * strides[k] + x * 8;
                        planes[k][at..at + 8].copy_from_slice(samples);
                    }
                }
            }
        }
        let shift = self.shift().unwrap_or_default();
        let sizes =
            [size, [size[0] >> shift[0], size[1] >> shift[1]], [size[0] >> shift[0], size[1] >> shift[1]]];
        let cropped = [0, 1, 2].map(|k| {
            let rows = planes[k].chunks_exact(strides[k]).take(sizes[k][1]);
            rows.flat_map(|row| &row[..sizes[k][0]]).copied().collect()
        });
        let colour = Colour { matrix: 5, full_range: true };
        Ok(Planes { size, planes: cropped, shift, colour })
    }

    /// A block's coefficients, with their factors.
    fn block(&self, bits: &mut Bits<'_>, component: &Component, before: &mut i32) -> Option<[f32; 64]> {
        let factors = self.quantisation[component.quantisation].as_ref()?;
        let mut block = [0.0; 64];
        let size = bits.code(self.dc[component.dc].as_ref()?)?;
        *before = before.wrapping_add(bits.value(size)?);
        block[0] = *before as f32 * factors[0];
        let ac = self.ac[component.ac].as_ref()?;
        let mut k = 1;
        while k < 64 {
            let code = bits.code(ac)?;
            let (zeros, size) = (usize::from(code >> 4), code & 15);
            if size == 0 && zeros < 15 {
                break;
            }
            k += zeros;
            let place = usize::from(*ZIGZAG.get(k)?);
            block[place] = bits.value(size)? as f32 * factors[place];
            k += 1;
        }
        Some(block)
    }
}

/// Codes of 1 to 16 bits (T.81, annex C).
#[derive(Debug)]
struct Huffman {
    /// By the next [`LOOKUP_BITS`] bits: the code's length (0: longer) and value.
    short: Vec<(u8, u8)>,
    /// By length: the first code that is longer, filled up to 16 bits.
    ends: [u32; 17],
    /// By length: what is added to a code to get the place of its value.
    shifts: [i32; 17],
    values: Vec<u8>,
}

impl Huffman {
    fn new(counts: &[u8; 16], values: &[u8]) -> Option<Self> {
        let mut table = Self {
            short: vec![(0, 0); 1 << LOOKUP_BITS],
            ends: [0; 17],
            shifts: [0; 17],
            values: values.to_vec(),
        };
        let (mut code, mut place) = (0_u32, 0_usize);
        for (length, &count) in (1_u32..).zip(counts) {
            table.shifts[length as usize] = place as i32 - code as i32;
            for &value in values.get(place..place + usize::from(count))? {
                if length <= LOOKUP_BITS {
                    let free = LOOKUP_BITS - length;
                    let from = (code << free) as usize;
                    table.short.get_mut(from..from + (1 << free))?.fill((length as u8, value));
                }
                code += 1;
            }
            if code > 1 << length {
                return None;
            }
            place += usize::from(count);
            table.ends[length as usize] = code << (16 - length);
            code <<= 1;
        }
        Some(table)
    }
}

/// Bits of a scan, without stuffed zeros, up to the next marker; zeros after it.
struct Bits<'a> {
    rest: &'a [u8],
    held: u64,
    count: u32,
    /// Bits that were made up.
    beyond: u32,
}

impl<'a> Bits<'a> {
    fn new(rest: &'a [u8]) -> Self {
        Self { rest, held: 0, count: 0, beyond: 0 }
    }

    /// The next 16 bits.
    fn peek(&mut self) -> u32 {
        while self.count <= 48 {
            let byte = match *self.rest {
                [0xFF, 0, ref rest @ ..] => {
                    self.rest = rest;
                    0xFF
                }
                [0xFF, ..] | [] => {
                    self.beyond += 8;
                    0
                }
                [byte, ref rest @ ..] => {
                    self.rest = rest;
                    byte
                }
            };
            self.held = self.held << 8 | u64::from(byte);
            self.count += 8;
        }
        (self.held >> (self.count - 16)) as u32 & 0xFFFF
    }

    /// Takes bits off; `None` once they were made up.
    fn skip(&mut self, bits: u32) -> Option<()> {
        self.count -= bits;
        (self.beyond <= self.count).then_some(())
    }

    fn code(&mut self, table: &Huffman) -> Option<u8> {
        let next = self.peek();
        let (length, value) = table.short[(next >> (16 - LOOKUP_BITS)) as usize];
        if length > 0 {
            self.skip(u32::from(length))?;
            return Some(value);
        }
        let length = (LOOKUP_BITS + 1..=16).find(|&length| next < table.ends[length as usize])?;
        self.skip(length)?;
        let place = (next >> (16 - length)) as i32 + table.shifts[length as usize];
        table.values.get(usize::try_from(place).ok()?).copied()
    }

    /// A number of `size` bits (T.81, F.2.2.1): those with a leading 0 are negative.
    fn value(&mut self, size: u8) -> Option<i32> {
        let size = u32::from(size);
        if size == 0 || size > 15 {
            return (size == 0).then_some(0);
        }
        let bits = (self.peek() >> (16 - size)) as i32;
        self.skip(size)?;
        Some(if bits >> (size - 1) == 0 { bits - (1 << size) + 1 } else { bits })
    }

    /// Goes behind the next restart marker.
    fn restart(&mut self) -> Option<()> {
        let at = self.rest.windows(2).position(|pair| pair[0] == 0xFF && (0xD0..=0xD7).contains(&pair[1]))?;
        *self = Self::new(&self.rest[at + 2..]);
        Some(())
    }
}

/// The inverse cosine transform (T.81, A.3.3), rounded to levels.
fn inverse_cosine(block: [f32; 64]) -> [[u8; 8]; 8] {
    use std::f32::consts::{FRAC_1_SQRT_2, PI};
    static WAVES: std::sync::LazyLock<[[f32; 8]; 8]> = std::sync::LazyLock::new(|| {
        std::array::from_fn(|u| {
            let scale = if u == 0 { FRAC_1_SQRT_2 / 2.0 } else { 0.5 };
            std::array::from_fn(|x| scale * ((2 * x + 1) as f32 * u as f32 * PI / 16.0).cos())
        })
    });
    let waves = &*WAVES;
    let mut across = [[0.0_f32; 8]; 8];
    for (sums, coefficients) in across.iter_mut().zip(block.as_chunks::<8>().0) {
        // Most are 0.
        for (&coefficient, wave) in
            coefficients.iter().zip(waves).filter(|(coefficient, _)| **coefficient != 0.0)
        {
            for (sum, wave) in sums.iter_mut().zip(wave) {
                *sum += coefficient * wave;
            }
        }
    }
    std::array::from_fn(|y| {
        let mut sums = [128.5_f32; 8];
        for (row, wave) in across.iter().zip(waves) {
            for (sum, value) in sums.iter_mut().zip(row) {
                *sum += value * wave[y];
            }
        }
        sums.map(|sum| sum as u8)
    })
}
