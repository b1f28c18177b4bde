//! Every reader, with what it begins from and what must hold of what it read.

mod takes;
mod texts;

use std::path::Path;

use backlit_formats::video::Video;
use backlit_formats::{FileParts, mesh, motion, trc};

use crate::engine::{Outcome, Target};
use crate::mutate::Syntax::{self, Binary, Text};
use crate::seeds::kept;

// Words of the formats, between `¦`.
const BODY: &str = "[[limb]]\n¦parent = \"torso\"\n¦rigid_with = \"torso\"\n¦limits¦spheres¦root¦at¦offset";
const POSE: &str = r#""root"¦"rotations"¦[1, 0, 0, 0]¦"left hip""#;
const BVH: &str = "JOINT a\n{¦End Site\n{¦}\n¦CHANNELS 3 Xposition Yposition Zposition¦MOTION¦Frames: 2";
const PRIOR: &str = r#""parts"¦"components"¦"covariance"¦"right-thigh"¦"chest-up""#;
const CAMERAS: &str = "cameras¦size¦fx¦rotation¦translation¦distortion¦name¦data:¦rows:¦- ¦  ¦---¦!!opencv-matrix¦|¦&a¦*a¦\
    <<: *a¦fisheye = true¦\"format\": \"backlit-cameras 1\"¦<a>¦</a>¦<![CDATA[¦<!--¦-->¦<!DOCTYPE a [<!ENTITY b \"c\">]>¦&b;¦\
    type_id=\"opencv-matrix\"¦T_cn_cnm1";
const TAKE: &str = "[[camera]]\n¦${HOME}¦${X:-a}¦../¦%02d.png¦{}¦{:03}.png¦shadow = [1]¦region = false¦closing_px¦opening_px¦last¦\
    offset_seconds¦\"mm\"¦\"alpha\"¦1979-05-27";
const CHUNKS: &str = "IHDR¦IDAT¦IEND¦PLTE¦tRNS¦acTL¦RIFF¦VP8L¦VP8X¦II*\0¦BM";
const PLY: &str = "element face 4000000000\n¦property list double double a\n¦ascii¦comment\n";
const GLTF: &str = r#""children": [0]¦"byteStride": 0¦4294967295¦"indices": 0¦5125"#;
const BOXES: &str = "moov¦trak¦mdia¦minf¦stbl¦stsd¦stts¦ctts¦stsz¦stsc¦stco¦co64¦elst¦avc1¦avcC¦moof¦traf¦trun¦tfhd¦mvex¦\
    trex¦RIFF¦LIST¦movi¦00dc¦idx1¦MJPG¦jpeg";

fn row(
    name: &'static str,
    syntax: Syntax,
    words: &'static str,
    short: u64,
    read: fn(&[u8]) -> Outcome,
) -> Target {
    Target { name, syntax, seeds: kept(name, false), words, read, short }
}

/// All targets.
pub(crate) fn all() -> Vec<Target> {
    let sized =
        ["calibration_yaml", "calibration_json", "calibration_sized"].map(|name| kept(name, false)).concat();
    vec![
        row("model", Text, BODY, 1000, texts::model),
        row("pose", Text, POSE, 1000, texts::pose),
        row("starts", Text, POSE, 1000, texts::starts),
        row("bvh", Text, BVH, 1000, texts::bvh_motion),
        row("prior", Text, PRIOR, 1000, texts::prior),
        row("placement", Text, "\"offsets\"¦\"root\"", 1000, texts::placement),
        row("track", Text, POSE, 400, texts::track),
        row("resume", Text, "\"waiting\"¦null¦\"belief\"", 1000, texts::resume),
        row("keypoints", Text, "\"people\"", 1000, texts::keypoint_file),
        row("markers", Text, "\t\t¦Units", 1000, |b| trc::parse(Path::new("markers.trc"), b).into()),
        row("recording_csv", Text, "joint¦_x¦seconds¦,,", 1000, |b| texts::recording("a.csv", b)),
        row("recording_mot", Text, "endheader\n¦inDegrees=yes\n¦time", 1000, |b| {
            texts::recording("a.mot", b)
        }),
        row("recording_c3d", Binary, "POINT¦LABELS2¦UNITS", 1000, |b| texts::recording("a.c3d", b)),
        row("recording_npz", Binary, "PK\x01\x02¦'shape': (1,)¦<U4¦joint_names", 1000, |b| {
            texts::recording("a.npz", b)
        }),
        row("labels", Text, "file¦class¦,,", 1000, |b| {
            motion::parse_labels(Path::new("labels.csv"), b).into()
        }),
        row("cameras", Text, CAMERAS, 1000, texts::cameras),
        row("calibration_json", Text, CAMERAS, 1000, texts::cameras),
        row("calibration_yaml", Text, CAMERAS, 1000, texts::cameras),
        row("calibration_xml", Text, CAMERAS, 1000, texts::cameras),
        row("calibration_toml", Text, CAMERAS, 1000, texts::cameras),
        Target { seeds: sized, ..row("calibration_sized", Text, CAMERAS, 1000, texts::sized) },
        row("easymocap", Text, CAMERAS, 1000, |b| {
            texts::pair("intri.yml", b, "extri.yml", "beside/extri.yml")
        }),
        row("colmap_cameras", Text, CAMERAS, 1000, |b| {
            texts::pair("cameras.txt", b, "images.txt", "colmap_images/images.txt")
        }),
        row("colmap_images", Text, CAMERAS, 1000, |b| {
            texts::pair("images.txt", b, "cameras.txt", "colmap_cameras/cameras.txt")
        }),
        row("pickle", Binary, "cos\nsystem\n¦}(¦u.", 1000, texts::cameras),
        row("take", Text, TAKE, 400, |b| takes::take("take.toml", b)),
        row("reference", Text, "root¦limb¦\"\"¦\r\n", 400, |b| takes::take("keypoints.csv", b)),
        row("start", Text, "", 400, |b| takes::take("start.json", b)),
        row("masks", Binary, CHUNKS, 400, |b| takes::take("m1.png", b)),
        row("png", Binary, CHUNKS, 1000, takes::picture),
        row("jpeg", Binary, CHUNKS, 1000, takes::picture),
        row("tiff", Binary, CHUNKS, 1000, takes::picture),
        row("webp", Binary, CHUNKS, 1000, takes::picture),
        row("bmp", Binary, CHUNKS, 1000, takes::picture),
        row("mesh_obj", Text, "f 1 2 3 4 1\n¦v 1 1 1\n¦-5", 500, |b| mesh_of("a.obj", b)),
        row("mesh_stl", Binary, "solid¦vertex 0 0 0\n¦endloop\n", 500, |b| mesh_of("a.stl", b)),
        row("mesh_ply", Binary, PLY, 500, |b| mesh_of("a.ply", b)),
        row("mesh_glb", Binary, GLTF, 500, |b| mesh_of("a.glb", b)),
        row("mesh_gltf", Text, GLTF, 500, |b| mesh_of("a.gltf", b)),
        row("mesh_skin", Binary, GLTF, 500, |b| mesh::parse_skin(Path::new("a.glb"), b).into()),
        row("mp4", Binary, BOXES, 400, video),
        row("avi", Binary, BOXES, 400, video),
    ]
}

fn mesh_of(name: &str, bytes: &[u8]) -> Outcome {
    mesh::parse(Path::new(name), bytes).into()
}

/// Frames of one case that are decoded.
const FRAMES: usize = 6;

fn video(bytes: &[u8]) -> Outcome {
    let opened = Video::decoded_here(FileParts::in_memory(bytes.to_vec()), Path::new("film"));
    let Ok(video) = &opened else { return opened.into() };
    let count = video.frame_count();
    assert!(count > 0 && video.seconds().windows(2).all(|pair| pair[0] <= pair[1]));
    let rate = video.frame_rate();
    assert!(rate.is_none_or(|rate| rate > 0.0 && rate.is_finite()), "{rate:?}");
    let mut answer = Outcome::Read;
    for frame in (0..count.min(FRAMES)).chain([count - 1]) {
        match video.frame_reduced(frame, 2) {
            Ok(picture) => {
                // A divisor that is larger than a side counts as that side.
                let divisor = 2.min(video.size()[0].min(video.size()[1]));
                let size = video.size().map(|side| side / divisor);
                assert_eq!([picture.width() as usize, picture.height() as usize], size);
            }
            Err(error) => answer = Outcome::Refused(error.to_string()),
        }
    }
    if let Some(note) = video.notes().into_iter().next() {
        answer = Outcome::Refused(note);
    }
    answer
}
