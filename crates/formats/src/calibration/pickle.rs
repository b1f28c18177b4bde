//! Python's pickles, as far as dicts of NumPy arrays need them. Nothing of a pickle is run.
//!
//! The format is a program for a stack machine (`pickletools.py` of `CPython`). Known here are the instructions that
//! build numbers, texts, bytes, tuples, lists and dicts, and of those that call something the four that NumPy's arrays
//! are made with; any other name is an error, and so is any other instruction.

use std::path::Path;

use crate::{FileError, FileProblem, Result, TextFormat};

/// Most instructions that are followed.
const MAX_INSTRUCTIONS: usize = 1_000_000;
/// Most numbers of all arrays.
const MAX_NUMBERS: usize = 1_000_000;

/// What may be called, and nothing else is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Callable {
    /// An empty array that is filled afterwards.
    Reconstruct,
    Ndarray,
    Dtype,
    /// Text to bytes, letter by letter: how Python 3 writes bytes for Python 2.
    Encode,
}

fn callable(module: &str, name: &str) -> Option<Callable> {
    match (module, name) {
        ("numpy.core.multiarray" | "numpy._core.multiarray", "_reconstruct") => Some(Callable::Reconstruct),
        ("numpy", "ndarray") => Some(Callable::Ndarray),
        ("numpy", "dtype") => Some(Callable::Dtype),
        ("_codecs", "encode") => Some(Callable::Encode),
        _ => None,
    }
}

#[derive(Debug, Clone)]
enum Object {
    Mark,
    Nothing,
    Bool(bool),
    Integer(i64),
    Text(String),
    Bytes(Vec<u8>),
    /// Tuples and lists.
    Sequence(Vec<usize>),
    Dict(Vec<(usize, usize)>),
    Callable(Callable),
    Dtype {
        code: String,
        big: bool,
    },
    Array(Option<Array>),
}

/// A NumPy array of numbers, row after row.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Array {
    pub(super) shape: Vec<usize>,
    pub(super) numbers: Vec<f64>,
}

/// The arrays of a pickled dict by their keys; other values of it are passed over.
pub(super) fn arrays(path: &Path, bytes: &[u8]) -> Result<Vec<(String, Array)>> {
    let mut machine = PickleMachine {
        path,
        bytes,
        at: 0,
        objects: Vec::new(),
        stack: Vec::new(),
        memo: Vec::new(),
        numbers: 0,
        encoded: 0,
    };
    let root = machine.run()?;
    let Object::Dict(entries) = &machine.objects[root] else {
        return Err(machine.error("the outermost value is not a dict"));
    };
    let (mut found, mut numbers) = (Vec::new(), 0);
    for (key, value) in entries {
        if let (Object::Text(key), Object::Array(Some(array))) =
            (&machine.objects[*key], &machine.objects[*value])
        {
            // One array may stand there under many keys.
            numbers += array.numbers.len();
            if numbers > MAX_NUMBERS {
                return Err(machine.error(&format!("more than {MAX_NUMBERS} numbers")));
            }
            found.push((key.clone(), array.clone()));
        }
    }
    Ok(found)
}

struct PickleMachine<'a> {
    path: &'a Path,
    bytes: &'a [u8],
    at: usize,
    objects: Vec<Object>,
    stack: Vec<usize>,
    memo: Vec<Option<usize>>,
    numbers: usize,
    encoded: usize,
}

impl<'a> PickleMachine<'a> {
    fn error(&self, message: &str) -> FileError {
        let message = format!("byte {}: {message}", self.at);
        FileProblem::syntax(TextFormat::Pickle, message).at(self.path, None)
    }

    fn take(&mut self, count: usize) -> Result<&'a [u8]> {
        let end = self.at.checked_add(count).filter(|end| *end <= self.bytes.len());
        let Some(end) = end else { return Err(self.error("the file ends too early")) };
        let taken = &self.bytes[self.at..end];
        self.at = end;
        Ok(taken)
    }

    /// A number of `count` bytes, the lowest first.
    fn unsigned(&mut self, count: usize) -> Result<usize> {
        let value = self.take(count)?.iter().rev().fold(0_u64, |value, byte| value << 8 | u64::from(*byte));
        usize::try_from(value).ok().ok_or_else(|| self.error("a number is too large"))
    }

    fn line(&mut self) -> Result<String> {
        let rest = &self.bytes[self.at..];
        let Some(end) = rest.iter().position(|byte| *byte == b'\n') else {
            return Err(self.error("the file ends too early"));
        };
        let line = self.take(end + 1)?;
        Ok(String::from_utf8_lossy(&line[..end]).trim_end_matches('\r').to_owned())
    }

    fn push(&mut self, object: Object) {
        self.objects.push(object);
        self.stack.push(self.objects.len() - 1);
    }

    fn pop(&mut self) -> Result<usize> {
        match self.stack.pop() {
            Some(index) if !matches!(self.objects[index], Object::Mark) => Ok(index),
            _ => Err(self.error("a value is missing")),
        }
    }

    /// All values down to the last mark, which goes too.
    fn pop_marked(&mut self) -> Result<Vec<usize>> {
        let mark = self.stack.iter().rposition(|&index| matches!(self.objects[index], Object::Mark));
        let Some(mark) = mark else { return Err(self.error("a mark is missing")) };
        let values = self.stack.split_off(mark + 1);
        self.stack.pop();
        Ok(values)
    }

    fn text(&mut self, count: usize) -> Result<()> {
        let text = String::from_utf8_lossy(self.take(count)?).into_owned();
        self.push(Object::Text(text));
        Ok(())
    }

    fn run(&mut self) -> Result<usize> {
        for _ in 0..MAX_INSTRUCTIONS {
            let code = self.take(1)?[0];
            match code {
                b'.' => return self.pop(),
                0x80 => {
                    self.take(1)?;
                }
                0x95 => {
                    self.take(8)?;
                }
                b'(' => self.push(Object::Mark),
                b'0' => {
                    self.pop()?;
                }
                b'N' | 0x88 | 0x89 | b'K' | b'M' | b'J' | 0x8a | b'G' => self.scalar(code)?,
                b'X' | 0x8c | 0x8d | b'B' | b'C' | 0x8e | b'U' | b'T' => self.long(code)?,
                b'}' | b']' | b')' | b't' | b'l' | b'd' | 0x85..=0x87 | b'a' | b'e' | b's' | b'u' => {
                    self.collection(code)?;
                }
                b'q' | b'r' | 0x94 | b'h' | b'j' => self.remember(code)?,
                b'c' => {
                    let (module, name) = (self.line()?, self.line()?);
                    self.global(&module, &name)?;
                }
                0x93 => {
                    let (name, module) = (self.pop()?, self.pop()?);
                    let (Object::Text(name), Object::Text(module)) =
                        (&self.objects[name], &self.objects[module])
                    else {
                        return Err(self.error("a name is not a text"));
                    };
                    let (module, name) = (module.clone(), name.clone());
                    self.global(&module, &name)?;
                }
                b'R' => self.call()?,
                b'b' => self.build()?,
                other => return Err(self.error(&format!("the instruction {other:#04x} is not known here"))),
            }
        }
        Err(self.error(&format!("more than {MAX_INSTRUCTIONS} instructions")))
    }

    fn global(&mut self, module: &str, name: &str) -> Result<()> {
        let Some(found) = callable(module, name) else {
            let named: String = format!("{module}.{name}").chars().take(80).collect();
            let message =
                format!("it asks for {named}; expected nothing but NumPy's arrays, and nothing is run");
            return Err(self.error(&message));
        };
        self.push(Object::Callable(found));
        Ok(())
    }

    fn scalar(&mut self, code: u8) -> Result<()> {
        let object = match code {
            b'N' => Object::Nothing,
            0x88 | 0x89 => Object::Bool(code == 0x88),
            b'K' => Object::Integer(self.unsigned(1)? as i64),
            b'M' => Object::Integer(self.unsigned(2)? as i64),
            b'J' => Object::Integer(i64::from(self.unsigned(4)? as u32 as i32)),
            b'G' => {
                // A single number is not needed.
                self.take(8)?;
                Object::Nothing
            }
            _ => {
                let count = self.unsigned(1)?;
                if count > 8 {
                    return Err(self.error("a whole number of more than 8 bytes"));
                }
                let bytes = self.take(count)?;
                let is_negative = bytes.last().is_some_and(|byte| *byte >= 0x80);
                let mut number = [if is_negative { 0xff } else { 0 }; 8];
                number[..count].copy_from_slice(bytes);
                Object::Integer(i64::from_le_bytes(number))
            }
        };
        self.push(object);
        Ok(())
    }

    /// Texts and bytes, whose length stands before them.
    fn long(&mut self, code: u8) -> Result<()> {
        let width = match code {
            0x8c | b'C' | b'U' => 1,
            0x8d | 0x8e => 8,
            _ => 4,
        };
        let count = self.unsigned(width)?;
        if matches!(code, b'X' | 0x8c | 0x8d) {
            return self.text(count);
        }
        let bytes = self.take(count)?.to_vec();
        self.push(Object::Bytes(bytes));
        Ok(())
    }

    fn collection(&mut self, code: u8) -> Result<()> {
        match code {
            b'}' => self.push(Object::Dict(Vec::new())),
            b']' | b')' => self.push(Object::Sequence(Vec::new())),
            b't' | b'l' => {
                let items = self.pop_marked()?;
                self.push(Object::Sequence(items));
            }
            b'd' => {
                let entries = self.pop_marked()?;
                self.push(Object::Dict(Vec::new()));
                self.set(&entries)?;
            }
            0x85..=0x87 => {
                let mut items = vec![0; usize::from(code - 0x84)];
                for item in items.iter_mut().rev() {
                    *item = self.pop()?;
                }
                self.push(Object::Sequence(items));
            }
            b'a' | b'e' => {
                let items = if code == b'a' { vec![self.pop()?] } else { self.pop_marked()? };
                match self.stack.last().map(|&index| &mut self.objects[index]) {
                    Some(Object::Sequence(list)) => list.extend(items),
                    _ => return Err(self.error("a list is missing")),
                }
            }
            _ => {
                let entries = if code == b's' {
                    let (value, key) = (self.pop()?, self.pop()?);
                    vec![key, value]
                } else {
                    self.pop_marked()?
                };
                self.set(&entries)?;
            }
        }
        Ok(())
    }

    /// Keys and values in turn, into the dict on top.
    fn set(&mut self, entries: &[usize]) -> Result<()> {
        let (pairs, rest) = entries.as_chunks::<2>();
        match self.stack.last().map(|&index| &mut self.objects[index]) {
            Some(Object::Dict(dict)) if rest.is_empty() => {
                dict.extend(pairs.iter().map(|&[key, value]| (key, value)));
                Ok(())
            }
            _ => Err(self.error("a dict, or the value of a key, is missing")),
        }
    }

    fn remember(&mut self, code: u8) -> Result<()> {
        let slot = match code {
            0x94 => self.memo.len(),
            b'q' | b'h' => self.unsigned(1)?,
            _ => self.unsigned(4)?,
        };
        if matches!(code, b'h' | b'j') {
            let Some(&Some(index)) = self.memo.get(slot) else {
                return Err(self.error(&format!("nothing was remembered as {slot}")));
            };
            self.stack.push(index);
            return Ok(());
        }
        let Some(&top) = self.stack.last() else { return Err(self.error("a value is missing")) };
        if slot > MAX_INSTRUCTIONS {
            return Err(self.error("a number is too large"));
        }
        if slot >= self.memo.len() {
            self.memo.resize(slot + 1, None);
        }
        self.memo[slot] = Some(top);
        Ok(())
    }

    fn call(&mut self) -> Result<()> {
        let (arguments, target) = (self.pop()?, self.pop()?);
        let (Object::Callable(target), Object::Sequence(arguments)) =
            (&self.objects[target], &self.objects[arguments])
        else {
            return Err(self.error("a call of something that is not a function"));
        };
        let first = arguments.first().map(|&index| &self.objects[index]);
        let made = match (target, first) {
            (Callable::Reconstruct, Some(Object::Callable(Callable::Ndarray))) => Object::Array(None),
            (Callable::Dtype, Some(Object::Text(code))) if code.len() <= 8 => {
                Object::Dtype { code: code.clone(), big: false }
            }
            (Callable::Encode, Some(Object::Text(text))) => {
                // Each call makes new bytes; a file of honest arrays encodes each of its texts once.
                self.encoded += text.len();
                if self.encoded > self.bytes.len() {
                    return Err(self.error("more bytes than the file has"));
                }
                let bytes: Result<Vec<u8>, _> =
                    text.chars().map(|letter| u8::try_from(u32::from(letter))).collect();
                let Ok(bytes) = bytes else { return Err(self.error("a letter that is not a byte")) };
                Object::Bytes(bytes)
            }
            _ => return Err(self.error("a call with arguments that make no array")),
        };
        self.push(made);
        Ok(())
    }

    /// Fills in the array or kind of number below the state on top.
    fn build(&mut self) -> Result<()> {
        let state = self.pop()?;
        let Some(&target) = self.stack.last() else { return Err(self.error("a value is missing")) };
        let Object::Sequence(state) = &self.objects[state] else {
            return Err(self.error("the state of an array is not a tuple"));
        };
        let state: Vec<&Object> = state.iter().map(|&index| &self.objects[index]).collect();
        let filled = match (&self.objects[target], state.as_slice()) {
            (Object::Dtype { code, .. }, [_, Object::Text(order), ..]) => {
                Object::Dtype { code: code.clone(), big: order == ">" }
            }
            (
                Object::Array(None),
                [
                    _,
                    Object::Sequence(shape),
                    Object::Dtype { code, big },
                    Object::Bool(by_column),
                    Object::Bytes(bytes),
                ],
            ) => {
                let array = self.array(shape, (code, *big), *by_column, bytes)?;
                self.numbers += array.numbers.len();
                Object::Array(Some(array))
            }
            _ => return Err(self.error("a state that is not that of an array of numbers")),
        };
        self.objects[target] = filled;
        Ok(())
    }

    fn array(
        &self,
        shape: &[usize],
        (code, big): (&str, bool),
        by_column: bool,
        bytes: &[u8],
    ) -> Result<Array> {
        let mut sides = Vec::with_capacity(shape.len());
        for &side in shape {
            let Object::Integer(side @ 0..) = self.objects[side] else {
                return Err(self.error("the shape of an array is not of whole numbers"));
            };
            sides.push(side as usize);
        }
        let (width, number): (usize, fn([u8; 8]) -> f64) = match code {
            "f8" => (8, f64::from_le_bytes),
            "i8" => (8, |word| i64::from_le_bytes(word) as f64),
            "u8" => (8, |word| u64::from_le_bytes(word) as f64),
            "f4" => (4, |[a, b, c, d, ..]| f64::from(f32::from_le_bytes([a, b, c, d]))),
            "i4" => (4, |[a, b, c, d, ..]| f64::from(i32::from_le_bytes([a, b, c, d]))),
            "u4" => (4, |[a, b, c, d, ..]| f64::from(u32::from_le_bytes([a, b, c, d]))),
            _ => return Err(self.error(&format!("an array of {code}; expected f8, f4, i8, i4, u8 or u4"))),
        };
        let count = sides.iter().try_fold(1_usize, |count, &side| count.checked_mul(side));
        if count.and_then(|count| count.checked_mul(width)) != Some(bytes.len()) {
            let message = format!("an array of {sides:?} numbers in {} bytes", bytes.len());
            return Err(self.error(&message));
        }
        if self.numbers + bytes.len() / width > MAX_NUMBERS {
            return Err(self.error(&format!("more than {MAX_NUMBERS} numbers")));
        }
        let read = |bytes: &[u8]| {
            let mut word = [0; 8];
            word[..width].copy_from_slice(bytes);
            if big {
                word[..width].reverse();
            }
            number(word)
        };
        let mut numbers: Vec<f64> = bytes.chunks_exact(width).map(read).collect();
        if let (true, &[rows, columns]) = (by_column, sides.as_slice()) {
            numbers = (0..rows * columns).map(|at| numbers[at % columns * rows + at / columns]).collect();
        }
        Ok(Array { shape: sides, numbers })
    }
}

#[cfg(test)]
pub(super) mod tests;
