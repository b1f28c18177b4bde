//! Silhouettes as paths.

use backlit_tracking::silhouette::{Label, Mask, contours};

/// The border of a mask's subject as an SVG path, in pixels whose corners are at integers: filled by the nonzero rule it is the
/// subject.
///
/// ```
/// use backlit_report::outline;
/// use backlit_tracking::silhouette::{Label, Mask};
///
/// let mask = Mask::from_ascii(".##?")?;
/// assert_eq!(outline::path(&mask, Label::Subject), "M1 0h2v1h-2z");
/// assert_eq!(outline::path(&mask, Label::Unknown), "M3 0h1v1h-1z");
/// # Ok::<(), backlit_tracking::silhouette::MaskError>(())
/// ```
pub fn path(mask: &Mask, label: Label) -> String {
    let other;
    let mask = if label == Label::Subject {
        mask
    } else {
        let labels = mask.labels().iter();
        let flipped = labels.map(|&found| if found == label { Label::Subject } else { Label::Background });
        let Ok(flipped) = Mask::new(mask.width(), mask.height(), flipped.collect()) else {
            return String::new();
        };
        other = flipped;
        &other
    };
    let mut out = String::new();
    for outline in contours(mask) {
        let mut corners = outline.iter().map(|corner| corner.map(|number| (number + 0.5) as i32));
        let Some(mut at) = corners.next() else { continue };
        out.push_str(&format!("M{} {}", at[0], at[1]));
        for corner in corners {
            let [across, down] = [corner[0] - at[0], corner[1] - at[1]];
            if down == 0 {
                out.push_str(&format!("h{across}"));
            } else {
                out.push_str(&format!("v{down}"));
            }
            at = corner;
        }
        out.push('z');
    }
    out
}
