//! Where the robot believes to be, among the places that it knows.

use serde::Serialize;

use super::known::{Came, Places};
use xcs::{Action, Percept};

/// Beliefs below this share of the greatest are dropped.
pub const NEGLIGIBLE: f64 = 1e-4;

/// A belief over known places, step by step (Bayes); `None` among them is a place never met.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Belief {
    places: Vec<(Option<usize>, f64)>,
    /// What was done last, and whether it bumped.
    acted: Option<(Action, bool)>,
}

impl Belief {
    /// In one place, for sure.
    pub fn at(place: usize) -> Self {
        Self {
            places: vec![(Some(place), 1.0)],
            acted: None,
        }
    }

    /// Acts, and bumps or does not.
    pub fn act(&mut self, action: Action, bumped: bool) {
        self.acted = Some((action, bumped));
    }

    /// Perceives: the likeliest place, or `None` if that was never met.
    pub fn perceive(&mut self, known: &Places, seen: &Percept) -> Option<usize> {
        let mut places = match self.acted.take() {
            Some((action, true)) => self.after_a_bump(known, action, seen),
            Some((action, false)) => self.after_a_move(known, action, seen),
            None => Self::at_first(known, seen),
        };
        let greatest = places.iter().map(|it| it.1).fold(0.0, f64::max);
        places.retain(|it| it.1 >= NEGLIGIBLE * greatest && it.1 > 0.0);
        places.iter_mut().for_each(|it| it.1 /= greatest);
        self.places = places;
        let likeliest = self.places.iter().find(|it| it.1 == 1.0);
        likeliest.and_then(|it| it.0)
    }

    fn at_first(known: &Places, seen: &Percept) -> Vec<(Option<usize>, f64)> {
        let candidates = candidates(known, seen, known.beginnings());
        let weigh = |place| {
            (
                place,
                known.chance_to_begin(place) * look(known, place, seen),
            )
        };
        candidates.into_iter().map(weigh).collect()
    }

    fn after_a_bump(
        &self,
        known: &Places,
        action: Action,
        seen: &Percept,
    ) -> Vec<(Option<usize>, f64)> {
        let weigh = |&(place, before): &(Option<usize>, f64)| {
            let bumps = known.chance(place, action, Some(Came::Bumped));
            (place, before * bumps * look(known, place, seen))
        };
        self.places.iter().map(weigh).collect()
    }

    fn after_a_move(
        &self,
        known: &Places,
        action: Action,
        seen: &Percept,
    ) -> Vec<(Option<usize>, f64)> {
        // What is foreseen more surely than not, and looks just like what is seen, has no rivals.
        if let [(Some(from), _)] = self.places[..]
            && let Some(next) = known.usual(from, action)
            && known.percept(next) == seen
        {
            return vec![(Some(next), 1.0)];
        }
        let from = self.places.iter().filter_map(|it| it.0);
        let foreseen = from.flat_map(|from| known.successors(from, action));
        let weigh = |place: Option<usize>| {
            let comes = self
                .places
                .iter()
                .map(|&(from, before)| before * known.chance(from, action, place.map(Came::To)));
            (place, comes.sum::<f64>() * look(known, place, seen))
        };
        candidates(known, seen, foreseen)
            .into_iter()
            .map(weigh)
            .collect()
    }
}

/// Where a robot may be that sees this: where it is expected, in places that look nearly like
/// this, or where it never was.
fn candidates(
    known: &Places,
    seen: &Percept,
    expected: impl Iterator<Item = usize>,
) -> Vec<Option<usize>> {
    let mut candidates: Vec<usize> = expected.chain(known.near(seen)).collect();
    candidates.sort_unstable();
    candidates.dedup();
    let met = known
        .number(seen)
        .is_some_and(|place| known.visits(place) > 0);
    let never_met = (!met).then_some(None);
    candidates.into_iter().map(Some).chain(never_met).collect()
}

/// How likely this is to be seen in a place.
fn look(known: &Places, place: Option<usize>, seen: &Percept) -> f64 {
    place.map_or(1.0, |place| known.look(place, seen))
}
