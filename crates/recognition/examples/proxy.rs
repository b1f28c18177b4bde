use std::collections::BTreeMap;
use backlit_recognition::*;
fn main(){ println!("{}", Method::ALL.len()); let _: BTreeMap<u8,u8>; }
