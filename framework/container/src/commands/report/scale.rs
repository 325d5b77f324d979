//! From quantities to places in a drawing.

/// An axis: which quantities it shows, and where.
#[derive(Debug, Clone, Copy)]
pub(super) struct Scale {
    /// Least and greatest quantity.
    from: f64,
    to: f64,
    /// Where they lie.
    begin: f64,
    end: f64,
}

impl Scale {
    /// An axis of these quantities between two places. Without extent it gets some.
    pub(super) fn new([from, to]: [f64; 2], [begin, end]: [f64; 2]) -> Self {
        let (from, to) = match to - from {
            extent if extent > 0.0 && extent.is_finite() => (from, to),
            _ => (from - 0.5, from + 0.5),
        };
        Self {
            from,
            to,
            begin,
            end,
        }
    }

    /// The place of a quantity; what lies outside is at the nearer end.
    pub(super) fn place(&self, quantity: f64) -> f64 {
        let share = (quantity - self.from) / (self.to - self.from);
        self.begin + share.clamp(0.0, 1.0) * (self.end - self.begin)
    }

    /// Whether a quantity lies on it.
    pub(super) fn has(&self, quantity: f64) -> bool {
        (self.from..=self.to).contains(&quantity)
    }

    /// Round quantities, at least two and at most `most` of them where the extent allows.
    pub(super) fn ticks(&self, most: usize) -> Vec<f64> {
        let extent = self.to - self.from;
        let rough = extent / most.max(2) as f64;
        let power = 10f64.powf(rough.log10().floor());
        let steps = [1.0, 2.0, 5.0, 10.0].map(|it| it * power);
        let step = steps.into_iter().find(|step| extent / step < most as f64);
        let step = step.unwrap_or(10.0 * power);
        let first = (self.from / step).ceil();
        let count = (self.to / step).floor() - first;
        // A handful, by the choice of the step.
        (0..=count.max(0.0) as usize)
            .map(|number| (first + number as f64) * step)
            .collect()
    }
}

/// The extent of quantities with a twentieth of room at both ends; what is no finite number does not
/// count. None without any.
pub(super) fn extent(quantities: impl Iterator<Item = f64>) -> Option<[f64; 2]> {
    let finite = quantities.filter(|it| it.is_finite());
    let (least, most) = finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), it| {
        (least.min(it), most.max(it))
    });
    let room = match most - least {
        extent if extent > 0.0 => extent / 20.0,
        _ => (most.abs() / 20.0).max(0.01),
    };
    (least <= most).then_some([least - room, most + room])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantities_have_places() {
        let scale = Scale::new([0.0, 10.0], [100.0, 200.0]);
        for (quantity, place) in [
            (0.0, 100.0),
            (5.0, 150.0),
            (10.0, 200.0),
            (-3.0, 100.0),
            (99.0, 200.0),
        ] {
            assert!((scale.place(quantity) - place).abs() < 1e-9, "{quantity}");
        }
        assert!(scale.has(10.0) && !scale.has(10.1) && !scale.has(f64::NAN));
        let point = Scale::new([3.0, 3.0], [0.0, 10.0]);
        assert!((point.place(3.0) - 5.0).abs() < 1e-9);
    }

    #[test]
    fn ticks_are_round_and_few() {
        for (from, to, most, expected) in [
            (0.0, 60.0, 8, &[0.0, 10.0, 20.0, 30.0, 40.0, 50.0, 60.0][..]),
            (-0.15, 3.15, 5, &[0.0, 1.0, 2.0, 3.0]),
            (1.44, 1.46, 4, &[1.44, 1.45, 1.46]),
            (0.0, 1.0, 6, &[0.0, 0.2, 0.4, 0.6, 0.8, 1.0]),
        ] {
            let ticks = Scale::new([from, to], [0.0, 1.0]).ticks(most);
            assert_eq!(ticks.len(), expected.len(), "{ticks:?}");
            for (tick, expected) in ticks.iter().zip(expected) {
                assert!((tick - expected).abs() < 1e-9, "{ticks:?}");
            }
        }
    }

    #[test]
    fn an_extent_has_room() {
        for (quantities, expected) in [
            (&[0.0, 2.0, f64::NAN][..], Some([-0.1, 2.1])),
            (&[4.0], Some([3.8, 4.2])),
            (&[f64::INFINITY], None),
            (&[], None),
        ] {
            let found = extent(quantities.iter().copied());
            assert_eq!(found, expected, "{quantities:?}");
        }
    }
}
