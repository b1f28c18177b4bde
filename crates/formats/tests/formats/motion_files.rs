//! Motion files, read back by their formats' own rules: joints lie within 0.1 mm of the body's kinematics.

mod readers;

use std::collections::BTreeMap;
use std::path::Path;
use std::time::Instant;

use backlit_formats::motion::{self, Axes, EulerOrder, Motion, MotionFormat, MotionOptions, Names, Unit};
use backlit_tracking::belief::{LimbTrust, Reason};
use backlit_tracking::body::{Kinematics, Model, Parameters, Pose, builtin};
use glam::{DMat3, DQuat, DVec3};

const NEAR_M: f64 = 1e-4;
const AXES: [Axes; 3] = [Axes::YUp, Axes::ZUp, Axes::World];
const UNITS: [Unit; 3] = [Unit::Metres, Unit::Centimetres, Unit::Millimetres];

/// Poses at random frames from a seed, with a gap after the third.
fn motion(model: Model, frames: usize, seed: u64) -> Motion {
    let mut state = seed;
    let mut random = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64 * 2.0 - 1.0
    };
    let columns = Parameters::Tangent.columns(model.rotation_count());
    let poses = (0..frames).map(|index| {
        let step: Vec<f64> = (0..columns).map(|_| 3.0 * random()).collect();
        let frame = if index < 3 { index + 2 } else { index + 4 };
        (frame, Pose::rest(&model).retract(Parameters::Tangent, &step))
    });
    let poses = poses.collect();
    Motion::of_poses("a name", model, 60.0, poses)
}

/// Where a point of the world lies in the file, for worlds with z up and with −y up.
fn in_file(point: DVec3, options: &MotionOptions) -> DVec3 {
    let DVec3 { x, y, z } = point;
    let turned = match (options.axes.unwrap(), options.up == DVec3::Z) {
        (Axes::World, _) | (Axes::ZUp, true) => point,
        (Axes::YUp, true) | (Axes::ZUp, false) => DVec3::new(x, z, -y),
        (Axes::YUp, false) => DVec3::new(x, -y, -z),
    };
    turned * per_metre(options)
}

fn per_metre(options: &MotionOptions) -> f64 {
    match options.unit.unwrap() {
        Unit::Metres => 1.0,
        Unit::Centimetres => 100.0,
        Unit::Millimetres => 1000.0,
    }
}

fn all_options() -> Vec<MotionOptions> {
    let mut all = Vec::new();
    for axes in AXES {
        for unit in UNITS {
            for up in [DVec3::Z, -DVec3::Y] {
                all.push(MotionOptions {
                    axes: Some(axes),
                    unit: Some(unit),
                    up,
                    names: Some(Names::Limbs),
                    ..MotionOptions::default()
                });
            }
        }
    }
    all
}

fn joint_names(model: &Model) -> Vec<String> {
    std::iter::once("root")
        .chain(model.limbs().iter().map(|limb| limb.name.as_str()))
        .map(str::to_owned)
        .collect()
}

/// The root and each limb's second joint, in the file.
fn joints(motion: &Motion, frame: usize, options: &MotionOptions) -> Vec<DVec3> {
    let pose = &motion.poses[&frame];
    let kinematics = Kinematics::new(&motion.model, pose);
    let points = std::iter::once(pose.root).chain(kinematics.ends().iter().copied());
    points.map(|point| in_file(point, options)).collect()
}

fn assert_near(found: DVec3, expected: DVec3, options: &MotionOptions, what: &str) {
    let apart = found.distance(expected) / per_metre(options);
    assert!(apart < NEAR_M, "{what}: {found} is {apart} m from {expected}, {options:?}");
}

/// Points that are named after joints.
fn assert_markers(found: &BTreeMap<String, DVec3>, motion: &Motion, frame: usize, options: &MotionOptions) {
    let expected = joints(motion, frame, options);
    assert_eq!(found.len(), expected.len());
    for (name, place) in joint_names(&motion.model).iter().zip(expected) {
        assert_near(found[&name.replace(' ', "_")], place, options, name);
    }
}

/// Nodes that are named after bones, and the tips of the last.
fn assert_nodes(found: &BTreeMap<String, DVec3>, motion: &Motion, frame: usize, options: &MotionOptions) {
    let model = &motion.model;
    let kinematics = Kinematics::new(model, &motion.poses[&frame]);
    let mut tips = 0;
    for (rotation, &owner) in model.rotation_owners().iter().enumerate() {
        let name = model.limbs()[owner].name.replace(' ', "_");
        let start = kinematics.starts()[owner];
        assert_near(found[&name], in_file(start, options), options, &name);
        if let Some(&tip) = found.get(&format!("{name}_end")) {
            let limbs = model.limbs().iter().zip(kinematics.ends());
            let ends = limbs.filter(|(limb, _)| limb.rotation == rotation).map(|(_, end)| *end);
            let far = ends.max_by(|a, b| a.distance(start).total_cmp(&b.distance(start))).unwrap();
            assert_near(tip, in_file(far, options), options, &name);
            tips += 1;
        }
    }
    assert!(tips > 0);
}

fn bytes(format: MotionFormat, motion: &Motion, options: &MotionOptions) -> Vec<u8> {
    motion::to_bytes(format, motion, options).unwrap()
}

#[test]
fn what_is_told_of_limbs_is_written_beside_their_joints() {
    let mut motion = motion(builtin::full_body(), 2, 1);
    let limbs = motion.model.limbs().len();
    let told =
        |limb| LimbTrust::new(limb, 0.01 * limb as f64, [0.02, 0.031 + 0.02 * limb as f64], Reason::Loose);
    motion.trust.insert(2, (0..limbs).map(told).collect());
    let options = MotionOptions { unit: Some(Unit::Metres), ..MotionOptions::default() };
    let error = |limb: usize| 0.031 + 0.02 * limb as f64;
    let (_, residuals, _) = readers::c3d_with_residuals(&bytes(MotionFormat::C3d, &motion, &options));
    assert!((residuals[0][0] - 0.031).abs() < 1e-6, "the root is where the first limb begins");
    for limb in 0..limbs {
        let written = residuals[0][limb + 1];
        assert!((written - error(limb).min(0.255)).abs() < 6e-4, "{written} of limb {limb}");
    }
    assert!(residuals[1].iter().all(|&residual| residual == 0.0), "nobody judged the second frame");
    let arrays = readers::npz(&bytes(MotionFormat::Npz, &motion, &options));
    let numbers = |name: &str| -> Vec<f64> {
        let (_, shape, data) = &arrays[name];
        assert_eq!(shape[..], [2, limbs + 1]);
        data.as_chunks::<8>().0.iter().map(|bytes| f64::from_le_bytes(*bytes)).collect()
    };
    assert_eq!(numbers("wrong")[4], told(3).wrong);
    assert_eq!(numbers("error")[4], error(3));
    assert!(numbers("error")[limbs + 1..].iter().all(|error| error.is_nan()));
    let csv = String::from_utf8(bytes(MotionFormat::Csv, &motion, &options)).unwrap();
    let rows: Vec<Vec<&str>> = csv.lines().map(|line| line.split(',').collect()).collect();
    assert_eq!(rows[0][6..], ["wrong", "error"]);
    assert_eq!((rows[5][6], rows[5][7]), ("0.03", &error(3).to_string()[..]));
    assert_eq!(rows[limbs + 2][6..], ["", ""]);
    // Without a word of it the files are as they were.
    motion.trust.clear();
    assert!(!readers::npz(&bytes(MotionFormat::Npz, &motion, &options)).contains_key("wrong"));
    assert!(bytes(MotionFormat::Csv, &motion, &options).starts_with(b"frame,seconds,joint,x,y,z\n"));
}

#[test]
fn markers_lie_where_the_joints_are() {
    let motion = motion(builtin::full_body(), 5, 1);
    for options in all_options() {
        let trc = readers::trc(&bytes(MotionFormat::Trc, &motion, &options));
        assert_eq!(trc.keys().copied().collect::<Vec<_>>(), (2..=8).collect::<Vec<_>>());
        let (c3d, first) = readers::c3d(&bytes(MotionFormat::C3d, &motion, &options));
        assert_eq!((c3d.len(), first), (7, 3));
        for frame in 2..=8 {
            if motion.poses.contains_key(&frame) {
                assert_markers(&trc[&frame], &motion, frame, &options);
                assert_markers(&c3d[frame - 2], &motion, frame, &options);
            } else {
                assert!(trc[&frame].is_empty() && c3d[frame - 2].values().all(|point| point.is_nan()));
            }
        }
        let text = bytes(MotionFormat::Csv, &motion, &options);
        let mut rows = csv::Reader::from_reader(&text[..]);
        let mut found: BTreeMap<usize, BTreeMap<String, DVec3>> = BTreeMap::new();
        for row in rows.deserialize::<(usize, f64, String, f64, f64, f64)>() {
            let (frame, seconds, joint, x, y, z) = row.unwrap();
            assert_eq!(seconds, frame as f64 / 60.0);
            found.entry(frame).or_default().insert(joint.replace(' ', "_"), DVec3::new(x, y, z));
        }
        assert!(found.keys().eq(motion.poses.keys()));
        for (&frame, found) in &found {
            assert_markers(found, &motion, frame, &options);
        }
    }
}

#[test]
fn skeletons_turn_as_the_body_does() {
    for (model, seed) in [(builtin::full_body(), 2), (builtin::upper_body(), 3), (builtin::single_limb(), 4)]
    {
        let motion = motion(model, 5, seed);
        for (index, options) in all_options().into_iter().enumerate() {
            let options = MotionOptions { euler: EulerOrder::ALL[index % 6], ..options };
            let (bvh, time) = readers::bvh(&bytes(MotionFormat::Bvh, &motion, &options));
            assert_eq!(bvh.len(), 7);
            assert!((time - 1.0 / 60.0).abs() < 1e-9);
            let (glb, times, meshes) = readers::glb(&bytes(MotionFormat::Glb, &motion, &options));
            for (key, &frame) in motion.poses.keys().enumerate() {
                assert_nodes(&bvh[frame - 2], &motion, frame, &options);
                assert_nodes(&glb[key], &motion, frame, &options);
                assert!((times[key] - (frame - 2) as f64 / 60.0).abs() < 1e-6);
                let kinematics = Kinematics::new(&motion.model, &motion.poses[&frame]);
                let of_a_limb = meshes[key].len() / motion.model.limbs().len();
                for (limb, corners) in meshes[key].chunks(of_a_limb).enumerate() {
                    let [start, end] = [kinematics.starts()[limb], kinematics.ends()[limb]]
                        .map(|point| in_file(point, &options));
                    for &corner in corners {
                        let along = end - start;
                        let at = ((corner - start).dot(along) / along.length_squared()).clamp(0.0, 1.0);
                        let apart = corner.distance(start + along * at) / per_metre(&options);
                        assert!((apart - motion.model.limbs()[limb].radius).abs() < NEAR_M, "{apart}");
                    }
                }
            }
        }
    }
}

/// A body at rest in a world with z up stands upright: one does not lie on its face when it is opened.
#[test]
fn the_rest_pose_stands_and_looks_ahead() {
    let model = builtin::full_body();
    let rest = [(0, Pose::rest(&model))].into();
    let motion = Motion::of_poses("rest", model, 30.0, rest);
    let text = String::from_utf8(bytes(MotionFormat::Bvh, &motion, &MotionOptions::default())).unwrap();
    let offset = |joint: &str| {
        let (_, rest) = text.split_once(&format!("{joint}\n")).unwrap();
        let line = rest.lines().find(|line| line.contains("OFFSET")).unwrap();
        DVec3::from_array([1, 2, 3].map(|word| line.split_whitespace().nth(word).unwrap().parse().unwrap()))
    };
    // Centimetres; y up, z ahead, so the subject's right is at −x.
    assert!(offset("JOINT chest").distance(DVec3::new(0.0, 24.0, 0.0)) < 1e-4);
    assert!(offset("JOINT right_thigh").distance(DVec3::new(-9.5, 0.0, 0.0)) < 1e-4);
    let (_, foot) = text.split_once("JOINT right_foot").unwrap();
    let tip = foot.lines().skip_while(|line| !line.contains("End Site")).nth(2).unwrap();
    let ahead: f64 = tip.split_whitespace().nth(3).unwrap().parse().unwrap();
    assert!(ahead > 10.0, "{tip}");
}

/// Who chooses no names gets the markers of `OpenSim` in TRC, and joints by anatomy in the others.
#[test]
fn joints_have_the_names_that_a_format_expects() {
    let motion = motion(builtin::full_body(), 2, 5);
    let text =
        |format| String::from_utf8_lossy(&bytes(format, &motion, &MotionOptions::default())).into_owned();
    assert!(text(MotionFormat::Trc).contains("\tRElbow\t"), "{}", &text(MotionFormat::Trc)[..400]);
    assert!(text(MotionFormat::Csv).contains(",right elbow,"));
    assert!(text(MotionFormat::C3d).contains("right_elbow"));
}

#[test]
fn coordinates_turn_limb_by_limb() {
    let motion = motion(builtin::full_body(), 5, 5);
    let model = &motion.model;
    for options in all_options() {
        for names in [Names::Limbs, Names::OpenSim] {
            let options = MotionOptions { names: Some(names), ..options.clone() };
            let (columns, rows) = readers::mot(&bytes(MotionFormat::Mot, &motion, &options));
            // x ahead, y up, z to the right; the columns of this are our x, y, z.
            let body = match options.axes {
                Some(Axes::YUp) => DMat3::from_cols(DVec3::Z, DVec3::X, DVec3::Y),
                _ => DMat3::IDENTITY,
            };
            for (row, &frame) in rows.iter().zip(motion.poses.keys()) {
                assert!((row[0] - frame as f64 / 60.0).abs() < 1e-8);
                let mut turns = vec![DQuat::IDENTITY; model.rotation_count()];
                // Three angles a rotation in the order of the tree, the root's place after the first three.
                let mut angles = row[1..4].iter().chain(&row[7..]).copied();
                let mut names = columns[1..4].iter().chain(&columns[7..]);
                for &rotation in &order(model) {
                    let [z, x, y] = [0, 1, 2].map(|axis| {
                        let (name, angle) = (names.next().unwrap(), angles.next().unwrap().to_radians());
                        let left = options.names == Some(Names::OpenSim) && name.ends_with("_l") && axis > 0;
                        let is_ours = name.starts_with("scapula");
                        if (left && !is_ours) || name.starts_with("knee_angle") { -angle } else { angle }
                    });
                    let turn =
                        DQuat::from_rotation_z(z) * DQuat::from_rotation_x(x) * DQuat::from_rotation_y(y);
                    let parent = model.rotation_parents()[rotation].map(|parent| turns[parent]);
                    turns[rotation] = parent.unwrap_or(DQuat::IDENTITY) * turn;
                }
                assert!(angles.next().is_none());
                let mut ends: Vec<DVec3> = Vec::new();
                let root = DVec3::from_slice(&row[4..7]);
                for limb in model.limbs() {
                    let bone =
                        turns[limb.rotation] * (body * limb.direction * limb.length * per_metre(&options));
                    ends.push(limb.parent.map_or(root, |parent| ends[parent]) + bone);
                }
                let expected = joints(&motion, frame, &options);
                for (place, expected) in std::iter::once(root).chain(ends).zip(expected) {
                    assert_near(place, expected, &options, "mot");
                }
            }
            assert_eq!(
                columns[4..7],
                if names == Names::OpenSim {
                    ["pelvis_tx", "pelvis_ty", "pelvis_tz"]
                } else {
                    ["spine_tx", "spine_ty", "spine_tz"]
                }
            );
        }
    }
}

/// Rotations in the order in which their limbs stand.
fn order(model: &Model) -> Vec<usize> {
    model.limbs().iter().filter(|limb| limb.has_own_rotation).map(|limb| limb.rotation).collect()
}

#[test]
fn arrays_hold_the_motion_and_give_the_joints_again() {
    let motion = motion(builtin::full_body(), 5, 6);
    for options in all_options() {
        let arrays = readers::npz(&bytes(MotionFormat::Npz, &motion, &options));
        let doubles = |name: &str, shape: &[usize]| -> Vec<f64> {
            let (kind, found, data) = &arrays[name];
            assert_eq!((kind.as_str(), &found[..]), ("'<f8'", shape), "{name}");
            data.chunks(8).map(|bytes| f64::from_le_bytes(bytes.try_into().unwrap())).collect()
        };
        let integers = |name: &str| -> Vec<i64> {
            let (kind, _, data) = &arrays[name];
            assert_eq!(kind, "'<i8'", "{name}");
            data.chunks(8).map(|bytes| i64::from_le_bytes(bytes.try_into().unwrap())).collect()
        };
        let (kind, shape, data) = &arrays["joint_names"];
        let width: usize = kind.trim_matches(['\'', '<', 'U']).parse().unwrap();
        assert_eq!(shape[..], [31]);
        let letter = |bytes: &[u8]| char::from_u32(u32::from_le_bytes(bytes.try_into().unwrap())).unwrap();
        let name = |bytes: &[u8]| bytes.chunks(4).map(letter).filter(|&c| c != '\0').collect::<String>();
        assert_eq!(data.chunks(4 * width).map(name).collect::<Vec<_>>(), joint_names(&motion.model));
        let (points, offsets) = (doubles("joints", &[5, 31, 3]), doubles("offsets", &[31, 3]));
        let (roots, turns) = (doubles("root", &[5, 3]), doubles("rotations", &[5, 15, 4]));
        let [parents, of, above] = ["parents", "rotation_of", "rotation_parents"].map(integers);
        assert_eq!(doubles("seconds", &[5])[0], 2.0 / 60.0);
        for (index, (frame, found)) in integers("frames").into_iter().zip(points.chunks(31 * 3)).enumerate() {
            let q = |rotation: usize| {
                let at = (index * 15 + rotation) * 4;
                DQuat::from_xyzw(turns[at + 1], turns[at + 2], turns[at + 3], turns[at])
            };
            let world = |rotation: i64| {
                let mut turn = q(rotation as usize);
                let mut parent = above[rotation as usize];
                while parent >= 0 {
                    turn = q(parent as usize) * turn;
                    parent = above[parent as usize];
                }
                turn
            };
            let mut places = vec![DVec3::from_slice(&roots[3 * index..])];
            for joint in 1..31 {
                let offset = DVec3::from_slice(&offsets[3 * joint..]);
                places.push(places[parents[joint] as usize] + world(of[joint]) * offset);
            }
            let expected = joints(&motion, frame as usize, &options);
            for joint in 0..31 {
                assert_near(DVec3::from_slice(&found[3 * joint..]), expected[joint], &options, "joints");
                assert_near(places[joint], expected[joint], &options, "rotations");
            }
        }
    }
}

/// Parts, single frames, and what is refused.
#[test]
fn parts_of_a_motion_are_written_and_bad_ones_refused() {
    let whole = motion(builtin::full_body(), 5, 7);
    for format in MotionFormat::ALL {
        assert_eq!(MotionFormat::of_extension(format.extension()), Some(format));
        let options = MotionOptions { range: Some(3..=3), ..MotionOptions::default() };
        let one = Motion { poses: [(3, whole.poses[&3].clone())].into(), ..whole.clone() };
        let part = bytes(format, &whole, &options);
        assert!(part == bytes(format, &one, &MotionOptions::default()), "{format:?}");
        let refused = |motion: &Motion, options: &MotionOptions, expected: &str| {
            let error = motion::write(Path::new("/no/such/folder/m.x"), format, motion, options);
            let text = error.unwrap_err().to_string();
            assert!(text.contains("m.x") && text.contains(expected), "{format:?}: {text}");
        };
        let none = Motion { poses: BTreeMap::new(), ..whole.clone() };
        refused(&none, &options, "`frames` is empty");
        refused(&whole, &MotionOptions { range: Some(100..=200), ..options.clone() }, "between 100 and 200");
        refused(&whole, &MotionOptions { up: DVec3::ZERO, ..options.clone() }, "`up`");
        refused(&whole, &MotionOptions { up: DVec3::NAN, ..options.clone() }, "`up`");
        refused(&Motion { frame_rate: f64::NAN, ..whole.clone() }, &options, "`frame_rate`");
        let mut bad = whole.clone();
        bad.poses.get_mut(&3).unwrap().root.x = f64::NAN;
        refused(&bad, &options, "frames[3]");
        let mut bad = whole.clone();
        bad.poses.get_mut(&3).unwrap().rotations[4].w = f64::NAN;
        refused(&bad, &options, "frames[3]");
        bad.poses.get_mut(&3).unwrap().rotations.pop();
        refused(&bad, &options, "frames[3]");
        refused(&whole, &options, "cannot be written");
        if matches!(format, MotionFormat::Bvh | MotionFormat::Trc | MotionFormat::C3d) {
            let mut far = one.clone();
            far.poses.insert(usize::MAX, one.poses[&3].clone());
            refused(&far, &MotionOptions::default(), "at most 1000000");
        }
    }
}

/// More joints than one list of labels holds.
#[test]
fn labels_beyond_255_go_to_a_second_list() {
    let mut text = "format = \"backlit-body 1\"\nname = \"chain\"\n".to_owned();
    for limb in 0..256 {
        text.push_str(&format!(
            "[[limb]]\nname = \"limb {limb}\"\ndirection = [0, 1, 0]\nlength = 0.1\nradius = 0.1\n"
        ));
        if limb > 0 {
            text.push_str(&format!("parent = \"limb {}\"\n", limb - 1));
        }
    }
    let model = backlit_formats::model_file::parse(Path::new("chain.toml"), text.as_bytes()).unwrap();
    let motion = motion(model, 2, 8);
    let (axes, unit, names) = (Some(Axes::World), Some(Unit::Millimetres), Some(Names::Limbs));
    let options = MotionOptions { axes, unit, names, ..MotionOptions::default() };
    let (c3d, _) = readers::c3d(&bytes(MotionFormat::C3d, &motion, &options));
    assert_markers(&c3d[0], &motion, 2, &options);
    let (bvh, _) = readers::bvh(&bytes(MotionFormat::Bvh, &motion, &options));
    assert_nodes(&bvh[0], &motion, 2, &options);
}

/// How long 10,000 frames take; `cargo test --release -p backlit-formats -- --ignored long_motions`.
#[test]
#[ignore = "measures time"]
fn long_motions_are_written_in_two_seconds() {
    let motion = motion(builtin::full_body(), 10_000, 9);
    for format in MotionFormat::ALL {
        let start = Instant::now();
        let bytes = bytes(format, &motion, &MotionOptions::default());
        let seconds = start.elapsed().as_secs_f64();
        println!("{}: {seconds:.2} s, {} bytes", format.extension(), bytes.len());
        assert!(seconds < 2.0, "{format:?}: {seconds} s");
    }
}

/// Writes every format to the folder that `BACKLIT_INTEROP` names, for `tests/interop`.
#[test]
fn files_for_other_programs() {
    let Some(folder) = std::env::var_os("BACKLIT_INTEROP") else {
        println!("skipped: BACKLIT_INTEROP names no folder");
        return;
    };
    let motion = motion(builtin::full_body(), 40, 10);
    let (axes, unit, names) = (Some(Axes::YUp), Some(Unit::Metres), Some(Names::Limbs));
    let options = MotionOptions { axes, unit, names, ..MotionOptions::default() };
    for format in MotionFormat::ALL {
        let path = Path::new(&folder).join(format!("motion.{}", format.extension()));
        motion::write(&path, format, &motion, &options).unwrap();
    }
}
