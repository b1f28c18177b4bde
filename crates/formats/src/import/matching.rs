//! Which file belongs to which camera.

/// By what a file was given to a camera.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MatchedBy {
    /// Its name is the camera's.
    Name,
    /// The last number of its name is that of the camera's.
    Number,
    /// Nothing but the order: there are as many files as cameras.
    Order,
}

/// For each camera the index of the item that is its own. An item is known by several names, the best first. All are
/// matched by the first rule that matches any; each item goes to one camera.
pub(super) fn matched(cameras: &[&str], items: &[Vec<String>]) -> (Vec<Option<usize>>, MatchedBy) {
    let by = |is_same: &dyn Fn(&str, &str) -> bool| -> Vec<Option<usize>> {
        let mut taken = vec![false; items.len()];
        let mut own = |camera: &&str| {
            let names = items.iter().map(Vec::len).max().unwrap_or(0);
            let found = (0..names).find_map(|rank| {
                let is_own = |(index, item): (usize, &Vec<String>)| {
                    !taken[index] && item.get(rank).is_some_and(|name| is_same(camera, name))
                };
                items.iter().enumerate().position(is_own)
            })?;
            taken[found] = true;
            Some(found)
        };
        cameras.iter().map(&mut own).collect()
    };
    for (how, is_same) in [
        (
            MatchedBy::Name,
            &(|camera: &str, name: &str| plain(camera) == plain(name)) as &dyn Fn(&str, &str) -> bool,
        ),
        (MatchedBy::Number, &|camera, name| {
            last_number(camera).is_some() && last_number(camera) == last_number(name)
        }),
    ] {
        let found = by(is_same);
        let has_twins = how == MatchedBy::Number && !are_numbered(cameras);
        if found.iter().any(Option::is_some) && !has_twins {
            return (found, how);
        }
    }
    let in_order = (cameras.len() == items.len()).then(|| (0..items.len()).map(Some).collect());
    (in_order.unwrap_or_else(|| vec![None; cameras.len()]), MatchedBy::Order)
}

/// Letters and digits in lower case, without words that say nothing and without zeros before numbers.
fn plain(name: &str) -> String {
    let mut out = String::new();
    let mut is_number = false;
    for letter in name.to_lowercase().chars().filter(|letter| letter.is_alphanumeric()) {
        let is_digit = letter.is_ascii_digit();
        if is_digit && !is_number && letter == '0' {
            continue;
        }
        is_number = is_digit;
        out.push(letter);
    }
    ["camera", "json", "video", "int", "img", "undistorted"].iter().fold(out, |out, word| match *word {
        "camera" => out.replace("camera", "cam"),
        word => out.replace(word, ""),
    })
}

fn last_number(name: &str) -> Option<u64> {
    name.rsplit(|letter: char| !letter.is_ascii_digit()).find(|part| !part.is_empty())?.parse().ok()
}

/// Whether all names have numbers, no two the same.
fn are_numbered(names: &[&str]) -> bool {
    let numbers: Vec<Option<u64>> = names.iter().map(|name| last_number(name)).collect();
    numbers.iter().enumerate().all(|(index, number)| number.is_some() && !numbers[..index].contains(number))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn items(names: &[&str]) -> Vec<Vec<String>> {
        names.iter().map(|names| names.split('|').map(str::to_owned).collect()).collect()
    }

    #[test]
    fn names_come_before_numbers_and_numbers_before_the_order() {
        let found = matched(&["cam_01", "cam_02"], &items(&["cam2", "Camera 01"]));
        assert_eq!(found, (vec![Some(1), Some(0)], MatchedBy::Name));
        let found = matched(&["cam_01", "cam_02"], &items(&["GoPro-2", "GoPro-1", "other"]));
        assert_eq!(found, (vec![Some(1), Some(0)], MatchedBy::Number));
        let found = matched(&["left", "right"], &items(&["a", "b"]));
        assert_eq!(found, (vec![Some(0), Some(1)], MatchedBy::Order));
        assert_eq!(matched(&["left", "right"], &items(&["a"])).0, [None, None]);
        // A folder's name helps where the file's own says nothing.
        let found = matched(&["Cam0", "Cam1"], &items(&["trial|Cam1", "trial|Cam0"]));
        assert_eq!(found, (vec![Some(1), Some(0)], MatchedBy::Name));
        assert_eq!(
            matched(&["a1", "b1"], &items(&["x1", "y2", "z3"])).0,
            [None, None],
            "numbers that tell nothing"
        );
    }
}
