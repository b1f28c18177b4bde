//! Small readers of the motion files, each by the rules of its format and none of the writers'.

use std::collections::BTreeMap;
use std::path::Path;

use glam::{DMat4, DQuat, DVec3};
use serde_json::Value;

/// Points by name, frame by frame.
pub(super) type Points = Vec<BTreeMap<String, DVec3>>;

/// Places of the joints of a BVH, and of its end sites as `JOINT_end`; the frame time. Our own reader shares nothing with the writer.
pub(super) fn bvh(bytes: &[u8]) -> (Points, f64) {
    let motion = backlit_formats::bvh::parse(Path::new("a.bvh"), bytes).unwrap();
    let frame = |frame: usize| {
        let places = motion.joints().iter().zip(motion.joints_at(frame));
        places.map(|(joint, (place, _))| (joint.name.replace(" end", "_end"), place)).collect()
    };
    ((0..motion.frame_count()).map(frame).collect(), motion.frame_seconds)
}

/// Markers of a TRC by frame number; an empty map in a gap.
pub(super) fn trc(bytes: &[u8]) -> BTreeMap<usize, BTreeMap<String, DVec3>> {
    let text = std::str::from_utf8(bytes).unwrap();
    let lines: Vec<Vec<&str>> = text.lines().map(|line| line.split('\t').collect()).collect();
    assert_eq!(lines[1][2..5], ["NumFrames", "NumMarkers", "Units"]);
    let [frames, markers] = [2, 3].map(|column| lines[2][column].parse::<usize>().unwrap());
    let names: Vec<&str> = lines[3][2..].iter().copied().filter(|name| !name.is_empty()).collect();
    assert_eq!((names.len(), lines[4].len(), lines[5].len()), (markers, 2 + 3 * markers, 1));
    assert_eq!(lines.len() - 6, frames);
    let row = |row: &Vec<&str>| {
        assert_eq!(row.len(), 2 + 3 * markers);
        let place = |fields: &[&str]| {
            (fields[0] != "nan")
                .then(|| DVec3::from_array([0, 1, 2].map(|axis| fields[axis].parse().unwrap())))
        };
        let found = names.iter().zip(row[2..].chunks(3));
        let found = found.filter_map(|(name, fields)| Some(((*name).to_owned(), place(fields)?)));
        (row[0].parse().unwrap(), found.collect())
    };
    lines[6..].iter().map(row).collect()
}

/// Columns of a MOT.
pub(super) fn mot(bytes: &[u8]) -> (Vec<String>, Vec<Vec<f64>>) {
    let text = std::str::from_utf8(bytes).unwrap();
    let (head, table) = text.split_once("endheader\n").unwrap();
    assert!(head.contains("\ninDegrees=yes\n"));
    let mut lines = table.lines();
    let names: Vec<String> = lines.next().unwrap().split('\t').map(str::to_owned).collect();
    let rows: Vec<Vec<f64>> =
        lines.map(|line| line.split('\t').map(|field| field.parse().unwrap()).collect()).collect();
    assert!(head.contains(&format!("\nnRows={}\nnColumns={}\n", rows.len(), names.len())));
    assert!(rows.iter().all(|row| row.len() == names.len()));
    (names, rows)
}

/// Points of a C3D, `NaN` where the residual is negative, and its number of the first frame.
pub(super) fn c3d(bytes: &[u8]) -> (Points, u16) {
    let (points, _, first) = c3d_with_residuals(bytes);
    (points, first)
}

/// The same with the residuals of every frame, point after point, in the file's unit.
pub(super) fn c3d_with_residuals(bytes: &[u8]) -> (Points, Vec<Vec<f64>>, u16) {
    let word = |at: usize| u16::from_le_bytes([bytes[at], bytes[at + 1]]);
    let real = |at: usize| f32::from_le_bytes(bytes[at..at + 4].try_into().unwrap());
    assert_eq!(bytes.len() % 512, 0);
    assert_eq!((bytes[0], bytes[1]), (2, 0x50));
    assert!(real(12) < 0.0);
    let (points, first, last, data) = (usize::from(word(2)), word(6), word(8), usize::from(word(16)));
    let start = (usize::from(bytes[0]) - 1) * 512;
    assert_eq!(bytes[start + 3], 84);
    assert_eq!(usize::from(bytes[start + 2]) + usize::from(bytes[0]), data);
    let (mut at, mut groups) = (start + 4, BTreeMap::new());
    let mut parameters = BTreeMap::new();
    while bytes[at] != 0 {
        let (length, id) = (usize::from(bytes[at]), bytes[at + 1] as i8);
        let name = std::str::from_utf8(&bytes[at + 2..at + 2 + length]).unwrap().to_owned();
        let next = at + 2 + length;
        if id < 0 {
            groups.insert(-id, name);
        } else {
            parameters.insert((groups[&id].clone(), name), next + 2);
        }
        at = next + usize::from(word(next));
    }
    let at = |name: &str| parameters.get(&("POINT".to_owned(), name.to_owned())).copied();
    let int = |name: &str| word(at(name).unwrap() + 2);
    assert_eq!(usize::from(int("USED")), points);
    assert_eq!(int("FRAMES"), last - first + 1);
    assert_eq!(usize::from(int("DATA_START")), data);
    assert_eq!(real(at("SCALE").unwrap() + 2), real(12));
    assert_eq!(real(at("RATE").unwrap() + 2), real(20));
    let mut labels: Vec<String> = Vec::new();
    for number in 1.. {
        let name = if number == 1 { "LABELS".to_owned() } else { format!("LABELS{number}") };
        let Some(at) = at(&name) else { break };
        assert_eq!((bytes[at] as i8, bytes[at + 1]), (-1, 2));
        let (width, count) = (usize::from(bytes[at + 2]), usize::from(bytes[at + 3]));
        let all = &bytes[at + 4..at + 4 + width * count];
        labels
            .extend(all.chunks(width).map(|label| std::str::from_utf8(label).unwrap().trim_end().to_owned()));
    }
    assert_eq!(labels.len(), points);
    let frame = |frame: usize| {
        let point = |point: usize| {
            let at = (data - 1) * 512 + (frame * points + point) * 16;
            let is_known = real(at + 12) >= 0.0;
            let place = DVec3::from_array([0, 4, 8].map(|axis| f64::from(real(at + axis))));
            (labels[point].clone(), if is_known { place } else { DVec3::NAN })
        };
        (0..points).map(point).collect()
    };
    let frames = 0..usize::from(last - first) + 1;
    let residual = |frame: usize, point: usize| {
        f64::from(real((data - 1) * 512 + (frame * points + point) * 16 + 12) * -real(12))
    };
    let residuals = frames.clone().map(|frame| (0..points).map(|point| residual(frame, point)).collect());
    (frames.map(frame).collect(), residuals.collect(), first)
}

/// The rows of an accessor, whose bounds are those of the numbers.
fn accessor_of(document: &Value, data: &[u8], accessor: &Value) -> Vec<Vec<f64>> {
    let index = |value: &Value| value.as_u64().unwrap() as usize;
    let accessor = &document["accessors"][index(accessor)];
    let view = &document["bufferViews"][index(&accessor["bufferView"])];
    let (offset, count) = (index(&view["byteOffset"]), index(&accessor["count"]));
    assert_eq!(offset % 4, 0);
    let width = match accessor["type"].as_str().unwrap() {
        "SCALAR" => 1,
        "VEC3" => 3,
        "VEC4" => 4,
        "MAT4" => 16,
        other => panic!("{other}"),
    };
    let size = if accessor["componentType"] == 5123 { 2 } else { 4 };
    assert_eq!(index(&view["byteLength"]), count * width * size);
    let number = |bytes: &[u8]| match accessor["componentType"].as_u64().unwrap() {
        5126 => f64::from(f32::from_le_bytes(bytes.try_into().unwrap())),
        5125 => f64::from(u32::from_le_bytes(bytes.try_into().unwrap())),
        5123 => f64::from(u16::from_le_bytes(bytes.try_into().unwrap())),
        other => panic!("{other}"),
    };
    let numbers: Vec<f64> = data[offset..offset + count * width * size].chunks(size).map(number).collect();
    let rows: Vec<Vec<f64>> = numbers.chunks(width).map(<[f64]>::to_vec).collect();
    for (bound, least) in [("min", true), ("max", false)] {
        for (axis, bound) in accessor[bound].as_array().into_iter().flatten().enumerate() {
            let values = rows.iter().map(|row| row[axis]);
            let found = if least {
                values.fold(f64::INFINITY, f64::min)
            } else {
                values.fold(f64::NEG_INFINITY, f64::max)
            };
            assert_eq!(bound.as_f64().unwrap(), found);
        }
    }
    rows
}

/// Nodes of a GLB, key by key of its animation; its times; and the corners of its skinned mesh.
pub(super) fn glb(bytes: &[u8]) -> (Points, Vec<f64>, Vec<Vec<DVec3>>) {
    let word = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize;
    assert_eq!((&bytes[..4], word(4), word(8)), (&b"glTF"[..], 2, bytes.len()));
    let length = word(12);
    assert_eq!((&bytes[16..20], length % 4, word(20 + length) % 4), (&b"JSON"[..], 0, 0));
    let document: Value = serde_json::from_slice(&bytes[20..20 + length]).unwrap();
    assert_eq!(&bytes[24 + length..28 + length], b"BIN\0");
    let data = &bytes[28 + length..];
    assert_eq!(data.len(), word(20 + length));
    let index = |value: &Value| value.as_u64().unwrap() as usize;
    let read = |accessor: &Value| accessor_of(&document, data, accessor);
    let nodes = document["nodes"].as_array().unwrap();
    let vector = |value: &Value| DVec3::from_array([0, 1, 2].map(|axis| value[axis].as_f64().unwrap_or(0.0)));
    let animation = &document["animations"][0];
    let mut times = Vec::new();
    let mut keys: BTreeMap<(usize, bool), Vec<Vec<f64>>> = BTreeMap::new();
    for channel in animation["channels"].as_array().unwrap() {
        let sampler = &animation["samplers"][index(&channel["sampler"])];
        let input = &document["accessors"][index(&sampler["input"])];
        assert!(input["min"].is_array() && input["max"].is_array());
        times = read(&sampler["input"]).concat();
        let path = channel["target"]["path"] == "translation";
        keys.insert((index(&channel["target"]["node"]), path), read(&sampler["output"]));
    }
    let skin = &document["skins"][0];
    assert_eq!(skin["skeleton"], 0, "glTF names the root of the skin so");
    let joints: Vec<usize> = skin["joints"].as_array().unwrap().iter().map(index).collect();
    let inverse_bind = read(&skin["inverseBindMatrices"]);
    let primitive = &document["meshes"][0]["primitives"][0];
    assert!(document["accessors"][index(&primitive["attributes"]["POSITION"])]["min"].is_array());
    let (corners, of) =
        (read(&primitive["attributes"]["POSITION"]), read(&primitive["attributes"]["JOINTS_0"]));
    let triangles = read(&primitive["indices"]).concat();
    assert!(triangles.len() % 3 == 0 && triangles.iter().all(|&corner| corner < corners.len() as f64));
    let (mut frames, mut meshes) = (Vec::new(), Vec::new());
    for key in 0..times.len() {
        let mut world = vec![DMat4::IDENTITY; nodes.len()];
        let mut open = vec![(0, DMat4::IDENTITY)];
        let mut places = BTreeMap::new();
        while let Some((node, parent)) = open.pop() {
            let place = keys.get(&(node, true)).map(|keys| DVec3::from_slice(&keys[key]));
            let turn = keys.get(&(node, false)).map_or(DQuat::IDENTITY, |keys| DQuat::from_slice(&keys[key]));
            let place = place.unwrap_or_else(|| vector(&nodes[node]["translation"]));
            world[node] = parent * DMat4::from_rotation_translation(turn.normalize(), place);
            places.insert(nodes[node]["name"].as_str().unwrap().to_owned(), world[node].w_axis.truncate());
            let children = nodes[node]["children"].as_array();
            open.extend(children.into_iter().flatten().map(|child| (index(child), world[node])));
        }
        let skinned = corners.iter().zip(&of).map(|(corner, of)| {
            let joint = of[0] as usize;
            let bind = DMat4::from_cols_slice(&inverse_bind[joint]);
            (world[joints[joint]] * bind).transform_point3(DVec3::from_slice(corner))
        });
        meshes.push(skinned.collect());
        frames.push(places);
    }
    (frames, times, meshes)
}

/// Arrays of an NPZ: kind, shape, bytes.
pub(super) fn npz(bytes: &[u8]) -> BTreeMap<String, (String, Vec<usize>, Vec<u8>)> {
    let word = |at: usize| usize::from(u16::from_le_bytes([bytes[at], bytes[at + 1]]));
    let long = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize;
    let end = bytes.len() - 22;
    assert_eq!((&bytes[end..end + 4], word(end + 20)), (&b"PK\x05\x06"[..], 0));
    let mut at = long(end + 16);
    assert_eq!(at + long(end + 12), end);
    let mut arrays = BTreeMap::new();
    for _ in 0..word(end + 10) {
        assert_eq!((&bytes[at..at + 4], word(at + 10)), (&b"PK\x01\x02"[..], 0));
        let (sum, size, name_length, local) = (long(at + 16), long(at + 24), word(at + 28), long(at + 42));
        let name = std::str::from_utf8(&bytes[at + 46..at + 46 + name_length]).unwrap();
        assert_eq!(bytes[local..local + 4], *b"PK\x03\x04");
        assert_eq!(bytes[local + 4..local + 30], [&bytes[at + 6..at + 32]].concat());
        let start = local + 30 + name_length;
        let file = &bytes[start..start + size];
        let found = file.iter().fold(u32::MAX, |mut sum, &byte| {
            sum ^= u32::from(byte);
            (0..8).for_each(|_| sum = (sum >> 1) ^ (0xedb8_8320 & 0_u32.wrapping_sub(sum & 1)));
            sum
        });
        assert_eq!(!found as usize, sum);
        let array = npyz::NpyFile::new(file).unwrap();
        let shape: Vec<usize> = array.shape().iter().map(|&side| side as usize).collect();
        let kind = array.dtype().descr();
        let data = 10 + usize::from(u16::from_le_bytes([file[8], file[9]]));
        assert_eq!(data % 64, 0);
        arrays.insert(name.strip_suffix(".npy").unwrap().to_owned(), (kind, shape, file[data..].to_vec()));
        at += 46 + name_length;
    }
    arrays
}
