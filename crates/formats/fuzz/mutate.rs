//! New inputs from old ones: bytes, words, numbers, lines and brackets are changed, moved, repeated and taken from elsewhere.

use rand::RngExt;
use rand_pcg::Pcg64Mcg;

/// What a format is written in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Syntax {
    Text,
    Binary,
}

/// Longest input that is made, bytes.
const LONGEST: usize = 1 << 17;
/// Numbers at which programs stumble.
const NUMBERS: &str = "0 -0 1 -1 2 0.5 1e-300 1e300 -1e300 1e308 1e999 -1e999 nan NaN inf -inf Infinity -Infinity null \
    true 255 256 65535 65536 2147483647 2147483648 4294967295 4294967296 9007199254740993 \
    9223372036854775807 -9223372036854775808 18446744073709551615 18446744073709551616 1e19 1000000 \
    16384 16385 0x10 1_000 007";
/// What structure is made of, in any of the texts.
const MARKS: &str = "[ ] { } ( ) \" ' \\ \n \r\n \t \u{0} \u{1b}[31m \u{7f} \u{202e} ü \u{feff} < > &lt; &#0; , : ; = # - . .. % ${ $ \
    \"\"";

/// Makes inputs for one target.
pub(crate) struct Mutator {
    syntax: Syntax,
    words: Vec<Vec<u8>>,
}

impl Mutator {
    /// The words are those given, and those of the seeds.
    pub(crate) fn new(syntax: Syntax, words: &str, seeds: &[Vec<u8>]) -> Self {
        let words = words.split('¦').filter(|word| !word.is_empty());
        let mut all: Vec<Vec<u8>> = words.map(|word| word.as_bytes().to_vec()).collect();
        if syntax == Syntax::Text {
            let is_word = |byte: &u8| byte.is_ascii_alphanumeric() || matches!(byte, b'_' | b'-' | b'.');
            let found = seeds.iter().flat_map(|seed| seed.split(move |byte| !is_word(byte)));
            all.extend(found.filter(|word| (2..40).contains(&word.len())).map(<[u8]>::to_vec));
            all.extend(NUMBERS.split(' ').chain(MARKS.split(' ')).map(|word| word.as_bytes().to_vec()));
            all.sort();
            all.dedup();
        }
        Self { syntax, words: all }
    }

    /// One to six changes; most inputs get few.
    pub(crate) fn mutate(&self, from: &[u8], other: &[u8], random: &mut Pcg64Mcg) -> Vec<u8> {
        let mut bytes = from.to_vec();
        let changes = 1 + [0, 0, 0, 1, 1, 2, 3, 5][random.random_range(0..8)];
        for _ in 0..changes {
            self.change(&mut bytes, other, random);
            bytes.truncate(LONGEST);
        }
        bytes
    }

    fn change(&self, bytes: &mut Vec<u8>, other: &[u8], random: &mut Pcg64Mcg) {
        // Most changes of a text leave it one of its format: else every case would end in the parser.
        if self.syntax == Syntax::Text && random.random_range(0..10) < 7 {
            match random.random_range(0..12) {
                0..=2 => replace_number(bytes, random),
                3..=4 => change_digit(bytes, random),
                5..=6 => replace_token(bytes, &self.word(random), random),
                7..=8 => lines(bytes, random),
                _ => brackets(bytes, other, random),
            }
            return;
        }
        match random.random_range(0..10) {
            0 | 1 => set_byte(bytes, random),
            2 => insert(bytes, &self.word(random), random),
            3 => drop(bytes.drain(part(bytes, random))),
            4 => {
                let piece = if random.random() {
                    bytes[part(bytes, random)].to_vec()
                } else {
                    other[part(other, random)].to_vec()
                };
                insert(bytes, &piece, random);
            }
            5 => {
                // The head of one, the tail of the other.
                let tail = &other[place(other, random)..];
                bytes.truncate(place(bytes, random));
                bytes.extend_from_slice(tail);
            }
            6 => bytes.truncate(place(bytes, random)),
            7 => repeat(bytes, random),
            8 => set_number_of_bytes(bytes, random),
            _ => {
                let range = part(bytes, random);
                bytes.splice(range, self.word(random));
            }
        }
    }

    fn word(&self, random: &mut Pcg64Mcg) -> Vec<u8> {
        if self.words.is_empty() {
            return vec![random.random()];
        }
        self.words[random.random_range(0..self.words.len())].clone()
    }
}

fn place(bytes: &[u8], random: &mut Pcg64Mcg) -> usize {
    random.random_range(0..=bytes.len())
}

/// A part of an input, short ones more often than long ones.
fn part(bytes: &[u8], random: &mut Pcg64Mcg) -> std::ops::Range<usize> {
    let from = place(bytes, random);
    let most = (bytes.len() - from).min([4, 16, 64, 4096][random.random_range(0..4)]);
    from..from + random.random_range(0..=most)
}

fn insert(bytes: &mut Vec<u8>, what: &[u8], random: &mut Pcg64Mcg) {
    let at = place(bytes, random);
    bytes.splice(at..at, what.iter().copied());
}

fn set_byte(bytes: &mut [u8], random: &mut Pcg64Mcg) {
    if bytes.is_empty() {
        return;
    }
    let at = random.random_range(0..bytes.len());
    bytes[at] = match random.random_range(0..4) {
        0 => bytes[at] ^ (1 << random.random_range(0..8)),
        1 => [0, 1, 0x7F, 0x80, 0xFF, 0x1B][random.random_range(0..6)],
        2 => bytes[at].wrapping_add([1, 255][random.random_range(0..2)]),
        _ => random.random(),
    };
}

/// Two, four or eight bytes become a number at a limit, in either order.
fn set_number_of_bytes(bytes: &mut [u8], random: &mut Pcg64Mcg) {
    const LIMITS: [u64; 16] = [
        0,
        1,
        2,
        7,
        0x7F,
        0xFF,
        0x7FFF,
        0xFFFF,
        0x1_0000,
        0x4001,
        0x7FFF_FFFF,
        0x8000_0000,
        0xFFFF_FFFF,
        1 << 32,
        i64::MAX as u64,
        u64::MAX,
    ];
    let length = [2, 4, 8][random.random_range(0..3)].min(bytes.len());
    let at = random.random_range(0..=bytes.len() - length);
    let number = LIMITS[random.random_range(0..LIMITS.len())];
    let encoded = number.to_le_bytes();
    bytes[at..at + length].copy_from_slice(&encoded[..length]);
    if random.random() {
        bytes[at..at + length].reverse();
    }
}

/// A part stands there many times over.
fn repeat(bytes: &mut Vec<u8>, random: &mut Pcg64Mcg) {
    let range = part(bytes, random);
    let count = [2, 10, 100, 2000][random.random_range(0..4)];
    let most = LONGEST.saturating_sub(bytes.len()) / range.len().max(1);
    let copies = bytes[range.clone()].repeat(count.min(most));
    bytes.splice(range.end..range.end, copies);
}

/// The first run of such bytes behind a place anywhere, else the first of all.
fn token(bytes: &[u8], random: &mut Pcg64Mcg, is_one: fn(u8) -> bool) -> Option<std::ops::Range<usize>> {
    let behind = place(bytes, random);
    let from = |start: usize| Some(start + bytes.get(start..)?.iter().position(|&byte| is_one(byte))?);
    let start = from(behind).or_else(|| from(0))?;
    let length = bytes[start..].iter().position(|&byte| !is_one(byte)).unwrap_or(bytes.len() - start);
    Some(start..start + length)
}

fn replace_token(bytes: &mut Vec<u8>, word: &[u8], random: &mut Pcg64Mcg) {
    let is_word = |byte: u8| byte.is_ascii_alphanumeric() || matches!(byte, b'_' | b'-' | b'.');
    if let Some(range) = token(bytes, random, is_word) {
        bytes.splice(range, word.iter().copied());
    }
}

fn replace_number(bytes: &mut Vec<u8>, random: &mut Pcg64Mcg) {
    let is_number = |byte: u8| byte.is_ascii_digit() || matches!(byte, b'.' | b'-' | b'+' | b'e');
    if let Some(range) = token(bytes, random, is_number) {
        let count = NUMBERS.split(' ').count();
        let number = NUMBERS.split(' ').nth(random.random_range(0..count)).unwrap_or_default();
        bytes.splice(range, number.bytes());
    }
}

/// One digit becomes another: the number stays one.
fn change_digit(bytes: &mut [u8], random: &mut Pcg64Mcg) {
    if let Some(range) = token(bytes, random, |byte| byte.is_ascii_digit()) {
        bytes[range.start] = b'0' + random.random_range(0..10);
    }
}

/// A line goes, comes twice, or changes places with another.
fn lines(bytes: &mut Vec<u8>, random: &mut Pcg64Mcg) {
    let mut lines: Vec<Vec<u8>> = bytes.split_inclusive(|&byte| byte == b'\n').map(<[u8]>::to_vec).collect();
    if lines.is_empty() {
        return;
    }
    let [a, b] = [0; 2].map(|_| random.random_range(0..lines.len()));
    match random.random_range(0..3) {
        0 => drop(lines.remove(a)),
        1 => {
            let copy = lines[a].clone();
            lines.insert(b, copy);
        }
        _ => lines.swap(a, b),
    }
    *bytes = lines.concat();
}

/// From an opening bracket to the one that closes it.
fn group(bytes: &[u8], random: &mut Pcg64Mcg) -> Option<std::ops::Range<usize>> {
    let start = token(bytes, random, |byte| matches!(byte, b'[' | b'{' | b'<' | b'('))?.start;
    let mut depth = 0_usize;
    for (at, byte) in bytes.iter().enumerate().skip(start) {
        match byte {
            b'[' | b'{' | b'<' | b'(' => depth += 1,
            b']' | b'}' | b'>' | b')' => depth = depth.saturating_sub(1),
            _ => {}
        }
        if depth == 0 {
            return Some(start..at + 1);
        }
    }
    None
}

/// A bracket and all that is in it goes, is nested, or becomes another one.
fn brackets(bytes: &mut Vec<u8>, other: &[u8], random: &mut Pcg64Mcg) {
    let Some(range) = group(bytes, random) else { return };
    match random.random_range(0..4) {
        0 => drop(bytes.drain(range)),
        1 => {
            let (open, close) = (bytes[range.start], bytes[range.end - 1]);
            let depth = [1, 2, 40, 3000][random.random_range(0..4)];
            bytes.splice(range.end..range.end, vec![close; depth]);
            bytes.splice(range.start..range.start, vec![open; depth]);
        }
        2 => {
            if let Some(piece) = group(other, random) {
                bytes.splice(range, other[piece].iter().copied());
            }
        }
        _ => {
            let copy = [&b","[..], &bytes[range.clone()]].concat();
            bytes.splice(range.end..range.end, copy);
        }
    }
}
