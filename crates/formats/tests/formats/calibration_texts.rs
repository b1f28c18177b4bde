//! Small calibrations of every format, written for these tests: what is read of them, and what is wrong with bad ones.

use std::path::Path;

use backlit_formats::calibration::{self, CalibrationOptions, SkippedCamera};
use backlit_tracking::camera::{Camera, Distortion, Rig};
use glam::DVec3;

use crate::damaged::assert_refused;

const SIZE: Option<[u64; 2]> = Some([640, 480]);

fn read(name: &str, text: &str, size: Option<[u64; 2]>) -> Result<Rig, String> {
    let options = CalibrationOptions { size, ..CalibrationOptions::default() };
    calibration::parse(Path::new(name), text.as_bytes(), options).map_err(|error| error.to_string())
}

fn assert_camera(camera: &Camera, name: &str, pinhole: [f64; 4], centre: [f64; 3]) {
    let k = camera.intrinsics();
    assert_eq!((camera.name(), camera.width(), camera.height()), (name, 640, 480));
    for (found, wanted) in [k.fx, k.fy, k.cx, k.cy].into_iter().zip(pinhole) {
        assert!((found - wanted).abs() < 1e-9, "{name}: {k:?}");
    }
    assert!(camera.centre().distance(DVec3::from_array(centre)) < 1e-9, "{name}: {}", camera.centre());
}

/// Looks along the world's x axis, z up, from (−2, 1, 0.5): the translation is (1, 0.5, 2).
const LOOKING: &str = "[[0, -1, 0], [0, 0, -1], [1, 0, 0]]";

const OPENCV_YAML: &str = "%YAML:1.0\n---\nimage_Width: 640\nimage_Height: 480\nCamera_Matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   data: [ 500., 0., 320., 0., 501., 240.,\n       0., 0., 1. ]\nDistortion_Coefficients: !!opencv-matrix\n   rows: 5\n   cols: 1\n   dt: d\n   data: [ -1e-01, 2.e-02, 0., 0., 0. ]\nExtrinsic_Parameters: !!opencv-matrix\n   rows: 1\n   cols: 6\n   dt: d\n   data: [ 1., 2., 3., 4., 5., 6. ]\n";

#[test]
fn opencv_s_storage_is_read_in_both_spellings() {
    let lower = OPENCV_YAML
        .replace("%YAML:1.0\n", "%YAML 1.0\n")
        .replace("Camera_Matrix", "camera_matrix")
        .replace("Distortion_Coefficients", "distortion_coefficients")
        .replace("image_W", "image_w")
        .replace("image_H", "image_h");
    for text in [OPENCV_YAML, &lower] {
        let rig = read("front.yml", text, None).unwrap();
        // The board's places are no places of cameras.
        assert_camera(&rig.cameras()[0], "front", [500.0, 501.0, 320.0, 240.0], [0.0; 3]);
        assert!(matches!(rig.cameras()[0].distortion(), Distortion::OpenCv { k1: -0.1, k2: 0.02, .. }));
    }
    assert_refused(
        OPENCV_YAML,
        |text| read("front.yml", text, None),
        r#"
        501. ⇒ .Nan ⇒ front.yml, line 9: `Camera_Matrix.data[4]` is .Nan; expected a finite number
        0., 0., 1. ] ⇒ 0., 1. ] ⇒ `Camera_Matrix.data` is 8 numbers; expected 3 × 3
        rows: 5\n   cols: 1\n   dt: d\n   data: [ -1e-01, 2.e-02, 0., 0., 0. ] ⇒ rows: 3\n   cols: 1\n   dt: d\n   data: [ -1e-01, 2.e-02, 0. ] ⇒ `Distortion_Coefficients` is 3 numbers; expected 4, 5, 8
        image_Width: 640\n ⇒ ⇒ `cameras.front.size` is missing; expected the pictures' width
        [ 500., 0., ⇒ [ 500., 3., ⇒ `Camera_Matrix` is another matrix
        %YAML:1.0\n---\nnothing: 1\n ⇒ front.yml: cannot be recognised as a calibration
        "#,
    );
    let cut = &OPENCV_YAML[..OPENCV_YAML.find("501.").unwrap()];
    assert!(read("front.yml", cut, None).unwrap_err().contains("is not valid YAML: the text ends too early"));
    let fisheye = OPENCV_YAML.replace("image_Width", "fisheye_model: 1\nimage_Width");
    assert!(matches!(
        read("c.yml", &fisheye, None).unwrap().cameras()[0].distortion(),
        Distortion::Fisheye { k1: -0.1, k2: 0.02, k3: 0.0, k4: 0.0 }
    ));
}

#[test]
fn opencv_s_xml_and_json_are_read() {
    let xml = "<?xml version=\"1.0\"?>\n<!-- <x> -->\n<opencv_storage>\n<image_width>640</image_width><image_height>480</image_height>\n<camera_matrix type_id=\"opencv-matrix\"><rows>3</rows><cols>3</cols><dt>d</dt><data>\n 500. 0. 320. 0. 501. 240. 0. 0. 1.</data></camera_matrix>\n<distortion_coefficients type_id=\"opencv-matrix\"><rows>1</rows><cols>8</cols><dt>d</dt><data>0.1 0. 0. 0. 0. 0.2 0. 0.</data></distortion_coefficients>\n</opencv_storage>";
    let rig = read("top.xml", xml, None).unwrap();
    assert_camera(&rig.cameras()[0], "top", [500.0, 501.0, 320.0, 240.0], [0.0; 3]);
    assert!(matches!(rig.cameras()[0].distortion(), Distortion::Rational { k1: 0.1, k4: 0.2, .. }));
    let message = read("top.xml", &xml.replace("501.", "nan"), None).unwrap_err();
    assert!(message.contains("line 5") || message.contains("line 6"), "{message}");
    assert!(read("top.xml", &xml[..300], None).unwrap_err().contains("is not valid XML"));

    let json = format!(
        "{{\"b\": {{\"image_size\": [480, 640, 3], \"mtx\": [[500, 0, 320], [0, 501, 240], [0, 0, 1]], \"dist\": [[0, 0, 0, 0, 0]], \"R\": {LOOKING}, \"t\": [[1], [0.5], [2]]}},\n \"a\": {{\"image_width\": 640, \"image_height\": 480, \"K\": {{\"type_id\": \"opencv-matrix\", \"rows\": 3, \"cols\": 3, \"dt\": \"d\", \"data\": [500, 0, 320, 0, 501, 240, 0, 0, 1]}}, \"rvec\": [0, 0, 0], \"tvec\": [0, 0, 4]}}}}"
    );
    let rig = read("c.json", &json, None).unwrap();
    assert_camera(&rig.cameras()[0], "b", [500.0, 501.0, 320.0, 240.0], [-2.0, 1.0, 0.5]);
    assert_camera(&rig.cameras()[1], "a", [500.0, 501.0, 320.0, 240.0], [0.0, 0.0, -4.0]);
    let message = read("c.json", &json.replace("\"tvec\"", "\"vec\""), None).unwrap_err();
    assert!(message.contains("line 2: `a.t` is missing; expected three numbers"), "{message}");
    let flat = r#"{"width": 640, "height": 480, "fx": 500, "fy": 501, "cx": 320, "cy": 240, "k1": 0.01}"#;
    assert_camera(
        &read("f.json", flat, None).unwrap().cameras()[0],
        "f",
        [500.0, 501.0, 320.0, 240.0],
        [0.0; 3],
    );
    assert!(
        read("f.json", &flat.replace("\"fy\": 501, ", ""), None).unwrap_err().contains("`fy` is missing")
    );
}

const TOML: &str = "[cam_0]\nname = \"A\"\nsize = [ 640.0, 480,]\nmatrix = [ [ 500.0, 0.0, 320.0,], [ 0.0, 501.0, 240.0,], [ 0.0, 0.0, 1.0,],]\ndistortions = [ -0.1, 0.0, 0.0, 0.0,]\nrotation = [ 0.0, 0.0, 0.0,]\ntranslation = [ 0.0, 0.0, 3000.0,]\nfisheye = true\n\n[metadata]\nerror = 0.1\n";

#[test]
fn toml_of_anipose_pose2sim_and_freemocap_is_read() {
    let millimetres = CalibrationOptions { metres_per_unit: 0.001, ..CalibrationOptions::default() };
    let rig = calibration::parse(Path::new("c.toml"), TOML.as_bytes(), millimetres).unwrap();
    assert_camera(&rig.cameras()[0], "A", [500.0, 501.0, 320.0, 240.0], [0.0, 0.0, -3.0]);
    assert!(matches!(rig.cameras()[0].distortion(), Distortion::Fisheye { k1: -0.1, .. }));
    let pose2sim = TOML.replace("[cam_0]", "[A]").replace("3000.0", "3.0").replace("true", "false");
    let rig = read("c.toml", &pose2sim, None).unwrap();
    assert_camera(&rig.cameras()[0], "A", [500.0, 501.0, 320.0, 240.0], [0.0, 0.0, -3.0]);
    assert!(matches!(rig.cameras()[0].distortion(), Distortion::OpenCv { k1: -0.1, .. }));
    // FreeMoCap says how large the board's squares are: in millimetres, unless they are the unit.
    let mocap = TOML.replace("error = 0.1", "charuco_square_size = 39.0");
    let rig = read("c.toml", &mocap, None).unwrap();
    assert_camera(&rig.cameras()[0], "A", [500.0, 501.0, 320.0, 240.0], [0.0, 0.0, -3.0]);
    assert_refused(
        TOML,
        |text| read("c.toml", text, None),
        r#"
        distortions ⇒ distortion_s ⇒ line 1: `cam_0.distortions` is missing
        matrix ⇒ mat ⇒ `cam_0.matrix` is missing
        501.0 ⇒ nan ⇒ line 4: `cam_0.matrix[1][1]` is nan; expected a finite number
        rotation = [ 0.0, 0.0, ⇒ rotation = [ 0.0, ⇒ `cam_0.rotation` is 2 numbers
        [ 640.0, 480,] ⇒ [ 640.5, 480,] ⇒ `cam_0.size` is 640.5; expected a whole number
        [charuco]\ncolumns = 4\n ⇒ cannot be recognised as a calibration
        "#,
    );
    assert!(read("c.toml", &TOML[..60], None).unwrap_err().contains("is not valid TOML"));
}

#[test]
fn caliscope_s_cameras_without_a_place_are_left_out() {
    let camera = |id: u32, place: &str| {
        format!(
            "[cameras.{id}]\ncam_id ={id}\nrotation_count = 1\nsize = [640, 480]\nmatrix = [[500.0, 0.0, 320.0], [0.0, 501.0, 240.0], [0.0, 0.0, 1.0]]\ndistortions = [0.0, 0.0, 0.0, 0.0, 0.0]\n{place}\n"
        )
    };
    let text = camera(0, &format!("rotation = {LOOKING}\ntranslation = [1, 0.5, 2]")) + &camera(1, "");
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("camera_array.toml");
    std::fs::write(&path, &text).unwrap();
    // The folder will do.
    let found = calibration::load(folder.path(), CalibrationOptions::default()).unwrap();
    assert_eq!(found.rig.count(), 1);
    assert_camera(&found.rig.cameras()[0], "0", [500.0, 501.0, 320.0, 240.0], [-2.0, 1.0, 0.5]);
    assert_eq!(
        found.left_out,
        [SkippedCamera { name: "1".to_owned(), reason: "the file has no place of it".to_owned() }]
    );
}

#[test]
fn easymocap_s_two_files_are_joined() {
    let matrix = |key: &str, rows: u32, data: &str| {
        let columns = data.split(',').count() as u32 / rows;
        format!(
            "{key}: !!opencv-matrix\n   rows: {rows}\n   cols: {columns}\n   dt: d\n   data: [ {data} ]\n"
        )
    };
    let head = "%YAML:1.0\n---\nnames:\n   - \"7\"\n   - \"x\"\n";
    let k = "500., 0., 320., 0., 501., 240., 0., 0., 1.";
    let intri = head.to_owned()
        + &matrix("K_7", 3, k)
        + &matrix("dist_7", 1, "0.1, 0., 0., 0., 0.")
        + &matrix("K_x", 3, k);
    let extri = head.replace("   - \"x\"\n", "")
        + &matrix("R_7", 3, "9., 9., 9.")
        + &matrix("Rot_7", 3, "0., -1., 0., 0., 0., -1., 1., 0., 0.")
        + &matrix("T_7", 3, "1., 0.5, 2.");
    let folder = tempfile::tempdir().unwrap();
    let [a, b] = ["intri.yml", "extri.yml"].map(|name| folder.path().join(name));
    std::fs::write(&a, &intri).unwrap();
    let options = CalibrationOptions { size: SIZE, ..CalibrationOptions::default() };
    let alone = calibration::read(&a, options).unwrap_err().to_string();
    assert!(alone.contains("`cameras.7.rotation` is missing; expected the cameras' places"), "{alone}");
    std::fs::write(&b, &extri).unwrap();
    let found = calibration::load(&a, options).unwrap();
    assert_camera(&found.rig.cameras()[0], "7", [500.0, 501.0, 320.0, 240.0], [-2.0, 1.0, 0.5]);
    assert_eq!((found.rig.count(), found.left_out[0].name.as_str()), (1, "x"));
    assert_eq!(
        calibration::load_pair(&a, &b, options).unwrap(),
        calibration::load_pair(&b, &a, options).unwrap()
    );
    let message = calibration::load_pair(&a, &b, CalibrationOptions::default()).unwrap_err().to_string();
    assert!(message.contains("`cameras.7.size` is missing"), "{message}");
    let message = read("extri.yml", &extri, SIZE).unwrap_err();
    assert!(message.contains("`cameras.7.K` is missing; expected the cameras' lenses"), "{message}");
}

const KALIBR: &str = "cam0:\n  camera_model: pinhole\n  intrinsics: [500, 501, 320, 240]\n  distortion_model: equidistant\n  distortion_coeffs: [0.1, 0, 0, 0]\n  resolution: [640, 480]\ncam1:\n  T_cn_cnm1:\n  - [1, 0, 0, -0.5]\n  - [0, 1, 0, 0]\n  - [0, 0, 1, 0]\n  - [0, 0, 0, 1]\n  camera_model: omni\n  intrinsics: [0.8, 500, 501, 320, 240]\n  distortion_model: radtan\n  distortion_coeffs: [0, 0, 0, 0]\n  resolution: [640, 480]\ncam2:\n  T_cn_cnm1:\n  - [1, 0, 0, 0]\n  - [0, 1, 0, 0.25]\n  - [0, 0, 1, 0]\n  - [0, 0, 0, 1]\n  camera_model: pinhole\n  intrinsics: [500, 501, 320, 240]\n  distortion_model: radtan\n  distortion_coeffs: [0.1, 0, 0, 0]\n  timeshift_cam_imu:\n  resolution: [640, 480]\n";

#[test]
fn kalibr_s_chain_is_followed_past_cameras_that_are_left_out() {
    let rig = read("camchain.yaml", KALIBR, None).unwrap();
    assert_eq!(rig.count(), 2);
    assert_camera(&rig.cameras()[0], "cam0", [500.0, 501.0, 320.0, 240.0], [0.0; 3]);
    assert_camera(&rig.cameras()[1], "cam2", [500.0, 501.0, 320.0, 240.0], [0.5, -0.25, 0.0]);
    assert!(matches!(rig.cameras()[0].distortion(), Distortion::Fisheye { .. }));
    assert_refused(
        KALIBR,
        |text| read("camchain.yaml", text, None),
        r#"
        T_cn_cnm1:\n  - [1, 0, 0, -0.5] ⇒ T_cn_cnm1: ⇒ `cam1.T_cn_cnm1` is 12 numbers; expected 16
        T_cn_cnm1: ⇒ T_other: ⇒ `cam1.T_cn_cnm1` is missing
        [500, 501, 320, 240] ⇒ [500, 501, 320] ⇒ line 3: `cam0.intrinsics` is 3 numbers; expected 4
        "#,
    );
}

#[test]
fn ros_s_lens_has_no_place() {
    let text = "image_width: 640\nimage_height: 480\ncamera_name: 0810\ncamera_matrix:\n  rows: 3\n  cols: 3\n  data: [500, 0, 320, 0, 501, 240, 0, 0, 1]\ndistortion_model: plumb_bob\ndistortion_coefficients:\n  rows: 1\n  cols: 5\n  data: [0.1, 0, 0, 0, 0]\nrectification_matrix:\n  rows: 3\n  cols: 3\n  data: [0, 1, 0, 0, 0, 1, 1, 0, 0]\n";
    let rig = read("info.yaml", text, None).unwrap();
    assert_camera(&rig.cameras()[0], "0810", [500.0, 501.0, 320.0, 240.0], [0.0; 3]);
    let message = read("info.yaml", &text.replace("plumb_bob", "scaramuzza"), None).unwrap_err();
    assert!(message.contains("line 8: `distortion_model` is scaramuzza; expected plumb_bob"), "{message}");
}

#[test]
fn colmap_s_pixels_are_half_a_pixel_off() {
    let cameras = "# cameras\n1 SIMPLE_RADIAL 640 480 500 320.5 240.5 0.1\n2 OPENCV_FISHEYE 640 480 500 501 320.5 240.5 0.1 0 0 0\n";
    let half = "0.5 -0.5 0.5 -0.5";
    let images = format!(
        "# images\n5 1 0 0 0 0 0 3 1 a b.png\n\n6 {half} 0 0 3 2 c.png\n1.5 2.5 -1 3.5 4.5 7\n7 1 0 0 0 0 0 4 1 d.png\n"
    );
    let folder = tempfile::tempdir().unwrap();
    let [a, b] = ["cameras.txt", "images.txt"].map(|name| folder.path().join(name));
    std::fs::write(&a, cameras).unwrap();
    std::fs::write(&b, &images).unwrap();
    let rig = calibration::read(&a, CalibrationOptions::default()).unwrap();
    assert_eq!(rig, calibration::read(&b, CalibrationOptions::default()).unwrap());
    assert_eq!(rig.count(), 3);
    assert_camera(&rig.cameras()[0], "a b.png", [500.0, 500.0, 320.0, 240.0], [0.0, 0.0, -3.0]);
    assert!(matches!(rig.cameras()[1].distortion(), Distortion::Fisheye { .. }));
    let refused = |text: &str| read("c.txt", text, None);
    assert_refused(
        cameras,
        refused,
        r#"
        0.1\n2 ⇒ \n2 ⇒ line 2: `PARAMS` is 3 numbers; expected 4 numbers for SIMPLE_RADIAL
        SIMPLE_RADIAL ⇒ FOV ⇒ line 2: `MODEL` is FOV
        640 480 500 ⇒ 640 480 NaN ⇒ `PARAMS[0]` is NaN
        "#,
    );
    assert_refused(
        &images,
        refused,
        "1 0 0 0 0 0 3 1 a ⇒ 1 1 1 1 0 0 3 1 a ⇒ line 2: `QW QX QY QZ` is of length 2",
    );
}

#[test]
fn transforms_have_opengl_s_axes() {
    // At (0, 0, 5), looking down: OpenGL's camera without a turn looks along −z.
    let text = r#"{"camera_angle_x": 1.2, "frames": [
  {"file_path": "a.png", "transform_matrix": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 5], [0, 0, 0, 1]]},
  {"file_path": "b.png", "w": 640, "h": 480, "fl_x": 500, "fl_y": 501, "cx": 320.5, "cy": 240.5, "k1": 0.1,
    "transform_matrix": [[1, 0, 0, 2], [0, 1, 0, 0], [0, 0, 1, 5], [0, 0, 0, 1]]}]}"#;
    let rig = read("transforms.json", text, SIZE).unwrap();
    let focal = 320.0 / 0.6_f64.tan();
    assert_camera(&rig.cameras()[0], "a.png", [focal, focal, 319.5, 239.5], [0.0, 0.0, 5.0]);
    assert_camera(&rig.cameras()[1], "b.png", [500.0, 501.0, 320.0, 240.0], [2.0, 0.0, 5.0]);
    assert_eq!(rig.cameras()[0].depth(DVec3::ZERO), 5.0);
    // What is up in the world is up in the picture.
    assert!(rig.cameras()[0].project(DVec3::Y).unwrap().y < 239.0);
    assert_refused(
        text,
        |text| read("transforms.json", text, SIZE),
        r#"
        0, 0, 1, 5] ⇒ 0, 0, 2, 5] ⇒ line 2: `frames[0].transform_matrix` is a matrix that mirrors
        "camera_angle_x": 1.2 ⇒ "camera_angle_x": 4 ⇒ `camera_angle_x` is 4; expected an angle
        "file_path": "b.png" ⇒ "path": "b" ⇒ line 3: `frames[1].file_path` is missing
        b.png ⇒ a.png ⇒ camera name "a.png" is used twice
        "#,
    );
    let frame = r#"{"file_path": "a", "transform_matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 5]}"#;
    let many = format!("{{\"camera_angle_x\": 1, \"frames\": [{}]}}", vec![frame; 4001].join(","));
    assert!(read("t.json", &many, SIZE).unwrap_err().contains("`cameras` is more than 4000"));
}

const VICON: &str = r#"<?xml version="1.0"?>
<Cameras SOURCE="x">
  <Camera DEVICEID="1" SYSTEM="MX" SENSOR_SIZE="what"/>
  <Camera DEVICEID="2" SYSTEM="DV" SENSOR_SIZE="640 480" PIXEL_ASPECT_RATIO="1"><KeyFrames>
    <KeyFrame FOCAL_LENGTH="500" PRINCIPAL_POINT="320 240" ORIENTATION="0 0 0 1" POSITION="0 0 -3000"
      VICON_RADIAL2="Vicon3Parameter 320 240 1e-7 0 0"/></KeyFrames></Camera>
</Cameras>"#;

#[test]
fn vicon_s_filming_cameras_are_read() {
    let rig = read("c.xcp", VICON, None).unwrap();
    assert_eq!(rig.count(), 1);
    assert_camera(&rig.cameras()[0], "2", [500.0, 500.0, 320.0, 240.0], [0.0, 0.0, -3.0]);
    // Measured (0, 0) is 400 px from the centre: ideal is 1.6 % farther.
    let ideal = glam::DVec2::new(-320.0, -240.0) * 1.016 / 500.0;
    let bent = rig.cameras()[0].distortion().distort(ideal) * 500.0;
    assert!(bent.distance(glam::DVec2::new(-320.0, -240.0)) < 0.01, "{bent}");
    assert_refused(
        VICON,
        |text| read("c.xcp", text, None),
        r#"
        "0 0 0 1" ⇒ "0 0 1" ⇒ `KeyFrame.ORIENTATION` is "0 0 1"; expected 4 finite numbers
        FOCAL_LENGTH="500" ⇒ ⇒ `KeyFrame.FOCAL_LENGTH` is missing
        "DV" ⇒ "MX" ⇒ expected a camera that can be used (it only sees markers)
        "#,
    );
}

#[test]
fn what_is_too_large_or_of_another_kind_is_refused() {
    let long = "#".repeat((8 << 20) + 1);
    assert!(read("c.yml", &long, None).unwrap_err().contains("has more than 8388608 bytes"));
    assert!(
        read("c.mat", "MATLAB 5.0 MAT-file, of 2019", None)
            .unwrap_err()
            .contains("MATLAB's files are not read")
    );
    let values = format!("%YAML:1.0\n---\na: [{}1]\n", "1,".repeat(1_000_001));
    assert!(read("c.yml", &values, None).unwrap_err().contains("more than 1000000 values"));
    let pickle = b"\x80\x03cos\nsystem\nX\x02\x00\x00\x00ls\x85R.";
    let error = calibration::parse(Path::new("c.pickle"), pickle, CalibrationOptions::default()).unwrap_err();
    assert!(error.to_string().contains("it asks for os.system"), "{error}");
}

/// `OpenPose` names a file after its camera's serial number and says no size; `config.xml` lies in its camera's folder.
#[test]
fn a_file_of_each_camera_is_read() {
    let text = include_str!("../../fuzz/corpus/calibration_sized/openpose.xml");
    let rig = read("cameras/17012332.xml", text, SIZE).unwrap();
    assert_camera(&rig.cameras()[0], "17012332", [500.0, 501.0, 320.0, 240.0], [-2.0, 1.0, 0.5]);
    assert!(matches!(rig.cameras()[0].distortion(), Distortion::OpenCv { k1: -0.1, .. }));
    assert_refused(
        text,
        |text| read("1.xml", text, SIZE),
        r#"
        <cols>4</cols> ⇒ <cols>3</cols> ⇒ 1.xml, line 7: `CameraMatrix.data` is 12 numbers
        0. -1. 0. 1. ⇒ 0. -2. 0. 1. ⇒ 1.xml, line 2: camera "1"
        "#,
    );
    let config = include_str!("../../fuzz/corpus/calibration_sized/config.xml");
    let rig = read("data/cam2/config.xml", config, SIZE).unwrap();
    assert_eq!(rig.cameras()[0].name(), "cam2");
    assert!(rig.cameras()[0].centre().length() > 2.0);
    let folder = tempfile::tempdir().unwrap();
    let paths = ["1.xml", "2.xml", "3.xml"].map(|name| folder.path().join(name));
    let second = text.replace("5.0e-01", "7.0e-01");
    for (path, text) in paths.iter().zip([text, &second, text]) {
        std::fs::write(path, text).unwrap();
    }
    let options = CalibrationOptions { size: SIZE, metres_per_unit: 0.1 };
    let found = calibration::load_all(&paths[..2], options).unwrap();
    assert_eq!((found.rig.count(), found.left_out.len()), (2, 0));
    assert_camera(&found.rig.cameras()[1], "2", [500.0, 501.0, 320.0, 240.0], [-0.2, 0.1, 0.07]);
    assert_eq!(calibration::load_all(&paths, options).unwrap().rig.count(), 3);
}

#[test]
fn a_caliscope_camera_without_a_pose_is_left_out() {
    let text = include_str!("../../fuzz/corpus/calibration_toml/camera_array.toml");
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("camera_array.toml");
    for poseless in ["", "rotation = \"null\"\ntranslation = []\n", "translation = [nan, nan, nan]\n"] {
        std::fs::write(&path, format!("{text}{poseless}")).unwrap();
        let found = calibration::load(&path, CalibrationOptions::default()).unwrap();
        assert_eq!(found.rig.count(), 1, "{poseless}");
        let left = SkippedCamera { name: "1".into(), reason: "the file has no place of it".into() };
        assert_eq!(found.left_out, [left]);
    }
}
