//! Small videos of grey JPEG pictures, made here: every frame shows its own number, and every table is as a test wants.

use std::io::Cursor;

use image::codecs::jpeg::JpegEncoder;
use image::{Rgb, RgbImage};

/// Grey level of a frame that has a number.
pub(crate) fn level(number: usize) -> u8 {
    20 + (number * 5) as u8
}

/// Which number a picture shows; the lower right quarter is darker, so that a picture that is turned is told.
pub(crate) fn number_of(picture: &RgbImage) -> usize {
    let level = i32::from(picture.get_pixel(1, 1).0[0]);
    ((level - 20 + 2) / 5) as usize
}

/// A file of cameras of these names and size, which look along z; `lens` is what stands beside the pinhole.
pub(crate) fn cameras(names: &[&str], [width, height]: [u32; 2], focal: u32, lens: &str) -> Vec<u8> {
    let [cx, cy] = [width, height].map(|side| f64::from(side - 1) / 2.0);
    let camera = |name: &&str| {
        format!(
            r#"{{"name": "{name}", "width": {width}, "height": {height}, "fx": {focal}, "fy": {focal}, "cx": {cx}, "cy": {cy}, {lens}
            "rotation": [[1, 0, 0], [0, 1, 0], [0, 0, 1]], "translation": [0, 0, 2]}}"#
        )
    };
    let cameras: Vec<String> = names.iter().map(camera).collect();
    format!(r#"{{"format": "backlit-cameras 1", "cameras": [{}]}}"#, cameras.join(", ")).into_bytes()
}

/// A JPEG that shows a number.
pub(crate) fn jpeg(number: usize, [width, height]: [u32; 2]) -> Vec<u8> {
    let grey = level(number);
    let picture = RgbImage::from_fn(width, height, |x, y| {
        Rgb([if x * 2 >= width && y * 2 >= height { 0 } else { grey }; 3])
    });
    let mut bytes = Cursor::new(Vec::new());
    JpegEncoder::new_with_quality(&mut bytes, 95).encode_image(&picture).unwrap();
    bytes.into_inner()
}

fn chunk(kind: &[u8; 4], body: &[u8]) -> Vec<u8> {
    let mut out = [&kind[..], &(body.len() as u32).to_le_bytes(), body].concat();
    out.resize(out.len().next_multiple_of(2), 0);
    out
}

/// An AVI file of pictures, at 25 frames per second, without `idx1`; the coding by its four letters.
pub(crate) fn avi_of(pictures: &[Vec<u8>], [width, height]: [u32; 2], letters: &[u8; 4]) -> Vec<u8> {
    let words = |words: &[u32]| words.iter().flat_map(|word| word.to_le_bytes()).collect::<Vec<u8>>();
    let count = pictures.len() as u32;
    let strh = [&b"vids"[..], letters, &words(&[0, 0, 0, 1, 25, 0, count, 0, 0, 0, 0, 0])].concat();
    let strf = [&words(&[40, width, height, 24 << 16 | 1])[..], letters, &words(&[0; 5])].concat();
    let strl = [&b"strl"[..], &chunk(b"strh", &strh), &chunk(b"strf", &strf)].concat();
    let hdrl = [&b"hdrl"[..], &chunk(b"avih", &words(&[0; 14])), &chunk(b"LIST", &strl)].concat();
    let pictures: Vec<u8> = pictures.iter().flat_map(|picture| chunk(b"00dc", picture)).collect();
    let movi = [&b"movi"[..], &pictures].concat();
    chunk(b"RIFF", &[&b"AVI "[..], &chunk(b"LIST", &hdrl), &chunk(b"LIST", &movi)].concat())
}

/// An AVI file whose frames show 0, 1, 2, …
pub(crate) fn avi(count: usize, size: [u32; 2]) -> Vec<u8> {
    let pictures: Vec<Vec<u8>> = (0..count).map(|number| jpeg(number, size)).collect();
    avi_of(&pictures, size, b"MJPG")
}

/// What an MP4 file of this module is made of.
pub(crate) struct Mp4 {
    /// Numbers that the samples show, in the order of decoding.
    pub(crate) numbers: Vec<usize>,
    /// Ticks by which each sample is shown later than decoded; none if empty.
    pub(crate) later: Vec<i32>,
    /// How long samples last, ticks of 1/1000 s.
    pub(crate) lasts: Vec<u32>,
    /// Edits: how long in ticks of 1/100 s, and the tick of 1/1000 s at which they begin, −1 for a pause.
    pub(crate) edits: Vec<(u32, i32)>,
    /// a, b, c, d of the matrix.
    pub(crate) matrix: [i32; 4],
    /// The index lies before the pictures.
    pub(crate) index_first: bool,
    pub(crate) letters: [u8; 4],
}

pub(crate) const MP4_SIZE: [u32; 2] = [32, 16];

impl Mp4 {
    pub(crate) fn new(count: usize) -> Self {
        Self {
            numbers: (0..count).collect(),
            later: Vec::new(),
            lasts: vec![40; count],
            edits: Vec::new(),
            matrix: [1, 0, 0, 1],
            index_first: false,
            letters: *b"jpeg",
        }
    }

    pub(crate) fn bytes(&self) -> Vec<u8> {
        let pictures: Vec<Vec<u8>> = self.numbers.iter().map(|&number| jpeg(number, MP4_SIZE)).collect();
        let head = atom(b"ftyp", &[b"isom\0\0\x02\0isom"]);
        let data = atom(b"mdat", &[&pictures.concat()]);
        let index = |from: usize| self.index(&pictures, from);
        if self.index_first {
            let from = head.len() + index(0).len() + 8;
            [head.clone(), index(from), data].concat()
        } else {
            let from = head.len() + 8;
            [head.clone(), data, index(from)].concat()
        }
    }

    /// The `moov` box, where the first sample lies at `from`.
    fn index(&self, pictures: &[Vec<u8>], from: usize) -> Vec<u8> {
        let count = pictures.len() as u32;
        let table = |kind: &[u8; 4], rows: &[u32]| atom(kind, &[&words(&[0]), &words(rows)]);
        let entry = [
            &[0; 24][..],
            &(MP4_SIZE[0] as u16).to_be_bytes(),
            &(MP4_SIZE[1] as u16).to_be_bytes(),
            &[0; 50],
        ];
        let stsd = atom(b"stsd", &[&words(&[0, 1]), &atom(&self.letters, &[&entry.concat()])]);
        let lasts = self.lasts.iter().flat_map(|&lasts| [1, lasts]);
        let stts = table(b"stts", &[vec![count], lasts.collect()].concat());
        let later = self.later.iter().flat_map(|&later| [1, later.cast_unsigned()]);
        let ctts = table(b"ctts", &[vec![self.later.len() as u32], later.collect()].concat());
        let sizes: Vec<u32> = pictures.iter().map(|picture| picture.len() as u32).collect();
        let stsz = table(b"stsz", &[vec![0, count], sizes].concat());
        // Chunks of two samples; the last may hold fewer, which no table has to say.
        let stsc = table(b"stsc", &[1, 1, 2, 1]);
        let mut offsets = vec![count.div_ceil(2)];
        let mut at = from;
        for pair in pictures.chunks(2) {
            offsets.push(at as u32);
            at += pair.iter().map(Vec::len).sum::<usize>();
        }
        let stco = table(b"stco", &offsets);
        let ctts = if self.later.is_empty() { Vec::new() } else { ctts };
        let stbl = atom(b"stbl", &[&stsd, &stts, &ctts, &stsz, &stsc, &stco]);
        let hdlr = atom(b"hdlr", &[&words(&[0, 0]), b"vide", &words(&[0; 4])]);
        let mdhd = atom(b"mdhd", &[&words(&[0, 0, 0, 1000, 0, 0])]);
        let mdia = atom(b"mdia", &[&mdhd, &hdlr, &atom(b"minf", &[&stbl])]);
        let [a, b, c, d] = self.matrix.map(|part| (part << 16).cast_unsigned());
        let tkhd =
            atom(b"tkhd", &[&words(&[0, 0, 0, 1, 0, 0, 0, 0, 0, 0, a, b, 0, c, d, 0, 0, 0, 1 << 30, 0, 0])]);
        let edits = self.edits.iter().flat_map(|&(lasts, begins)| [lasts, begins.cast_unsigned(), 1 << 16]);
        let elst = table(b"elst", &[vec![self.edits.len() as u32], edits.collect()].concat());
        let edts = if self.edits.is_empty() { Vec::new() } else { atom(b"edts", &[&elst]) };
        let mvhd = atom(b"mvhd", &[&words(&[0, 0, 0, 100, 0])]);
        // A track of sound before it, of an unknown description.
        let sound = atom(b"trak", &[&atom(b"mdia", &[&atom(b"hdlr", &[&words(&[0, 0]), b"soun"])])]);
        atom(b"moov", &[&mvhd, &sound, &atom(b"trak", &[&tkhd, &edts, &mdia])])
    }
}

fn words(words: &[u32]) -> Vec<u8> {
    words.iter().flat_map(|word| word.to_be_bytes()).collect()
}

fn atom(kind: &[u8; 4], parts: &[&[u8]]) -> Vec<u8> {
    let body = parts.concat();
    [&(body.len() as u32 + 8).to_be_bytes()[..], kind, &body].concat()
}
