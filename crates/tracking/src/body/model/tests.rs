//! Invalid models, and one in any order.

use super::*;

fn limb(name: &str, parent: Option<&str>) -> LimbSpec {
    let (name, parent, direction) = (name.into(), parent.map(Into::into), DVec3::X);
    LimbSpec { name, parent, direction, length: 0.3, radius: 0.05, ..LimbSpec::default() }
}

fn model(limbs: Vec<LimbSpec>) -> Result<Model, ModelError> {
    Model::new(&ModelSpec { format: FORMAT.into(), name: "test".into(), limbs })
}

fn with_sphere(at: f64, offset: f64) -> LimbSpec {
    let sphere = LimbSphere { at, radius: 0.1, offset: DVec3::splat(offset), parent: None };
    LimbSpec { spheres: vec![sphere], ..limb("a", None) }
}

fn with_limits(most: f64) -> LimbSpec {
    let range = crate::body::Range(-1.0, 1.0);
    let twist = crate::body::Range(-most, most);
    let limits = JointLimits { axis: DVec3::Y, flexion: range, sideways: range, twist };
    LimbSpec { limits: Some(limits), ..limb("a", None) }
}

#[test]
fn errors_name_limb_and_field() {
    let cases: Vec<(Vec<LimbSpec>, &str)> = vec![
        (vec![], "no limb"),
        (vec![limb("a", Some("b"))], "limb \"a\": `parent` names \"b\""),
        (vec![limb("a", Some("b")), limb("b", Some("a"))], "makes a cycle: a → b → a"),
        (vec![limb("a", None), limb("a", None)], "`name` is used twice"),
        (vec![LimbSpec { length: f64::NAN, ..limb("a", None) }], "`length` is NaN"),
        (vec![LimbSpec { radius: 0.0, ..limb("a", None) }], "`radius` is 0"),
        (vec![LimbSpec { direction: DVec3::ZERO, ..limb("a", None) }], "`direction`"),
        (vec![limb("root", None)], "limb 1: `name` is \"root\", which stands for the root; expected another"),
        (vec![limb("a\u{1b}[2J", None)], "limb 1: `name` is \"a\\u{1b}[2J\"; expected 1 to 200 letters"),
        (vec![limb(&"b".repeat(201), None)], "bbb…\"; expected 1 to 200 letters"),
        (vec![limb("a", Some("\u{7}"))], "limb \"a\": `parent` names \"\\u{7}\""),
        (vec![with_sphere(1.1, 0.0)], "`spheres[0]` does not lie on the limb; expected `at` from 0"),
        (vec![with_sphere(-1e-9, 0.0)], "`spheres[0]` does not lie on the limb"),
        (vec![with_sphere(f64::NAN, 0.0)], "`spheres[0]` does not lie on the limb"),
        (vec![with_sphere(0.5, f64::NAN)], "`spheres[0]` lies far off the limb"),
        (vec![with_limits(1e308)], "`limits.twist` is not a range; expected [smallest, largest] in radians"),
        (vec![with_limits(180.0)], "`limits.twist` is not a range"),
        (
            vec![limb("a", Some("b")), LimbSpec { rigid_with: Some("a".into()), ..limb("b", None) }],
            "`parent` = \"a\" makes a cycle",
        ),
        (
            vec![LimbSpec { rigid_with: Some("a".into()), ..limb("a", None) }],
            "`rigid_with` = \"a\" makes a cycle",
        ),
    ];
    for (limbs, expected) in cases {
        let message = model(limbs).unwrap_err().to_string();
        assert!(message.contains(expected), "{message:?} should contain {expected:?}");
    }
}

#[test]
fn a_child_may_stand_before_its_parent() {
    let model = model(vec![limb("hand", Some("arm")), limb("arm", None)]).unwrap();
    assert_eq!(model.limbs()[0].name, "arm");
    assert_eq!(model.limbs()[1].parent, Some(0));
    // Columns of the state keep the file's order.
    assert_eq!(model.rotation_owners(), [1, 0]);
    assert_eq!(model.rotation_parents(), [Some(1), None]);
}

#[test]
fn a_model_survives_its_own_file() {
    let body = crate::body::builtin::full_body();
    assert_eq!(Model::new(&body.to_spec()).unwrap(), body);
    // Also where children stand before their parents: columns of the state are counted in the file's order.
    let hand = || limb("hand", Some("arm"));
    for limbs in [
        vec![hand(), limb("arm", None), limb("leg", None)],
        vec![limb("leg", None), hand(), limb("arm", None)],
    ] {
        let model = model(limbs.clone()).unwrap();
        assert_eq!(model.to_spec().limbs, limbs);
        assert_eq!(Model::new(&model.to_spec()).unwrap(), model);
    }
}
