//! How dear a round may be: what is cheap everywhere goes first, and the last round takes all that is left.

/// By how much the price rises from round to round. On a smooth surface prices rise with the sixth power of the edge
/// length, so a round leaves about half of the triangles. What is frozen in a round comes after dearer sites have changed,
/// and then has to be refined with them: the root mean square at a tenth of the triangles is 1 to 3 % above that of one
/// queue, and was 10 to 25 % at a rise of 27 (`papers/examples/regions.rs`).
const RISE: f64 = 8.0;
/// Rounds one after the other that change next to nothing before all that is left is taken as one region.
const PATIENCE: u32 = 3;

/// The prices of rounds so far.
#[derive(Clone, Debug, Default)]
pub(super) struct Schedule {
    price: f64,
    idle: u32,
}

/// What came of a round.
#[derive(Clone, Copy, Debug)]
pub(super) struct Came {
    pub(super) cells_before: usize,
    pub(super) cells_after: usize,
    /// Whether any region had sites above the price.
    pub(super) more: bool,
}

impl Schedule {
    /// The price of the next round; infinite if it is to be the last. `usual` is asked where there is no price to rise
    /// from: for the median of all prices above the one it is given.
    pub(super) fn next(&mut self, usual: impl FnOnce(f64) -> Option<f64>) -> f64 {
        self.price = match self.price {
            0.0 => usual(if self.idle == 0 { -1.0 } else { 0.0 }).unwrap_or(f64::INFINITY),
            price => price * RISE.powi(1 + self.idle as i32),
        };
        self.price
    }

    /// Hears what came of it.
    pub(super) fn came(&mut self, came: Came) {
        let little = came.cells_after * 20 > came.cells_before * 19;
        self.idle = if little || self.price == 0.0 { self.idle + 1 } else { 0 };
        if !came.more || self.idle > PATIENCE {
            self.price = f64::INFINITY;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn came(cells_before: usize, cells_after: usize, more: bool) -> Came {
        Came { cells_before, cells_after, more }
    }

    #[test]
    fn prices_rise_from_the_usual_one() {
        let mut schedule = Schedule::default();
        assert_eq!(schedule.next(|above| (above < 0.0).then_some(0.5)), 0.5);
        schedule.came(came(100, 50, true));
        assert_eq!(schedule.next(|_| unreachable!("there is a price to rise from")), 4.0);
        // Where little came of it, the next round is bolder.
        schedule.came(came(50, 49, true));
        assert_eq!(schedule.next(|_| None), 256.0);
        schedule.came(came(49, 20, true));
        assert_eq!(schedule.next(|_| None), 2048.0);
    }

    #[test]
    fn flat_parts_cost_nothing_and_are_left_behind() {
        let mut schedule = Schedule::default();
        assert_eq!(schedule.next(|_| Some(0.0)), 0.0);
        schedule.came(came(100, 40, true));
        // The next price is the median of those that are not nothing.
        assert_eq!(schedule.next(|above| (above == 0.0).then_some(3.0)), 3.0);
        let mut flat = Schedule::default();
        flat.next(|_| Some(0.0));
        flat.came(came(100, 40, true));
        assert_eq!(flat.next(|_| None), f64::INFINITY);
    }

    #[test]
    fn it_comes_to_an_end() {
        // Nothing is above the price: no other price will help.
        let mut schedule = Schedule::default();
        schedule.next(|_| Some(1.0));
        schedule.came(came(100, 50, false));
        assert_eq!(schedule.next(|_| None), f64::INFINITY);
        // Nothing ever comes of it.
        let mut schedule = Schedule::default();
        let rounds = (0..100).take_while(|_| {
            let price = schedule.next(|_| Some(0.0));
            schedule.came(came(100, 100, true));
            price.is_finite()
        });
        assert!(rounds.count() <= 2 + PATIENCE as usize);
    }
}
