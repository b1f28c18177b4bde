//! Small files that would take a program's time or memory: each is answered within a second and 500 MB.

use std::fmt::Write;
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

use backlit_formats::calibration::{self, CalibrationOptions};
use backlit_formats::pose_file::{self, Quaternions};
use backlit_formats::{MemoryFiles, Take, model_file, trc};
use backlit_tracking::body::{Kinematics, Pose, builtin};

/// The answer's message; empty where the file is read. Within the promise, and shown in a few lines.
fn answered<T, E: std::fmt::Display>(what: &str, read: impl FnOnce() -> Result<T, E>) -> String {
    let began = Instant::now();
    let mut message = String::new();
    let memory = allocation_counter::measure(|| {
        message = read().map_or_else(|error| error.to_string(), |_| String::new());
    });
    let took = began.elapsed();
    println!("{what}: {took:?}, {} MB: {message}", memory.bytes_max / 1_000_000);
    // Other tests run beside this one.
    assert!(took < Duration::from_secs(3), "{what} takes {took:?}");
    assert!(memory.bytes_max < 500 << 20, "{what} holds {} bytes", memory.bytes_max);
    assert!(message.chars().count() < 600 && !message.contains('\n'), "{what}: {message}");
    message
}

fn cameras(name: &str, text: &str) -> String {
    let options = CalibrationOptions { size: Some([640, 480]), ..CalibrationOptions::default() };
    answered(name, || calibration::parse(Path::new(name), text.as_bytes(), options))
}

#[test]
fn xml_of_many_attributes_and_elements_takes_linear_time() {
    let mut attributes = String::new();
    (0..830_000).for_each(|index| write!(attributes, " a{index}=''").unwrap());
    attributes.truncate(8_000_000);
    attributes.truncate(attributes.rfind(' ').unwrap());
    let message = cameras("many.xml", &format!("<calibration{attributes}/>"));
    assert!(
        message.contains("many.xml, line 1: is not valid XML: more than 256 attributes in one element"),
        "{message}"
    );
    // As many as may be, in as many elements as there is room for.
    let full: String = (0..256).map(|index| format!(" a{index}=''")).collect();
    let many = format!("<a{full}/>").repeat(7_900_000 / (full.len() + 4));
    assert_ne!(cameras("full.xml", &format!("<calibration>{many}</calibration>")), "");
    let elements = "<a/>".repeat(1_900_000);
    assert!(
        cameras("elements.xml", &format!("<opencv_storage>{elements}</opencv_storage>"))
            .contains("elements.xml")
    );
    let deep = "<a>".repeat(500_000);
    assert!(cameras("deep.xml", &format!("<opencv_storage>{deep}")).contains("deep.xml"));
}

#[test]
fn tables_of_many_keys_take_linear_time_or_are_refused() {
    let keys = |form: &dyn Fn(usize) -> String, between: &str| {
        (0..20_000).map(form).collect::<Vec<_>>().join(between)
    };
    let json = format!("{{{}}}", keys(&|index| format!("\"k{index}\": {{\"a\": 1}}"), ","));
    assert!(cameras("keys.json", &json).contains("keys.json"));
    let yaml = keys(&|index| format!("K_{index}: [1, 0, 0, 0, 1, 0, 0, 0, 1]\n"), "");
    cameras("intri.yml", &yaml);
    let names = keys(&|index| format!("   - \"{index}\"\n"), "");
    cameras("names.yml", &format!("%YAML:1.0\n---\nnames:\n{names}{yaml}"));
    let toml = keys(&|index| format!("[c{index}]\nsize = [1, 1]\n"), "");
    assert!(cameras("keys.toml", &toml).contains("keys.toml"));
    let unknown = keys(&|index| format!("k{index} = 1\n"), "");
    let text = format!("format = \"backlit-body 1\"\nname = \"b\"\n{unknown}");
    let message = answered("body.toml", || model_file::parse(Path::new("body.toml"), text.as_bytes()));
    assert!(message.contains("unknown field `k0`"), "{message}");
    let limbs = keys(&|index| format!("\"l{index}\": [1, 0, 0, 0]"), ",");
    let text = format!("{{\"format\": \"backlit-pose 1\", \"root\": [0, 0, 0], \"rotations\": {{{limbs}}}}}");
    let model = builtin::upper_body();
    let read = || pose_file::parse(Path::new("pose.json"), text.as_bytes(), &model, Quaternions::Raw);
    assert!(answered("pose.json", read).contains("`rotations` names \"l0\""));
}

#[test]
fn tables_of_many_markers_are_refused() {
    let names: String = (0..60_000).map(|index| format!("\tM{index}\t\t")).collect();
    let row = format!("1\t0{}\n", "\t1\t2\t3".repeat(60_000));
    let text = format!("PathFileType\t4\nUnits\nm\nFrame#\tTime{names}\n\t\n\n{}", row.repeat(10));
    let message = answered("many.trc", || trc::parse(Path::new("many.trc"), text.as_bytes()));
    assert!(message.contains("60000 names; expected 1 to 10000"), "{message}");
    let markers: String = (0..60_000).map(|index| format!("M{index} = \"root\"\n")).collect();
    let take = format!(
        "format = \"backlit-take 1\"\nname = \"t\"\nframe_rate = 25\nmodel = \"single_limb\"\n\
         [cameras]\ncalibration = \"c.json\"\n[[camera]]\nname = \"c\"\nmasks = \"%d.png\"\n\
         [reference]\nkeypoints = \"k.csv\"\n[reference.markers]\n{}",
        markers
    );
    let files =
        MemoryFiles::new([("take.toml", take.into_bytes()), ("k.csv", b"frame,marker,x,y,z\n".to_vec())]);
    answered("take.toml", || Take::from_files(Arc::new(files), Path::new("take.toml")));
}

#[test]
fn a_chain_of_256_limbs_is_a_body() {
    let limb = |index: usize| {
        let parent = if index == 0 { String::new() } else { format!("parent = \"l{}\"\n", index - 1) };
        format!("[[limb]]\nname = \"l{index}\"\ndirection = [0, 1, 0]\nlength = 0.1\nradius = 0.1\n{parent}")
    };
    let chain = |count: usize| {
        // The last one first, so that every parent is looked for behind its child.
        let limbs: String = (0..count).rev().map(limb).collect();
        format!("format = \"backlit-body 1\"\nname = \"chain\"\n{limbs}")
    };
    let text = chain(256);
    let mut found = None;
    let message = answered("chain.toml", || {
        model_file::parse(Path::new("chain.toml"), text.as_bytes()).map(|model| found = Some(model))
    });
    assert_eq!(message, "");
    let model = found.unwrap();
    let pose = Pose::rest(&model);
    let again = answered("its pose", || {
        pose_file::parse(
            Path::new("p"),
            pose_file::to_text(&model, &pose).as_bytes(),
            &model,
            Quaternions::Raw,
        )
    });
    assert_eq!(again, "");
    assert_eq!(Kinematics::new(&model, &pose).ends().len(), 256);
    let message = answered("257 limbs", || model_file::parse(Path::new("chain.toml"), chain(257).as_bytes()));
    assert!(message.contains("the model has 257 limbs; expected at most 256"), "{message}");
    let circle = text
        .replacen("parent = \"l0\"", "parent = \"l0\"\n", 1)
        .replace("name = \"l0\"\n", "name = \"l0\"\nparent = \"l255\"\n");
    let message = answered("a circle", || model_file::parse(Path::new("circle.toml"), circle.as_bytes()));
    assert!(message.contains("makes a cycle: l"), "{message}");
}

#[test]
fn long_lines_and_deep_nesting_have_short_messages() {
    let model = builtin::upper_body();
    let pose = |text: &str| {
        answered("pose.json", || {
            pose_file::parse(Path::new("pose.json"), text.as_bytes(), &model, Quaternions::Raw)
        })
    };
    let long = "x".repeat(3_000_000);
    for text in [
        format!("{{\"format\": \"{long}\"}}"),
        format!("{{\"format\": {{\"{long}\": 1}}}}"),
        format!("{{\"format\": \"backlit-pose 1\", \"{long}\": 1}}"),
        format!("{{\"format\": \"backlit-pose 1\", \"root\": \"{long}\"}}"),
        format!(
            "{{\"format\": \"backlit-pose 1\", \"root\": [0, 0, 0], \"rotations\": {{\"{long}\": [1, 0, 0, 0]}}}}"
        ),
        format!(
            "{{\"format\": \"backlit-pose 1\", \"root\": [0, 0, 0], \"rotations\": {{\"a\": {}",
            "[".repeat(3_000_000)
        ),
        format!("{{\"format\": \"backlit-pose 1\", \"root\": {}", "{\"a\":".repeat(100)),
        "[".repeat(3_000_000),
    ] {
        assert!(pose(&text).starts_with("pose.json"), "{}", pose(&text));
    }
    let body =
        |text: &str| answered("body.toml", || model_file::parse(Path::new("body.toml"), text.as_bytes()));
    let long = &long[..900_000];
    for text in [
        format!("format = \"{long}\""),
        format!("format = \"backlit-body 1\"\nname = \"{long}\"\nlimb = []"),
        format!("format = \"backlit-body 1\"\n{long} = 1"),
        format!("format = \"backlit-body 1\"\nname = {}1", "[".repeat(900_000)),
        format!(
            "format = \"backlit-body 1\"\nname = \"b\"\n[[limb]]\nname = \"a\"\nparent = \"{long}\"\ndirection = [0, 1, 0]\nlength = 1\nradius = 1"
        ),
    ] {
        assert!(body(&text).starts_with("body.toml"), "{}", body(&text));
    }
}
