//! CSV tables of a track. Numbers read back to the bit; what is not known or not finite is an empty field.

use std::io::{self, Write};

use backlit_tracking::belief::Verdict;
use backlit_tracking::body::{Kinematics, Model};
use backlit_tracking::track::FrameEstimate;

use super::{ROOT, TrackExport, ending_text};

/// Writes `frame,root x,root y,root z` (metres) and, per rotation, `LIMB w,LIMB x,LIMB y,LIMB z`.
pub fn write_poses(out: &mut dyn Write, export: &TrackExport<'_>) -> io::Result<()> {
    table(out, |rows| {
        let names =
            export.model.rotation_owners().iter().map(|&limb| export.model.limbs()[limb].name.as_str());
        let mut header = vec!["frame".to_owned()];
        header.extend(["x", "y", "z"].map(|axis| format!("{ROOT} {axis}")));
        header.extend(names.flat_map(|name| ["w", "x", "y", "z"].map(|axis| format!("{name} {axis}"))));
        rows.write_record(&header)?;
        for (frame, estimate) in &export.track.frames {
            let numbers = estimate.pose.to_state().into_iter().map(number);
            rows.write_record(std::iter::once(frame.to_string()).chain(numbers))?;
        }
        Ok(())
    })
}

/// Writes `frame,joint,x,y,z` (metres): the root and every limb's second joint. A take reads it as its reference.
pub fn write_joints(out: &mut dyn Write, export: &TrackExport<'_>) -> io::Result<()> {
    let model: &Model = export.model;
    table(out, |rows| {
        rows.write_record(["frame", "joint", "x", "y", "z"])?;
        for (frame, estimate) in &export.track.frames {
            let frame = frame.to_string();
            let kinematics = Kinematics::new(model, &estimate.pose);
            let limbs =
                model.limbs().iter().map(|limb| limb.name.as_str()).zip(kinematics.ends().iter().copied());
            for (joint, position) in std::iter::once((ROOT, estimate.pose.root)).chain(limbs) {
                let [x, y, z] = position.to_array().map(number);
                rows.write_record([&frame, joint, &x, &y, &z])?;
            }
        }
        Ok(())
    })
}

/// Writes `frame,seconds,cost,rms,iterations,lost,termination,doubtful,wrong` and, per camera, `iou CAMERA`.
pub fn write_frames(out: &mut dyn Write, export: &TrackExport<'_>) -> io::Result<()> {
    table(out, |rows| {
        let columns =
            ["frame", "seconds", "cost", "rms", "iterations", "lost", "termination", "doubtful", "wrong"];
        let cameras = export.cameras.iter().map(|camera| format!("iou {camera}"));
        rows.write_record(columns.map(str::to_owned).into_iter().chain(cameras))?;
        for (frame, estimate) in &export.track.frames {
            let iou = |camera: usize| estimate.overlap.get(camera).copied().flatten()?.iou();
            let overlap = (0..export.cameras.len()).map(|camera| iou(camera).map(number).unwrap_or_default());
            let fields = [
                frame.to_string(),
                number(*frame as f64 / export.frame_rate),
                estimate.cost.map(number).unwrap_or_default(),
                estimate.rms.map(number).unwrap_or_default(),
                estimate.iterations.to_string(),
                estimate.is_lost().to_string(),
                estimate.termination.map(ending_text).unwrap_or_default(),
                limbs_text(export, estimate, Verdict::Doubtful),
                limbs_text(export, estimate, Verdict::Wrong),
            ];
            rows.write_record(fields.into_iter().chain(overlap))?;
        }
        Ok(())
    })
}

/// The limbs of a verdict that have a rotation of their own, each with the reason.
fn limbs_text(export: &TrackExport<'_>, estimate: &FrameEstimate, verdict: Verdict) -> String {
    let limbs = export.model.limbs();
    let judged = estimate.judged(export.model, verdict);
    let words: Vec<String> = judged
        .map(|limb| {
            let because = limb.reason.map(|reason| format!(" ({})", reason.text())).unwrap_or_default();
            format!("{}{because}", limbs[limb.limb].name)
        })
        .collect();
    words.join("; ")
}

fn number(value: f64) -> String {
    if value.is_finite() { value.to_string() } else { String::new() }
}

fn table(
    out: &mut dyn Write,
    fill: impl FnOnce(&mut csv::Writer<&mut dyn Write>) -> csv::Result<()>,
) -> io::Result<()> {
    let mut rows = csv::Writer::from_writer(out);
    // Of an error of the disk, what the disk said.
    fill(&mut rows).map_err(|error| match error.into_kind() {
        csv::ErrorKind::Io(error) => error,
        other => io::Error::other(format!("{other:?}")),
    })?;
    rows.flush()
}

#[cfg(test)]
mod tests {
    use backlit_tracking::body::{Pose, builtin};

    use super::super::tests::sample;
    use super::*;

    fn written(write: impl Fn(&mut dyn Write, &TrackExport<'_>) -> io::Result<()>) -> String {
        let (model, track) = (builtin::single_limb(), sample());
        let cameras = ["left, low", "right"];
        let export =
            TrackExport { name: "t", frame_rate: 8.0, model: &model, cameras: &cameras, track: &track };
        let mut out = Vec::new();
        write(&mut out, &export).unwrap();
        String::from_utf8(out).unwrap()
    }

    #[test]
    fn poses_read_back_to_the_bit() {
        let text = written(write_poses);
        let mut rows = csv::Reader::from_reader(text.as_bytes());
        let limb = &builtin::single_limb().limbs()[0].name.clone();
        let header: Vec<String> = rows.headers().unwrap().iter().map(str::to_owned).collect();
        assert_eq!(header[..4], ["frame", "root x", "root y", "root z"]);
        assert_eq!(header[4..], ["w", "x", "y", "z"].map(|axis| format!("{limb} {axis}")));
        let row = rows.records().next().unwrap().unwrap();
        let state: Vec<f64> = row.iter().skip(1).map(|field| field.parse().unwrap()).collect();
        assert_eq!(Pose::from_state(&builtin::single_limb(), &state).unwrap(), sample().frames[&4].pose);
        assert_eq!(&row[0], "4");
    }

    #[test]
    fn joints_are_the_root_and_the_limbs_ends() {
        let text = written(write_joints);
        let mut lines = text.lines();
        assert_eq!(lines.next(), Some("frame,joint,x,y,z"));
        assert_eq!(lines.next(), Some("4,root,0.1,-2,3"));
        assert_eq!(lines.count(), 3);
    }

    #[test]
    fn what_is_not_known_is_empty() {
        let limb = &builtin::single_limb().limbs()[0].name.clone();
        let expected = format!(
            "frame,seconds,cost,rms,iterations,lost,termination,doubtful,wrong,\"iou left, low\",iou right\n\
            4,0.5,1234.5,2.25,7,false,no step lowered the cost,,{limb} (it lies on background),0.75,\n\
            6,0.75,,,0,true,,,,,\n"
        );
        assert_eq!(written(write_frames), expected);
    }
}
