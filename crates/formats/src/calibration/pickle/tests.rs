//! Pickles, honest and not.

use super::*;

/// The instructions of one array of numbers, as Python writes them with protocol 2 and bytes.
pub(in crate::calibration) fn array(shape: &[u8], code: &str, bytes: &[u8]) -> Vec<u8> {
    let mut out =
        b"cnumpy.core.multiarray\n_reconstruct\ncnumpy\nndarray\nK\x00\x85C\x01b\x87R(K\x01".to_vec();
    out.push(b'(');
    shape.iter().for_each(|side| out.extend([b'K', *side]));
    out.extend(b"tcnumpy\ndtype\nX\x02\x00\x00\x00");
    out.extend(code.as_bytes());
    out.extend(b"\x89\x88\x87R(K\x03X\x01\x00\x00\x00<NNNJ\xff\xff\xff\xffJ\xff\xff\xff\xffK\x00tb\x89C");
    out.push(bytes.len() as u8);
    out.extend(bytes);
    out.extend(b"tb");
    out
}

fn dict(body: &[u8]) -> Vec<u8> {
    [b"\x80\x03}(X\x01\x00\x00\x00k", body, b"u."].concat()
}

fn message(bytes: &[u8]) -> String {
    arrays(Path::new("c.pickle"), bytes).unwrap_err().to_string()
}

#[test]
fn arrays_of_numbers_are_read() {
    let floats: Vec<u8> = [1.5_f64, -2.0].iter().flat_map(|number| number.to_le_bytes()).collect();
    let found = arrays(Path::new("c"), &dict(&array(&[2, 1], "f8", &floats))).unwrap();
    assert_eq!(found, [("k".to_owned(), Array { shape: vec![2, 1], numbers: vec![1.5, -2.0] })]);
    let whole = arrays(Path::new("c"), &dict(&array(&[1], "i4", &7_i32.to_le_bytes()))).unwrap();
    assert_eq!(whole[0].1.numbers, [7.0]);
    // Anything else in the dict is passed over.
    assert_eq!(arrays(Path::new("c"), &dict(b"K\x05")).unwrap(), []);
}

#[test]
fn nothing_but_arrays_is_asked_for() {
    for name in ["cos\nsystem\n", "cbuiltins\neval\n", "cnumpy\nload\n", "csubprocess\nPopen\n"] {
        let found = message(&dict(&[name.as_bytes(), b"X\x02\x00\x00\x00ls\x85R"].concat()));
        assert!(
            found.contains("is not valid pickle of arrays") && found.contains("nothing is run"),
            "{found}"
        );
    }
    let stacked = b"\x80\x04\x8c\x02os\x8c\x06system\x93.";
    assert!(message(stacked).contains("it asks for os.system"), "{}", message(stacked));
}

#[test]
fn broken_pickles_are_errors() {
    let whole = dict(&array(&[1], "f8", &1.0_f64.to_le_bytes()));
    for end in 2..whole.len() {
        assert!(message(&whole[..end]).contains("byte "), "{end}");
    }
    let cases: [(Vec<u8>, &str); 7] = [
        (dict(&array(&[2], "f8", &[0; 8])), "an array of [2] numbers in 8 bytes"),
        (dict(&array(&[1], "O8", &[0; 8])), "an array of O8; expected f8"),
        (b"\x80\x03K\x01.".to_vec(), "the outermost value is not a dict"),
        (b"\x80\x03h\x09.".to_vec(), "nothing was remembered as 9"),
        (b"\x80\x03i.".to_vec(), "the instruction 0x69 is not known"),
        (b"\x80\x04\x8e\xff\xff\xff\xff\xff\xff\xff\x7f".to_vec(), "the file ends too early"),
        (b"\x80\x03R.".to_vec(), "a value is missing"),
    ];
    for (bytes, expected) in cases {
        assert!(message(&bytes).contains(expected), "{}: {expected}", message(&bytes));
    }
}
