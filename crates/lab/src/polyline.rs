//! Lines through many places, without those that make no visible difference.

use egui::Pos2;

/// Distance in points by which a line may be off.
const TOLERANCE: f32 = 0.2;

/// Returns the places of a line without those that lie nearly on the line between their neighbours
/// (Ramer 1972; Douglas and Peucker 1973). Every place costs a software renderer some ten triangles.
pub(super) fn simplified(places: &[Pos2]) -> Vec<Pos2> {
    let Some(last) = places.len().checked_sub(1) else { return Vec::new() };
    let mut is_kept = vec![false; places.len()];
    (is_kept[0], is_kept[last]) = (true, true);
    let mut pieces = vec![(0, last)];
    while let Some((first, last)) = pieces.pop() {
        let ends = [places[first], places[last]];
        let off = (first + 1..last).map(|k| (k, distance(places[k], ends)));
        let farthest = off.max_by(|(_, a), (_, b)| a.total_cmp(b));
        if let Some((middle, _)) = farthest.filter(|(_, off)| *off > TOLERANCE) {
            is_kept[middle] = true;
            pieces.extend([(first, middle), (middle, last)]);
        }
    }
    places.iter().zip(is_kept).filter_map(|(place, is_kept)| is_kept.then_some(*place)).collect()
}

/// Returns the distance of a place from the straight piece between two ends.
fn distance(place: Pos2, [from, to]: [Pos2; 2]) -> f32 {
    let (along, to_place) = (to - from, place - from);
    let square = along.length_sq();
    let share = if square > 0.0 { (to_place.dot(along) / square).clamp(0.0, 1.0) } else { 0.0 };
    (to_place - share * along).length()
}

#[cfg(test)]
mod tests {
    use egui::pos2;

    use super::*;

    #[test]
    fn what_is_left_out_lies_on_the_line() {
        let wave: Vec<Pos2> =
            (0..=300).map(|x| pos2(x as f32, 40.0 * (0.05 * x as f32).sin())).collect();
        let kept = simplified(&wave);
        assert!(kept.len() < 80 && kept[0] == wave[0] && kept.last() == wave.last(), "{kept:?}");
        for place in &wave {
            let nearest = kept.windows(2).map(|ends| distance(*place, [ends[0], ends[1]]));
            let nearest = nearest.fold(f32::INFINITY, f32::min);
            assert!(nearest <= TOLERANCE, "{place:?}: {nearest}");
        }
    }

    #[test]
    fn a_straight_line_has_two_ends_and_a_way_back_is_kept() {
        let straight: Vec<Pos2> = (0..50).map(|x| pos2(x as f32, 2.0)).collect();
        assert_eq!(simplified(&straight), [straight[0], straight[49]]);
        let back = [pos2(0.0, 0.0), pos2(10.0, 0.0), pos2(0.0, 0.0)];
        assert_eq!(simplified(&back), back);
        assert_eq!(simplified(&[]), []);
        assert_eq!(simplified(&back[..1]), back[..1]);
    }
}
